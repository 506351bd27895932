#include "engine/pupil/entrance_beam.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/base/angle.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/field_bundle.h"
#include "engine/optics/lens.h"
#include "engine/optics/region_outline.h"
#include "engine/spectral/wavelengths.h"
#include "tests/engine/random_lens.h"

namespace lensproof::pupil::entrance_beam_test {

double turned_to(double low, double high, std::mt19937_64& random) {
    return std::uniform_real_distribution(low, high)(random);
}

/// A point of the first surface inside its rim, and the surface's normal there, towards the sensor; by the tracer, from
/// in front.
std::optional<Ray<double>> point_of_front(const optics::TraceLens<double>& lens, std::mt19937_64& random) {
    optics::TraceLens<double> first = lens;
    first.surfaces.resize(1);
    const double reach = 1.2 * std::sqrt(first.surfaces[0].semi_diameter_squared);
    const Ray<double> along{{turned_to(-reach, reach, random), turned_to(-reach, reach, random), -300.0},
                            {0.0, 0.0, 1.0}};
    const optics::TracedRay<double> met = optics::trace(first, along);
    return met.status == optics::RayStatus::ok ? std::optional(met.ray) : std::nullopt;
}

/// Every line through the point, in any direction, passes the plane across that direction inside the disc.
void expect_inside(const BoundingSphere& front, const Vec3d& point, std::mt19937_64& random, const std::string& what) {
    const double z = turned_to(-1.0, 1.0, random);
    const double azimuth = turned_to(0.0, 2.0 * kPi, random);
    const double r = std::sqrt(1.0 - z * z);
    const EntranceBeam beam = beam_along(front, {r * std::cos(azimuth), r * std::sin(azimuth), z});
    const Vec3d from_centre = point - beam.axis.origin;
    const Vec2d offset{dot(from_centre, beam.across[0]), dot(from_centre, beam.across[1])};
    EXPECT_LE(std::hypot(offset.x, offset.y), beam.radius * (1.0 + 1e-12)) << what;
    // And the ray of that offset is the line through the point.
    EXPECT_NEAR(length(cross(point - beam.ray(offset).origin, beam.axis.direction)), 0.0, 1e-12 * 300.0) << what;

    const auto near_beam = beam_from(front, front.centre - (1.5 * front.radius) * beam.axis.direction);
    ASSERT_TRUE(near_beam) << what;
    const Vec3d from_near = point - (near_beam->axis.origin - near_beam->distance * near_beam->axis.direction);
    const double scale = near_beam->distance / dot(from_near, near_beam->axis.direction);
    const Vec2d at{scale * dot(from_near, near_beam->across[0]), scale * dot(from_near, near_beam->across[1])};
    EXPECT_LE(std::hypot(at.x, at.y), near_beam->radius * (1.0 + 1e-12)) << what;
    EXPECT_NEAR(length(cross(point - near_beam->ray(at).origin, near_beam->ray(at).direction)), 0.0, 1e-12 * 300.0);
}

// No line that meets the front surface inside its rim is outside the disc, for any direction: every lens that ships,
// and random spheres, conics and aspheres.
TEST(EntranceBeam, DiscHoldsTheFrontSurface) {
    std::mt19937_64 random(7);
    const auto check = [&](const optics::TraceLens<double>& lens, const std::string& name) {
        const BoundingSphere front = front_sphere(lens);
        int points = 0;
        for (int i = 0; i < 300; ++i) {
            if (const auto point = point_of_front(lens, random)) {
                expect_inside(front, point->origin, random, name);
                ++points;
            }
        }
        EXPECT_GT(points, 50) << name;
    };
    for (const char* name : {"tessar", "fisheye-220", "muller-fisheye", "canon-ef-s-24", "nikkor-fisheye-10"}) {
        check(optics::at_wavelength<double>(formats::load_lens(name), spectral::kLineD), name);
    }
    RandomLenses lenses(11);
    for (int i = 0; i < 40; ++i) {
        check(
            optics::at_wavelength<double>(optics::make_lens(lenses.next(), optics::GlassCatalogue{}), spectral::kLineD),
            "random lens " + std::to_string(i));
    }
}

TEST(EntranceBeam, DiscHoldsTiltedFrontSurfacesAndToroids) {
    std::mt19937_64 random(8);
    optics::TraceLens<double> lens = optics::at_wavelength<double>(formats::load_lens("tessar"), spectral::kLineD);
    lens.surfaces[0].special = 0;
    lens.specials.emplace_back();
    lens.specials[0].vertex = {1.0, -2.0};
    lens.specials[0].axes = {
        {{std::cos(0.2), 0.0, -std::sin(0.2)}, {0.0, 1.0, 0.0}, {std::sin(0.2), 0.0, std::cos(0.2)}}};
    for (const bool toroid : {false, true}) {
        lens.specials[0].has_shape = toroid;
        lens.specials[0].shape = {.curvature = 0.02, .is_toroid = true, .curvature_x = -0.03};
        const BoundingSphere front = front_sphere(lens);
        for (int i = 0; i < 500; ++i) {
            if (const auto point = point_of_front(lens, random)) {
                expect_inside(front, point->origin, random, toroid ? "toroid" : "tilted");
            }
        }
    }
}

// A sphere is as large as it must be: the rim itself lies on it.
TEST(EntranceBeam, DiscIsTheRimOnTheAxis) {
    const optics::TraceLens<double> lens =
        optics::at_wavelength<double>(formats::load_lens("fisheye-220"), spectral::kLineD);
    const EntranceBeam beam = beam_along(front_sphere(lens), {0.0, 0.0, 1.0});
    EXPECT_DOUBLE_EQ(beam.radius, 106.5);
    EXPECT_DOUBLE_EQ(beam.axis.origin.z, 143.47 - std::sqrt(143.47 * 143.47 - 106.5 * 106.5));
}

// The cone that touches a sphere of radius a from the distance d fills 2π (1 − √(1 − a²/d²)) sr; the integral over the
// disc by 40 Gauss-Legendre nodes in the radius, exact to rounding.
TEST(EntranceBeam, SolidAngleIsTheTangentCones) {
    const BoundingSphere front{.centre = {0.0, 0.0, 3.0}, .radius = 20.0};
    const optics::GaussRule rule = optics::gauss_legendre(40);
    for (const double distance : {21.0, 40.0, 1000.0}) {
        const EntranceBeam beam = beam_from(front, {0.0, 0.6 * distance, 3.0 - 0.8 * distance}).value();
        double sum = 0.0;
        for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
            const double r = beam.radius * rule.nodes[k];
            sum += rule.weights[k] * beam.radius * 2.0 * kPi * r * beam.solid_angle_per_mm2({0.6 * r, 0.8 * r});
        }
        const double expected = 2.0 * kPi * (1.0 - std::sqrt(1.0 - 400.0 / (distance * distance)));
        EXPECT_NEAR(sum / expected, 1.0, 1e-10) << distance;
    }
    EXPECT_EQ(beam_from(front, {0.0, 0.0, -16.9}), std::nullopt);
}

/// `v` turned about z by the azimuth, from +y towards +x.
Vec3d turned(const Vec3d& v, double azimuth) {
    return {std::cos(azimuth) * v.x + std::sin(azimuth) * v.y, std::cos(azimuth) * v.y - std::sin(azimuth) * v.x, v.z};
}

// In the meridional plane offsets are FieldBundle's, at every field angle, and a beam turned about the axis is the same
// beam with its offsets turned; to a few ulps of the 1 / (1 + cos θ) that the turn has in it.
TEST(EntranceBeam, OffsetsAreThoseOfTheFieldBundle) {
    const BoundingSphere front{.centre = {0.0, 0.0, 3.0}, .radius = 1.0};
    for (const double field : {0.0, 1e-9, 0.5, 0.5 * kPi, 1.9}) {
        const Vec3d direction{0.0, std::sin(field), std::cos(field)};
        const EntranceBeam beam = beam_along(front, direction);
        for (int axis = 0; axis < 2; ++axis) {
            EXPECT_LE(length(beam.across[axis] - optics::across_axes(direction)[axis]), 1e-15) << field;
        }
        for (const double azimuth : {0.3, 2.0, 4.5}) {
            const EntranceBeam other = beam_along(front, turned(direction, azimuth));
            const Vec3d offset{0.3, 0.5, 0.0};
            const Vec3d turned_offset = turned(offset, azimuth);
            const Vec3d expected = turned(beam.ray({offset.x, offset.y}).origin, azimuth);
            EXPECT_LE(length(other.ray({turned_offset.x, turned_offset.y}).origin - expected), 4e-15) << field;
        }
    }
}

}  // namespace lensproof::pupil::entrance_beam_test
