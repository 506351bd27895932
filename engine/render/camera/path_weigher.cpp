#include "engine/render/camera/path_weigher.h"

namespace lensproof::render {

PathWeigher::PathWeigher(const spectral::SpectralGrid& grid, const Sensor& sensor, bool is_box, bool has_pdfs,
                         const PathKernels& kernels)
    : grid_(grid), sensor_(sensor), is_box_(is_box), kernels_(&kernels) {
    chunk_.has_pdfs = has_pdfs;
}

void PathWeigher::take_heroes(const CameraPathBuffer& paths, std::size_t first) {
    const auto at = static_cast<std::ptrdiff_t>(first);
    std::copy_n(paths.weight.begin() + at, chunk_.size, chunk_.hero_weight.begin());
    std::copy_n(paths.etendue.begin() + at, chunk_.size, chunk_.hero_etendue.begin());
    for (std::size_t i = 0; i < static_cast<std::size_t>(chunk_.size); ++i) {
        const Vec2d centre = path_pixel(paths, first + i, sensor_, is_box_);
        chunk_.centre_x[i] = centre.x;
        chunk_.centre_y[i] = centre.y;
        const spectral::PathWavelengths wavelengths = grid_.path(paths.wavelength[first + i]);
        chunk_.hero_wavelengths[i] = wavelengths.index[0];
        for (std::size_t m = 1; m < spectral::kWavelengthsPerPath; ++m) {
            chunk_.other_wavelengths[m - 1][i] = wavelengths.index[m];
        }
    }
}

void PathWeigher::give_weights(CameraPathBuffer& paths, std::size_t first) const {
    for (std::size_t i = 0; i < static_cast<std::size_t>(chunk_.size); ++i) {
        for (std::size_t m = 0; m < spectral::kWavelengthsPerPath; ++m) {
            paths.weights[first + i][m] = chunk_.weight[m][i];
        }
        if (chunk_.has_pdfs) {
            paths.pdf[first + i] = {.shared = chunk_.shared_pdf[i], .hero = chunk_.hero_pdf[i]};
        }
    }
}

}  // namespace lensproof::render
