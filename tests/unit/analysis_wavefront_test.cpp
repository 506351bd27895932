// Optical path differences against closed forms, Hamilton's relation, and a 50-digit trace from the object itself.
#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/analysis/wavefront.h"
#include "engine/spectral/wavelengths.h"
#include "tests/unit/perfect_lens.h"

namespace lensproof {
namespace {

using Exact = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

FieldBundle bundle_at(const Lens& lens, double field_angle, double object_distance = kInfinity) {
    const ChiefRays chiefs(lens, kLineD, Rims::follow);
    if (std::isinf(object_distance)) {
        return {.chief = chiefs.at_field(field_angle).value()};
    }
    const double height = -object_distance * std::tan(field_angle);
    return {.chief = chiefs.from_point(height, -object_distance).value(), .object_distance = object_distance};
}

std::vector<BeamNode> ring(double radius) {
    std::vector<BeamNode> nodes;
    for (int i = 0; i < 12; ++i) {
        const double azimuth = 30.0 * i * kDegree;
        nodes.push_back({{radius * std::cos(azimuth), radius * std::sin(azimuth)}, 1.0});
    }
    return nodes;
}

// The sum of a dozen lengths of up to 100 mm: 1e-13 mm is 10 ulp of the longest.
constexpr double kRounding = 1e-13;

TEST(Wavefront, HyperboloidHasNone) {
    for (const double stop_distance : {0.0, 30.0, 46.0, 60.0}) {
        const Lens lens = PerfectLens{.stop_distance = stop_distance}.lens();
        const TraceLens<double> traced = at_wavelength<double>(lens, kLineD);
        const FieldBundle bundle = bundle_at(lens, 0.0);
        const Wavefront front = wavefront(traced, kLineD, bundle, reference_sphere(traced, bundle).value(), ring(5.0));
        ASSERT_EQ(front.rays.size(), 12U);
        for (const WavefrontRay& ray : front.rays) {
            EXPECT_NEAR(ray.opd_mm, 0.0, kRounding) << stop_distance;
        }
    }
}

// Where the image plane stands ζ behind the focus, the ray at angle U passes ζ sin U beside the sphere's centre, and
// its path to a sphere of radius R there is longer by ζ cos U + R − √(R² − ζ² sin²U) than to one about the focus.
TEST(Wavefront, DefocusIsPositiveBehindTheFocus) {
    constexpr double kDefocus = 0.4;
    for (const double stop_distance : {0.0, 30.0, PerfectLens{}.telecentric_distance(), 60.0, 1e6}) {
        const PerfectLens perfect{.stop_distance = stop_distance, .defocus = kDefocus};
        const TraceLens<double> traced = at_wavelength<double>(perfect.lens(), kLineD);
        const FieldBundle bundle = bundle_at(perfect.lens(), 0.0);
        const ReferenceSphere sphere = reference_sphere(traced, bundle).value();
        // The stop, imaged by a thin lens at the rear principal plane, the hyperboloid's vertex (Newton's equation).
        const double beyond_focus =
            perfect.focal_length * perfect.focal_length / (stop_distance - perfect.telecentric_distance());
        const double expected_curvature = 1.0 / (kDefocus - beyond_focus);
        if (stop_distance == perfect.telecentric_distance()) {
            EXPECT_NEAR(sphere.curvature, 0.0, 1e-15);
        } else {
            // Positions along the axis are rounded to an ulp of the largest.
            const double position = std::numeric_limits<double>::epsilon() * stop_distance;
            EXPECT_NEAR(sphere.curvature / expected_curvature, 1.0, 1e-11 + position * std::abs(expected_curvature))
                << stop_distance;
        }
        for (const WavefrontRay& ray : wavefront(traced, kLineD, bundle, sphere, ring(4.9)).rays) {
            const Vec3d direction =
                trace<Direction::forward, Rims::follow>(traced, bundle.ray(ray.offset)).ray.direction;
            const double cosine = direction.z;
            const double sine2 = direction.x * direction.x + direction.y * direction.y;
            const double c = sphere.curvature;
            const double q2 = kDefocus * kDefocus * sine2;
            const double bulge = c == 0.0 ? 0.0 : (1.0 - std::sqrt(1.0 - c * c * q2)) / c;
            // 1e-12: the subtraction above loses what wavefront() does not.
            EXPECT_NEAR(ray.opd_mm, kDefocus * (1.0 - cosine) - bulge, 1e-12) << stop_distance;
            if (stop_distance < 1e6) {  // the last one's pupil is in the focus
                EXPECT_GT(ray.opd_mm, 0.0);
            }
        }
    }
}

// Hamilton: with paths up to the feet of the perpendiculars from C, dW = ε · dL, ε being where the ray meets the plane
// through C, L its direction cosines. Central differences of step h leave h²/6 of third derivatives, 1e-6 of W here.
TEST(Wavefront, GradientIsTheTransverseAberration) {
    const Lens lens = load_lens("tessar");
    const TraceLens<double> traced = at_wavelength<double>(lens, kLineD);
    for (const double field : {0.0, 7.0, 15.0}) {
        const FieldBundle bundle = bundle_at(lens, field * kDegree);
        ReferenceSphere plane = reference_sphere(traced, bundle).value();
        plane.curvature = 0.0;
        constexpr double kStep = 1e-3;
        for (const Vec2d at : {Vec2d{3.0, 5.0}, Vec2d{0.0, -8.0}, Vec2d{-6.0, 0.0}}) {
            for (const Vec2d step : {Vec2d{kStep, 0.0}, Vec2d{0.0, kStep}}) {
                const std::vector<BeamNode> nodes = {{{at.x + step.x, at.y + step.y}, 1.0},
                                                     {{at.x - step.x, at.y - step.y}, 1.0}};
                const Wavefront pair = wavefront(traced, kLineD, bundle, plane, nodes);
                const TracedRay<double> ray = trace<Direction::forward, Rims::follow>(traced, bundle.ray(at));
                const Vec3d error = meet_plane(ray.ray, lens.image_z).point - plane.centre;
                const double expected = error.x * (pair.rays[0].pupil.x - pair.rays[1].pupil.x) +
                                        error.y * (pair.rays[0].pupil.y - pair.rays[1].pupil.y);
                EXPECT_NEAR(pair.rays[0].opd_mm - pair.rays[1].opd_mm, expected, 1e-5 * std::abs(expected) + 1e-12);
            }
        }
    }
}

/// Of a lens of centred spheres.
TraceLens<Exact> in_50_digits(const TraceLens<double>& lens) {
    EXPECT_TRUE(lens.specials.empty());
    TraceLens<Exact> exact{.surfaces = {}, .image_z = lens.image_z};
    for (const TraceSurface<double>& s : lens.surfaces) {
        TraceSurface<Exact> wide =
            make_trace_surface<Exact>(s.curvature, s.vertex_z, Exact(1), s.index_before, s.index_after, s.is_stop);
        wide.semi_diameter_squared = s.semi_diameter_squared;
        exact.surfaces.push_back(wide);
    }
    return exact;
}

Vec3<Exact> widened(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

/// [object → sphere], in 50 digits, for the ray of a given offset, from the object point (or the plane wavefront)
/// itself: the sphere's near point by the quadratic equation.
Exact exact_path(const TraceLens<Exact>& lens, const FieldBundle& bundle, const ReferenceSphere& sphere, Vec2d offset) {
    const Vec3<Exact> along = normalized(widened(bundle.chief.front.direction));
    const Vec3<Exact> across{Exact(offset.x), Exact(offset.y) * along.z, -Exact(offset.y) * along.y};
    const Vec3<Exact> through = widened(bundle.chief.front.origin) + across;
    Ray<Exact> ray{through, along};
    if (bundle.is_near()) {
        const Exact distance = (Exact(bundle.object_distance) + Exact(bundle.chief.front.origin.z)) / Exact(along.z);
        ray.origin = widened(bundle.chief.front.origin) - distance * along;
        ray.direction = normalized(through - ray.origin);
    }
    const TracedRay<Exact> traced =
        trace_through<Direction::forward, Rims::follow, false>(lens, ray, [](const SurfaceEvent<Exact>&) {});
    const Vec3<Exact> from_centre = traced.ray.origin - widened(sphere.centre);
    const Exact radius = Exact(1) / Exact(sphere.curvature);
    const Exact b = dot(from_centre, traced.ray.direction);
    const Exact root = sqrt(b * b - dot(from_centre, from_centre) + radius * radius);
    return traced.optical_path - b - (radius > 0 ? root : Exact(-root));
}

// Path differences hold λ/1000 = 6e-7 mm at any object distance with six digits to spare.
TEST(Wavefront, HoldsDigitsForFarObjects) {
    for (const char* name : {"tessar", "double-gauss-tronnier", "muller-fisheye"}) {
        const Lens lens = load_lens(name);
        const TraceLens<double> traced = at_wavelength<double>(lens, kLineD);
        const TraceLens<Exact> exact = in_50_digits(traced);
        const double beam = std::string(name) == "muller-fisheye" ? 0.6 : 5.0;
        for (const double distance : {1e3, 1e8, 1e15, kInfinity}) {
            for (const double field : {0.0, 1e-9, 14.0, 70.0}) {
                if (field == 70.0 && (lens.projection == Projection::rectilinear || std::isfinite(distance))) {
                    continue;
                }
                const FieldBundle bundle = bundle_at(lens, field * kDegree, distance);
                const ReferenceSphere sphere = reference_sphere(traced, bundle).value();
                const Exact chief = exact_path(exact, bundle, sphere, {});
                const Wavefront front = wavefront(traced, kLineD, bundle, sphere, ring(beam));
                ASSERT_EQ(front.rays.size(), 12U);
                for (const WavefrontRay& ray : front.rays) {
                    const auto expected = static_cast<double>(chief - exact_path(exact, bundle, sphere, ray.offset));
                    EXPECT_NEAR(ray.opd_mm, expected, 1e-12) << name << " " << distance << " " << field;
                }
            }
        }
    }
}

// A shift of the reference centre in its plane is a tilt, and along the axis a defocus: of a perfect wavefront nothing
// is left once they are taken out, and what was taken out is the shift. Second order: shift² / radius.
TEST(Wavefront, BestSphereFindsTheFocus) {
    const PerfectLens perfect{.beam_radius = 8.0, .stop_distance = 10.0};
    const TraceLens<double> traced = at_wavelength<double>(perfect.lens(), kLineD);
    const FieldBundle bundle = bundle_at(perfect.lens(), 0.0);
    const std::vector<BeamNode> nodes = beam_quadrature(beam_outline(traced, bundle), 6);
    ReferenceSphere sphere = reference_sphere(traced, bundle).value();
    const Vec3d shift{1e-4, -2e-4, 3e-3};
    sphere.centre = sphere.centre + shift;
    const WavefrontErrors errors = wavefront_errors(wavefront(traced, kLineD, bundle, sphere, nodes));
    EXPECT_NEAR(errors.best_centre.x, -shift.x, 1e-6);
    EXPECT_NEAR(errors.best_centre.y, -shift.y, 1e-6);
    EXPECT_NEAR(errors.best_centre.z, -shift.z, 1e-6);
    EXPECT_LT(errors.rms_without_focus, 1e-6);
    EXPECT_GT(errors.rms_without_tilt, 1e-3);
    EXPECT_GT(errors.rms, errors.rms_without_tilt);
    // Tilt a·r over a disc of radius 1 has the variance a²/4. sin U of the rim by the sine condition that a hyperboloid
    // breaks by 1 %.
    const double tilt = std::hypot(shift.x, shift.y) * 0.16 / (kLineD * 1e-6);
    EXPECT_NEAR(std::sqrt(errors.rms * errors.rms - errors.rms_without_tilt * errors.rms_without_tilt), 0.5 * tilt,
                0.03 * tilt);
}

// A chief ray that a rim clips leaves the field its rays.
TEST(Wavefront, GoesOnWhereTheChiefRayIsClipped) {
    const Lens lens = load_lens("muller-fisheye");
    const TraceLens<double> traced = at_wavelength<double>(lens, kLineD);
    const FieldBundle bundle = bundle_at(lens, 75.5 * kDegree);
    ASSERT_EQ(bundle.chief.status, RayStatus::clipped);
    const RegionOutline outline = beam_outline(traced, bundle);
    ASSERT_FALSE(outline.is_empty());
    const Wavefront front =
        wavefront(traced, kLineD, bundle, reference_sphere(traced, bundle).value(), beam_quadrature(outline, 6));
    EXPECT_EQ(front.lost_weight, 0.0);
    double area = 0.0;
    for (const WavefrontRay& ray : front.rays) {
        area += ray.weight;
    }
    EXPECT_NEAR(area / outline.area, 1.0, 1e-12);
    EXPECT_GT(wavefront_errors(front).rms, 0.0);
}

}  // namespace
}  // namespace lensproof
