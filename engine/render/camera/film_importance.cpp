#include "engine/render/camera/film_importance.h"

#include <algorithm>
#include <cmath>

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

}  // namespace lensproof::render
