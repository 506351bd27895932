#include "engine/optics/polarised_ghost.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lensproof::optics::polarised_ghost_test {

/// A plate of index 1.5 between flat faces, whose second one may be turned about y by `tilt` radians.
TraceLens<double> plate(double tilt = 0.0) {
    TraceLens<double> lens{.surfaces = {make_trace_surface(0.0, 0.0, 1e3, 1.0, 1.5, false),
                                        make_trace_surface(0.0, 5.0, 1e3, 1.5, 1.0, false)},
                           .image_z = 50.0};
    if (tilt != 0.0) {
        SpecialSurface<double> turned;
        turned.axes = {
            {{std::cos(tilt), 0.0, -std::sin(tilt)}, {0.0, 1.0, 0.0}, {std::sin(tilt), 0.0, std::cos(tilt)}}};
        lens.specials.push_back(turned);
        lens.surfaces[1].special = 0;
    }
    return lens;
}

// At parallel faces all planes of incidence are one: each polarisation keeps to itself, T² R² of s and of p, and their
// mean is more than the product of the means.
TEST(PolarisationFactor, OfAPlateIsTheMeanOfItsProducts) {
    for (const double angle : {0.0, 0.3, 0.8, 1.2}) {
        const double inside = std::sqrt(1.0 - std::pow(std::sin(angle) / 1.5, 2));
        const PolarisedPowers<double> in = coating_powers<double>({}, 1.0, 1.5, std::cos(angle), true);
        const double s = std::pow(in.s.transmitted * in.s.reflected, 2);
        const double p = std::pow(in.p.transmitted * in.p.reflected, 2);
        const double averaged = std::pow(in.unpolarised().transmitted * in.unpolarised().reflected, 2);
        EXPECT_NEAR(coating_powers<double>({}, 1.0, 1.5, inside, false).s.reflected, in.s.reflected, 1e-15);
        const Ray<double> ray{{1.0, 2.0, -10.0}, {std::sin(angle) * 0.6, std::sin(angle) * 0.8, std::cos(angle)}};
        EXPECT_NEAR(polarisation_factor(plate(), {1, 0}, ray, {}), 0.5 * (s + p) / averaged, 1e-12) << angle;
        const double straight = 0.5 * (std::pow(in.s.transmitted, 2) + std::pow(in.p.transmitted, 2));
        EXPECT_NEAR(polarisation_factor(plate(), {}, ray, {}), straight / std::pow(in.unpolarised().transmitted, 2),
                    1e-12);
    }
}

// Faces that are turned against each other have other planes of incidence, and less is gained (closed forms of skew
// planes: polarisation_test.cpp).
TEST(PolarisationFactor, KnowsSkewPlanes) {
    const double angle = 0.7;
    const Ray<double> along_y{{0.0, 2.0, -10.0}, {0.0, std::sin(angle), std::cos(angle)}};
    const double coplanar = polarisation_factor(plate(), {1, 0}, along_y, {});
    const double skew = polarisation_factor(plate(0.3), {1, 0}, along_y, {});
    EXPECT_GT(coplanar, 1.1);
    EXPECT_LT(skew, coplanar - 0.01);
    EXPECT_GT(skew, 0.5);
}

TEST(PolarisationFactor, OfTheSensorAndOfRaysThatDoNotArriveIsNone) {
    const Ray<double> upright{{0.0, 0.0, -10.0}, {0.0, 0.0, 1.0}};
    EXPECT_NEAR(polarisation_factor(plate(), {2, 1}, upright, {.sensor = 0.5, .blades = 0.0}), 1.0, 1e-14);
    const Ray<double> beside{{2e3, 0.0, -10.0}, {0.0, 0.0, 1.0}};
    EXPECT_EQ(polarisation_factor(plate(), {1, 0}, beside, {}), 1.0);
}

}  // namespace lensproof::optics::polarised_ghost_test
