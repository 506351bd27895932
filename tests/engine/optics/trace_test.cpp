// The tracer against closed forms and conservation laws.
#include "engine/optics/trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "engine/base/angle.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/lens.h"

namespace lensproof::optics::trace_test {

constexpr double kUlp = std::numeric_limits<double>::epsilon();

/// Surfaces in air: (curvature, vertex z, semi-diameter, index behind).
struct Row {
    double curvature;
    double z;
    double semi_diameter;
    double index_after;
};

template <class T = double>
TraceLens<T> build(const std::vector<Row>& rows, double image_z = 100.0) {
    TraceLens<T> lens{.surfaces = {}, .image_z = static_cast<T>(image_z)};
    T before = T(1);
    for (const Row& row : rows) {
        lens.surfaces.push_back(make_trace_surface<T>(static_cast<T>(row.curvature), static_cast<T>(row.z),
                                                      static_cast<T>(row.semi_diameter), before,
                                                      static_cast<T>(row.index_after), false));
        before = static_cast<T>(row.index_after);
    }
    return lens;
}

Ray<double> tilted_ray(double incidence) {
    return {{0.0, -std::tan(incidence) * 5.0, -5.0}, {0.0, std::sin(incidence), std::cos(incidence)}};
}

// A plane-parallel plate shifts a ray sideways by t sin(i) (1 − cos i / (n cos i')) and does not turn it (Born &
// Wolf 4.4). The point is formed from numbers of size tan(i)·t in about ten operations.
TEST(Trace, PlaneParallelPlateShiftsAndDoesNotTurn) {
    constexpr double kThickness = 7.0;
    constexpr double kIndex = 1.7;
    const TraceLens<double> plate = build({{0, 0, 1e6, kIndex}, {0, kThickness, 1e6, 1.0}});
    for (const double incidence : {0.0, 0.1, 0.7, 1.4, 1.57}) {
        const Ray<double> in = tilted_ray(incidence);
        const TracedRay<double> out = trace(plate, in);
        ASSERT_EQ(out.status, RayStatus::ok);
        const double sin_inside = std::sin(incidence) / kIndex;
        const double cos_inside = std::sqrt(1.0 - sin_inside * sin_inside);
        const double expected = kThickness * std::sin(incidence) * (1.0 - std::cos(incidence) / (kIndex * cos_inside));
        const Vec3d offset = out.ray.origin - in.origin;
        const double shift = cross(in.direction, offset).x;  // signed distance from the incoming line
        EXPECT_NEAR(shift, expected, 40 * kUlp * length(offset)) << incidence;
        EXPECT_NEAR(out.ray.direction.y, in.direction.y, 4 * kUlp);
        // Near grazing the direction inside, known to an ulp, fixes cos i only to n² ulp / cos i.
        EXPECT_NEAR(out.ray.direction.z, in.direction.z, 4 * kUlp * kIndex * kIndex / std::cos(incidence));
    }
}

// A beam in air that converges on the point R (1 + n) behind a sphere's vertex is refracted without aberration into the
// point R (1 + 1/n) of glass n: the sphere's aplanatic pair (Born & Wolf 4.2.3).
TEST(Trace, SphereIsAplanaticForItsConjugatePair) {
    constexpr double kRadius = 20.0;
    constexpr double kIndex = 1.6;
    const TraceLens<double> sphere = build({{1.0 / kRadius, 0, 20.0, kIndex}});
    const double aimed = kRadius * (1.0 + kIndex);
    const double focus = kRadius * (1.0 + 1.0 / kIndex);
    for (const double height : {0.1, 3.0, 9.0, 15.0, 19.0}) {
        const Vec3d from{0.0, height * (aimed + 30.0) / aimed, -30.0};
        const TracedRay<double> out = trace(sphere, Ray<double>{from, normalized(Vec3d{0.0, 0.0, aimed} - from)});
        ASSERT_EQ(out.status, RayStatus::ok) << height;
        const double crossing = out.ray.origin.z - out.ray.origin.y * out.ray.direction.z / out.ray.direction.y;
        // The crossing divides two numbers with errors of an ulp of 50 mm by a slope of height / focus.
        EXPECT_NEAR(crossing, focus, 50.0 * 20 * kUlp * focus / height) << height;
    }
}

// Light finds the same path back: the tracer in reverse, from where a forward ray arrived, returns to its origin with
// the same optical path and transmittance (reciprocity of Fresnel's equations). 16 refractions of numbers of size 100
// mm.
TEST(Trace, ReverseRetracesForward) {
    const TraceLens<double> lens = at_wavelength<double>(formats::load_lens("tessar"), 550.0);
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> position(-10.0, 10.0);
    std::uniform_real_distribution<double> slope(-0.2, 0.2);
    int passed = 0;
    for (int i = 0; i < 1000; ++i) {
        const Vec3d direction = normalized(Vec3d{slope(random), slope(random), 1.0});
        const Vec3d aim{position(random), position(random), 0.0};
        const TracedRay<double> out = trace(lens, Ray<double>{aim - 50.0 * direction, direction});
        if (out.status != RayStatus::ok) {
            continue;
        }
        ++passed;
        const PlanePoint<double> image = meet_plane(out.ray, lens.image_z);
        const TracedRay<double> back =
            trace<Direction::reverse>(lens, Ray<double>{image.point, -1.0 * out.ray.direction});
        ASSERT_EQ(back.status, RayStatus::ok);
        EXPECT_NEAR(length(back.ray.direction + direction), 0.0, 1e-13);
        EXPECT_NEAR(length(cross(back.ray.direction, aim - back.ray.origin)), 0.0, 1e-12);
        const double to_first_surface = length(back.ray.origin - (aim - 50.0 * direction));
        EXPECT_NEAR(back.optical_path + to_first_surface, out.optical_path + image.distance, 1e-12);
        EXPECT_NEAR(back.transmittance, out.transmittance, 1e-14);
    }
    EXPECT_GT(passed, 500);
}

// Uncoated glass at normal incidence: T = 4n / (n + 1)² (Born & Wolf 1.5.2, eq. 36); at Brewster's angle p passes
// whole.
TEST(Fresnel, ClosedForms) {
    constexpr double kIndex = 1.5;
    EXPECT_NEAR(fresnel_transmittance(1.0 / kIndex, 1.0, 1.0).value(), 4 * kIndex / ((kIndex + 1) * (kIndex + 1)),
                2 * kUlp);
    const double brewster = std::atan(kIndex);
    const double cos_inside = std::sqrt(1.0 - std::pow(std::sin(brewster) / kIndex, 2));
    const double s = (std::cos(brewster) - kIndex * cos_inside) / (std::cos(brewster) + kIndex * cos_inside);
    EXPECT_NEAR(fresnel_transmittance(1.0 / kIndex, std::cos(brewster), cos_inside).value(), 1.0 - s * s / 2.0,
                4 * kUlp);
    EXPECT_EQ(fresnel_transmittance(1.3 / 1.3, 0.4, 0.4).value(), 1.0);
}

// Without absorption T + R = 1: the transmittance at equal media is whole, and Stokes' relation makes it the same from
// both sides, at every angle below the critical one.
TEST(Fresnel, TransmittanceIsTheSameFromBothSides) {
    for (double incidence = 0.0; incidence < 1.57; incidence += 0.05) {
        const double cos_out = std::cos(incidence);
        const double cos_in = std::sqrt(1.0 - std::pow(std::sin(incidence) / 1.8, 2));
        EXPECT_NEAR(fresnel_transmittance(1.0 / 1.8, cos_out, cos_in).value(),
                    fresnel_transmittance(1.8 / 1.0, cos_in, cos_out).value(), 8 * kUlp);
    }
}

TEST(Trace, SaysWhereAndWhyARayEnds) {
    const TraceLens<double> ball = build({{0.1, 0, 5.0, 1.5}, {-0.1, 20.0, 5.0, 1.0}});
    const Vec3d forward{0.0, 0.0, 1.0};
    EXPECT_EQ(trace(ball, Ray<double>{{0, 12, -5}, forward}).status, RayStatus::missed);
    const TracedRay<double> clipped = trace(ball, Ray<double>{{0, 6, -5}, forward});
    EXPECT_EQ(clipped.status, RayStatus::clipped);
    EXPECT_EQ(clipped.surface, 0);

    TraceLens<double> stopped = build({{0, 0, 5.0, 1.0}});
    stopped.surfaces[0].is_stop = true;
    EXPECT_EQ(trace(stopped, Ray<double>{{0, 6, -5}, forward}).status, RayStatus::stopped);

    // From glass of index 1.5 the critical angle is asin(1/1.5) = 41.8°; 45° is beyond it.
    const TraceLens<double> block = build({{0, 0, 1e3, 1.5}, {-1.0, 10.0, 1.0, 1.0}});
    const TracedRay<double> reflected = trace(block, Ray<double>{{0, std::sqrt(0.5), -5}, forward});
    EXPECT_EQ(reflected.status, RayStatus::total_internal_reflection);
    EXPECT_EQ(reflected.surface, 1);
}

TEST(Trace, FollowsBeyondRimsWhenAskedAndNamesTheFirst) {
    const TraceLens<double> two = build({{0, 0, 1.0, 1.5}, {0, 5.0, 1.0, 1.0}});
    std::vector<RayStatus> statuses;
    const TracedRay<double> out = trace<Direction::forward, Rims::follow>(
        two, Ray<double>{{0, 2, -5}, {0, 0, 1}},
        [&](const SurfaceEvent<double>& event) { statuses.push_back(event.status); });
    EXPECT_EQ(out.status, RayStatus::clipped);
    EXPECT_EQ(out.surface, 0);
    EXPECT_EQ(statuses, (std::vector{RayStatus::clipped, RayStatus::ok}));
    EXPECT_EQ(out.ray.origin, (Vec3d{0, 2, 5}));
}

// A dome takes light from more than 90° off the axis: the ray meets its front, not the far side. Closed form: by
// symmetry the ray through the centre of curvature meets the sphere at R times its reversed direction, at normal
// incidence.
TEST(Intersect, DomeIsMetFromBehindTheFrontPlane) {
    constexpr double kRadius = 10.0;
    for (const double field_deg : {0.0, 60.0, 89.0, 90.0, 91.0, 100.0, 110.0}) {
        const double field = radians(field_deg);
        const Vec3d direction{0.0, std::sin(field), std::cos(field)};
        const Vec3d centre{0.0, 0.0, kRadius};
        const Intersection<double> met =
            intersect(Ray<double>{centre - 40.0 * direction, direction}, 1.0 / kRadius, 1.0);
        const Vec3d expected = centre - kRadius * direction;
        const bool on_front_half = expected.z < kRadius;
        EXPECT_EQ(met.hit, on_front_half) << field_deg;
        if (on_front_half) {
            EXPECT_NEAR(length(met.point - expected), 0.0, 64 * kUlp * 40.0) << field_deg;
            EXPECT_NEAR(met.cos_incidence, 1.0, 8 * kUlp);
        }
    }
}

// Curvature form: from flat over nearly flat to curved nothing jumps, and the origin may lie 1e6 mm away. The sag of a
// weak surface at height h is c h² / 2 within c³ h⁴ / 8.
TEST(Intersect, KeepsItsDigitsForNearlyFlatSurfacesAndFarOrigins) {
    for (const double curvature : {0.0, 1e-15, 1e-12, 1e-9, 1e-6}) {
        for (const double far : {1.0, 1e3, 1e6}) {
            const Intersection<double> met = intersect(Ray<double>{{0.0, 3.0, -far}, {0.0, 0.0, 1.0}}, curvature, 1.0);
            ASSERT_TRUE(met.hit);
            EXPECT_NEAR(met.point.z, curvature * 4.5, 1e-16 + curvature * 1e-11);
            EXPECT_EQ(met.point.y, 3.0);
        }
    }
}

// float is the fast path: its image error through the Tessar is a few ulp of the path's length, 2^-24 · 120 mm ≈ 7
// µm·1e-3.
TEST(Trace, FloatStaysCloseToDouble) {
    const Lens lens = formats::load_lens("tessar");
    const TraceLens<double> exact = at_wavelength<double>(lens, 550.0);
    const TraceLens<float> fast = at_wavelength<float>(lens, 550.0);
    double worst = 0.0;
    for (double y = -14.0; y <= 14.0; y += 0.5) {
        for (const double field : {0.0, 0.1, 0.2}) {
            const Vec3d direction{0.0, std::sin(field), std::cos(field)};
            const Vec3d origin{0.0, y - 20.0 * std::tan(field), -20.0};
            const TracedRay<double> a = trace<Direction::forward, Rims::follow>(exact, Ray<double>{origin, direction});
            const Ray<float> single{{0.0F, static_cast<float>(origin.y), -20.0F},
                                    {0.0F, static_cast<float>(direction.y), static_cast<float>(direction.z)}};
            const TracedRay<float> b = trace<Direction::forward, Rims::follow>(fast, single);
            if (a.status == RayStatus::ok && b.status == RayStatus::ok) {
                worst = std::max(worst, std::abs(meet_plane(a.ray, exact.image_z).point.y -
                                                 static_cast<double>(meet_plane(b.ray, fast.image_z).point.y)));
            }
        }
    }
    EXPECT_GT(worst, 0.0);
    EXPECT_LT(worst, 120.0 * 0x1p-24 * 16);
}

}  // namespace lensproof::optics::trace_test
