#include "engine/render/camera/film_importance.h"

#include <algorithm>
#include <cmath>

#include "engine/render/camera/packet/shared_weights.h"

namespace lensproof::render {

bool FilmImportance::is_dark() const {
    return std::ranges::all_of(transmittance, [](double of) { return of == 0.0; });
}

double FilmImportance::shared_pdf(std::size_t wavelength) const {
    const auto pixel = [&](std::size_t i) { return Vec2d{std::floor(at_px[i].x + 0.5), std::floor(at_px[i].y + 0.5)}; };
    double sum = 0.0;
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        if (transmittance[i] > 0.0 && (i == wavelength || pixel(i) == pixel(wavelength))) {
            sum += pdf[i] / spectral::kWavelengthsPerPath;
        }
    }
    return sum;
}

std::array<float, spectral::kWavelengthsPerPath> shared_weights(const FilmImportance& film, Vec2d centre_px,
                                                                PathPdf& drawn) {
    std::array<FilmArrival<double>, spectral::kWavelengthsPerPath> arrivals{};
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        arrivals[i] = {.at_px = film.at_px[i], .transmittance = film.transmittance[i], .pdf = film.pdf[i]};
    }
    const SharedWeights<double, spectral::kWavelengthsPerPath> shared = shared_weights(arrivals, centre_px);
    drawn = {.shared = shared.shared_pdf, .hero = shared.hero_pdf};
    std::array<float, spectral::kWavelengthsPerPath> weights{};
    std::ranges::transform(shared.weight, weights.begin(), [](double weight) { return static_cast<float>(weight); });
    return weights;
}

}  // namespace lensproof::render
