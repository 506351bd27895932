// A perfect focus of real rays that no conic has: the Cartesian oval.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "engine/analysis/beam_outline.h"
#include "engine/analysis/spot.h"

namespace lensproof::analysis::cartesian_oval_test {

constexpr double kIndex = 1.5;
constexpr double kObject = 100.0;  // in front of the vertex, mm
constexpr double kImage = 300.0;   // behind it, in the glass
constexpr double kSemiDiameter = 6.0;

/// The oval's sag at height h: |object − P| + n |P − image| is the same for all of its points P (Descartes, La
/// Géométrie, book 2; Born & Wolf §4.2.1). By Newton's method, in the form that does not cancel for small h:
/// with p = √((a + z)² + h²) and q = √((b − z)² + h²), p − a = (2 a z + z² + h²) / (p + a), and so for q.
long double oval_sag(long double h) {
    const long double a = kObject;
    const long double b = kImage;
    const long double n = kIndex;
    long double z = 0.0L;
    for (int i = 0; i < 50; ++i) {
        const long double p = std::sqrt((a + z) * (a + z) + h * h);
        const long double q = std::sqrt((b - z) * (b - z) + h * h);
        const long double value =
            (2.0L * a * z + z * z + h * h) / (p + a) + n * (-2.0L * b * z + z * z + h * h) / (q + b);
        z -= value / ((a + z) / p - n * (b - z) / q);
    }
    return z;
}

/// The even polynomial through the oval at Chebyshev's nodes of r², ten terms.
optics::SurfaceShape<double> oval() {
    using Matrix = Eigen::Matrix<long double, 10, 10>;
    using Vector = Eigen::Matrix<long double, 10, 1>;
    Matrix powers;
    Vector sags;
    constexpr long double kPi = 3.141592653589793238462643383279502884L;
    for (int i = 0; i < 10; ++i) {
        const long double t = 0.5L * (1.0L + std::cos(kPi * (i + 0.5L) / 10.0L));  // (r / semi-diameter)²
        for (int k = 0; k < 10; ++k) {
            powers(i, k) = std::pow(t, static_cast<long double>(k + 1));
        }
        sags(i) = oval_sag(kSemiDiameter * std::sqrt(t));
    }
    const Vector terms = powers.fullPivLu().solve(sags);
    optics::SurfaceShape<double> shape{.terms = 10};
    for (int k = 0; k < 10; ++k) {
        shape.asphere[k] = static_cast<double>(terms(k) / std::pow(kSemiDiameter, 2.0L * (k + 1)));
    }
    return shape;
}

/// The oval as the only surface, its image inside the glass.
optics::TraceLens<double> oval_lens() {
    const optics::SurfaceShape<double> shape = oval();
    optics::TraceLens<double> lens{
        .surfaces = {optics::make_trace_surface(2.0 * shape.asphere[0], 0.0, kSemiDiameter, 1.0, kIndex, true)},
        .image_z = kImage};
    lens.surfaces.front().special = 0;
    lens.specials.push_back({.has_shape = true, .shape = shape});
    return lens;
}

optics::FieldBundle axial_bundle() {
    return {.chief = {.field_angle = 0.0,
                      .front = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}},
                      .image_height = 0.0,
                      .rear = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}},
            .object_distance = kObject};
}

// The polynomial leaves (semi-diameter / radius of convergence)²² of the sag; that is below an ulp of it here, so the
// rays meet in a point to the rounding of a point 300 mm away, and every path is the chief ray's.
TEST(CartesianOval, ImagesItsPointPerfectly) {
    const optics::TraceLens<double> lens = oval_lens();
    const optics::FieldBundle bundle = axial_bundle();
    const optics::RegionOutline outline = beam_outline(lens, bundle);
    const SpotSize spot = spot_size(spot_rays(lens, bundle, outline, 12));
    EXPECT_LT(spot.rms, 1e-12);
    EXPECT_LT(spot.max_radius, 1e-11);
    for (double height = -5.0; height <= 5.0; height += 1.0) {
        const optics::TracedRay<double> ray = optics::trace(lens, bundle.ray({0.0, height}));
        ASSERT_EQ(ray.status, optics::RayStatus::ok);
        const optics::PlanePoint<double> image = optics::meet_plane(ray.ray, lens.image_z);
        EXPECT_NEAR(ray.optical_path + kIndex * image.distance, kIndex * kImage, 4e-13) << height;
    }
}

// A sphere of the same power does not.
TEST(CartesianOval, ASphereInItsPlaceDoesNot) {
    optics::TraceLens<double> lens = oval_lens();
    lens.surfaces.front().special = -1;
    lens.specials.clear();
    const optics::FieldBundle bundle = axial_bundle();
    EXPECT_GT(spot_size(spot_rays(lens, bundle, beam_outline(lens, bundle), 12)).rms, 1e-3);
}

}  // namespace lensproof::analysis::cartesian_oval_test
