// engine/render/film/smoothed_film.h — a film whose light is known to be smooth.
#pragma once
#include <cstdint>
#include <string>

#include "engine/render/film/film.h"

namespace lensproof::render {

/// The film with what each pixel has spread over those around it by a Gaussian of standard deviation `sigma_px`; what
/// would fall beside the frame stays in it. Features stay where they are. Variances are those of such means, of pixels
/// whose noise is independent: those of neighbours are no longer.
Film smoothed(const Film& film, double sigma_px, int threads = 0);

/// A pass whose light is smooth and is rendered with fewer samples: of the picture's one in `fewer`.
struct SmoothPass {
    std::string pass;
    double sigma_px = 0.0;
    std::uint32_t fewer = 1;
};

/// Of how many pixels' samples one has the use after that, far from the border: 4 π sigma².
double smoothing_gain(double sigma_px);

}  // namespace lensproof::render
