#include "engine/spectral/colour_matching.h"

#include <cmath>
#include <utility>

namespace lensproof::spectral {

namespace {

constexpr const char* kObserverFile = "cie-1931-2deg.csv";

/// CIELAB's lightness scale: a cube root that ends in a straight line below (6/29)³.
double lightness(double ratio) {
    constexpr double kDelta = 6.0 / 29.0;
    return ratio > kDelta * kDelta * kDelta ? std::cbrt(ratio) : ratio / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
}

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

std::array<Vec3d, 3> rec709_primaries(const Vec3d& white) {
    const auto& [red, green, blue] = kRec709Primaries;
    const double determinant = dot(red, cross(green, blue));
    return {dot(cross(green, blue), white) / determinant * red, dot(cross(blue, red), white) / determinant * green,
            dot(cross(red, green), white) / determinant * blue};
}

Vec3d cielab(const Vec3d& xyz, const Vec3d& white) {
    const double x = lightness(xyz.x / white.x);
    const double y = lightness(xyz.y / white.y);
    const double z = lightness(xyz.z / white.z);
    return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

}  // namespace lensproof::spectral
