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

std::array<float, spectral::kWavelengthsPerPath> shared_weights(const FilmImportance& film, Vec2d centre_px,
                                                                PathPdf& drawn) {
    std::array<double, spectral::kWavelengthsPerPath> transmittance{};
    drawn = {};
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        const Vec2d off = film.at_px[i] - centre_px;
        // The hero's point lies in the pixel, wherever rounding may see it.
        if (i == 0 || (off.x >= -0.5 && off.x < 0.5 && off.y >= -0.5 && off.y < 0.5)) {
            transmittance[i] = film.transmittance[i];
            drawn.shared += film.pdf[i] / spectral::kWavelengthsPerPath;
            drawn.hero = i == 0 ? film.pdf[i] : drawn.hero;
        }
    }
    std::array<float, spectral::kWavelengthsPerPath> weights{};
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        weights[i] = drawn.shared > 0.0 ? static_cast<float>(transmittance[i] / drawn.shared) : 0.0F;
    }
    return weights;
}

}  // namespace lensproof::render
