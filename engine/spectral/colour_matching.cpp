#include "engine/spectral/colour_matching.h"

#include <utility>

namespace lensproof {

namespace {

constexpr const char* kObserverFile = "cie-1931-2deg.csv";

}  // namespace

ColourMatching cie_1931() {
    std::vector<Spectrum> columns = read_spectra(spectral_data(kObserverFile), {"x_bar", "y_bar", "z_bar"});
    return {.x_bar = std::move(columns[0]), .y_bar = std::move(columns[1]), .z_bar = std::move(columns[2])};
}

Spectrum photopic_efficiency() {
    return read_spectra(spectral_data(kObserverFile), {"y_bar"}).front();
}

Vec3d tristimulus(const Spectrum& spectrum, const ColourMatching& observer) {
    return kMaximumLuminousEfficacy * Vec3d{integral_of_product(spectrum, observer.x_bar),
                                            integral_of_product(spectrum, observer.y_bar),
                                            integral_of_product(spectrum, observer.z_bar)};
}

Vec2d chromaticity(const Vec3d& xyz) {
    const double sum = xyz.x + xyz.y + xyz.z;
    return {xyz.x / sum, xyz.y / sum};
}

}  // namespace lensproof
