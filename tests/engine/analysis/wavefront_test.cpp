// Optical path differences against closed forms, Hamilton's relation, and a 50-digit trace from the object itself.
#include "engine/analysis/wavefront.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/analysis/wavefront_map.h"
#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/convert_lens.h"
#include "engine/spectral/wavelengths.h"
#include "tests/engine/analysis/analysis_field.h"
#include "tests/engine/perfect_lens.h"

namespace lensproof::analysis::wavefront_test {

using Exact = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

optics::FieldBundle bundle_at(const optics::Lens& lens, double field_angle, double object_distance = kInfinity) {
    const optics::ChiefRays chiefs(lens, spectral::kLineD, optics::Rims::follow);
    if (std::isinf(object_distance)) {
        return {.chief = chiefs.at_field(field_angle).value()};
    }
    const double height = -object_distance * std::tan(field_angle);
    return {.chief = chiefs.from_point(height, -object_distance).value(), .object_distance = object_distance};
}

std::vector<optics::RegionNode> ring(double radius) {
    std::vector<optics::RegionNode> nodes;
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
        const optics::Lens lens = PerfectLens{.stop_distance = stop_distance}.lens();
        const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, spectral::kLineD);
        const optics::FieldBundle bundle = bundle_at(lens, 0.0);
        const Wavefront front =
            wavefront(traced, spectral::kLineD, bundle, reference_sphere(traced, bundle).value(), ring(5.0));
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
        const optics::TraceLens<double> traced = optics::at_wavelength<double>(perfect.lens(), spectral::kLineD);
        const optics::FieldBundle bundle = bundle_at(perfect.lens(), 0.0);
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
        for (const WavefrontRay& ray : wavefront(traced, spectral::kLineD, bundle, sphere, ring(4.9)).rays) {
            const Vec3d direction =
                optics::trace<optics::Direction::forward, optics::Rims::follow>(traced, bundle.ray(ray.offset))
                    .ray.direction;
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
    for (const Case& c : {Case{"tessar", 0.0, 0.0},
                          {"tessar", 0.0, 7.0},
                          {"tessar", 0.0, 15.0},
                          {kMirror, 0.0, 0.5},
                          {kSensorInGlass, 0.0, 7.0}}) {
        const optics::Lens lens = lens_of(c);
        const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, spectral::kLineD);
        const optics::FieldBundle bundle = bundle_at(lens, c.field_deg * kDegree);
        ReferenceSphere plane = reference_sphere(traced, bundle).value();
        plane.curvature = 0.0;
        constexpr double kStep = 1e-3;
        for (const Vec2d at : {Vec2d{3.0, 5.0}, Vec2d{0.0, -8.0}, Vec2d{-6.0, 0.0}}) {
            for (const Vec2d step : {Vec2d{kStep, 0.0}, Vec2d{0.0, kStep}}) {
                const std::vector<optics::RegionNode> nodes = {{{at.x + step.x, at.y + step.y}, 1.0},
                                                               {{at.x - step.x, at.y - step.y}, 1.0}};
                const Wavefront pair = wavefront(traced, spectral::kLineD, bundle, plane, nodes);
                const optics::TracedRay<double> ray =
                    optics::trace<optics::Direction::forward, optics::Rims::follow>(traced, bundle.ray(at));
                const Vec3d error = optics::meet_plane(ray.ray, lens.image_z).point - plane.centre;
                const double expected = error.x * (pair.rays[0].pupil.x - pair.rays[1].pupil.x) +
                                        error.y * (pair.rays[0].pupil.y - pair.rays[1].pupil.y);
                EXPECT_NEAR(pair.rays[0].opd_mm - pair.rays[1].opd_mm, expected, 1e-5 * std::abs(expected) + 1e-12);
            }
        }
    }
}

/// [object → sphere], in 50 digits, for the ray of a given offset, from the object point (or the plane wavefront)
/// itself: the sphere's near point by the quadratic equation.
Exact exact_path(const optics::TraceLens<Exact>& lens, const optics::FieldBundle& bundle, const ReferenceSphere& sphere,
                 Vec2d offset) {
    const Vec3<Exact> along = normalized(optics::convert_vector<Exact>(bundle.chief.front.direction));
    const Vec3<Exact> across{Exact(offset.x), Exact(offset.y) * along.z, -Exact(offset.y) * along.y};
    const Vec3<Exact> through = optics::convert_vector<Exact>(bundle.chief.front.origin) + across;
    Ray<Exact> ray{through, along};
    if (bundle.is_near()) {
        const Exact distance = (Exact(bundle.object_distance) + Exact(bundle.chief.front.origin.z)) / Exact(along.z);
        ray.origin = optics::convert_vector<Exact>(bundle.chief.front.origin) - distance * along;
        ray.direction = normalized(through - ray.origin);
    }
    const optics::TracedRay<Exact> traced =
        optics::trace_through<optics::Direction::forward, optics::Rims::follow, optics::LensMakeup::clear_spheres>(
            lens, ray, [](const optics::SurfaceEvent<Exact>&) {});
    const Vec3<Exact> from_centre = traced.ray.origin - optics::convert_vector<Exact>(sphere.centre);
    const Exact radius = Exact(1) / Exact(sphere.curvature);
    const Exact b = dot(from_centre, traced.ray.direction);
    const Exact root = sqrt(b * b - dot(from_centre, from_centre) + radius * radius);
    return traced.optical_path - b - (radius > 0 ? root : Exact(-root));
}

// Path differences hold λ/1000 = 6e-7 mm at any object distance with six digits to spare.
TEST(Wavefront, HoldsDigitsForFarObjects) {
    for (const char* name : {"tessar", "double-gauss-tronnier", "muller-fisheye"}) {
        const optics::Lens lens = formats::load_lens(name);
        const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, spectral::kLineD);
        const optics::TraceLens<Exact> exact = optics::convert_lens<Exact>(traced);
        const double beam = std::string(name) == "muller-fisheye" ? 0.6 : 5.0;
        for (const double distance : {1e3, 1e8, 1e15, kInfinity}) {
            for (const double field : {0.0, 1e-9, 14.0, 70.0}) {
                if (field == 70.0 && (lens.projection == optics::Projection::rectilinear || std::isfinite(distance))) {
                    continue;
                }
                const optics::FieldBundle bundle = bundle_at(lens, field * kDegree, distance);
                const ReferenceSphere sphere = reference_sphere(traced, bundle).value();
                const Exact chief = exact_path(exact, bundle, sphere, {});
                const Wavefront front = wavefront(traced, spectral::kLineD, bundle, sphere, ring(beam));
                ASSERT_EQ(front.rays.size(), 12U);
                for (const WavefrontRay& ray : front.rays) {
                    const auto expected = static_cast<double>(chief - exact_path(exact, bundle, sphere, ray.offset));
                    EXPECT_NEAR(ray.opd_mm, expected, 1e-12) << name << " " << distance << " " << field;
                }
            }
        }
    }
}

// rayoptics 0.9.8 (waveabr.wave_abr_full_calc) for the Tessar with constant indices, image plane 79.831 mm behind it,
// an object at 1e10 mm, and rays through these points of the first surface; the sign is the same. Its distance of 1e10
// mm leaves the field angle 1e-9 and so the tilt 1e-7 waves.
TEST(Wavefront, AgreesWithRayoptics) {
    struct Row {
        double field_deg;
        Vec3d point;
        double waves;
    };
    constexpr Row kRows[] = {
        {0.0, {0.0, 4.499999993880237, 0.23627912227771064}, -0.03137188949203151},
        {0.0, {3.4999999952074585, 0.0, 0.14277851607055528}, -0.03751195141130368},
        {7.0, {0.0, 2.810004355082121, 0.09197794295521017}, -0.01445219216656292},
        {7.0, {0.0, -5.655393700068386, 0.37378629388256523}, -0.10580081562285439},
        {7.0, {3.499999995218992, -1.6797118439316505, 0.17573089589188007}, 0.11632923681313419},
        {7.0, {2.4999999965611637, 0.8085840008494058, 0.08040811652826477}, 0.05216079007859865},
        {9.8, {0.0, 2.112054244314492, 0.05193705595424786}, -0.09166261913243019},
        {9.8, {0.0, -6.316293211846566, 0.4667608285911814}, -0.16305726330726764},
        {9.8, {3.4999999952302536, -2.361005024467417, 0.20790749614995935}, 0.23805807309892657},
    };
    const optics::Lens lens =
        formats::load_lens("tessar", {.indices = {{"LAK9", 1.691}, {"LLF7", 1.549}, {"SF7", 1.64}}});
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, spectral::kLineD);
    for (const Row& row : kRows) {
        const optics::FieldBundle bundle = bundle_at(lens, row.field_deg * kDegree, 1e10);
        const Vec3d apart = row.point - bundle.chief.front.origin;
        const std::vector<optics::RegionNode> node = {
            {{dot(apart, bundle.across()[0]), dot(apart, bundle.across()[1])}, 1.0}};
        const Wavefront front =
            wavefront(traced, spectral::kLineD, bundle, reference_sphere(traced, bundle).value(), node);
        EXPECT_NEAR(front.rays.front().opd_mm * 1e6 / spectral::kLineD, row.waves, 1e-6)
            << row.field_deg << " " << row.point.y;
    }
}

// A shift of the reference centre in its plane is a tilt, and along the axis a defocus: of a perfect wavefront nothing
// is left once they are taken out, and what was taken out is the shift. Second order: shift² / radius.
TEST(Wavefront, BestSphereFindsTheFocus) {
    const PerfectLens perfect{.beam_radius = 8.0, .stop_distance = 10.0};
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(perfect.lens(), spectral::kLineD);
    const optics::FieldBundle bundle = bundle_at(perfect.lens(), 0.0);
    const std::vector<optics::RegionNode> nodes = optics::region_quadrature(beam_outline(traced, bundle), 6);
    ReferenceSphere sphere = reference_sphere(traced, bundle).value();
    const Vec3d shift{1e-4, -2e-4, 3e-3};
    sphere.centre = sphere.centre + shift;
    const WavefrontErrors errors = wavefront_errors(wavefront(traced, spectral::kLineD, bundle, sphere, nodes));
    EXPECT_NEAR(errors.best_centre.x, -shift.x, 1e-6);
    EXPECT_NEAR(errors.best_centre.y, -shift.y, 1e-6);
    EXPECT_NEAR(errors.best_centre.z, -shift.z, 1e-6);
    EXPECT_LT(errors.rms_without_focus, 1e-6);
    EXPECT_GT(errors.rms_without_tilt, 1e-3);
    EXPECT_GT(errors.rms, errors.rms_without_tilt);
    // Tilt a·r over a disc of radius 1 has the variance a²/4. sin U of the rim by the sine condition that a hyperboloid
    // breaks by 1 %.
    const double tilt = std::hypot(shift.x, shift.y) * 0.16 / (spectral::kLineD * 1e-6);
    EXPECT_NEAR(std::sqrt(errors.rms * errors.rms - errors.rms_without_tilt * errors.rms_without_tilt), 0.5 * tilt,
                0.03 * tilt);
}

// The map of a perfect lens out of focus, W = ζ (1 − cos U) from a telecentric pupil, at each of its cells.
TEST(WavefrontMap, OfADefocusedLens) {
    const PerfectLens perfect{.stop_distance = PerfectLens{}.telecentric_distance(), .defocus = 0.05};
    const optics::FieldBundle bundle = bundle_at(perfect.lens(), 0.0);
    const PolychromaticField field = polychromatic_field(perfect.lens(), bundle, spectral::kLineD,
                                                         std::vector<WeightedWavelength>{{spectral::kLineD, 1.0}});
    constexpr int kCells = 40;
    const WavefrontMap map = wavefront_map(field, field.parts.front(), kCells);
    int inside = 0;
    for (int row = 0; row < map.size; ++row) {
        for (int column = 0; column < map.size; ++column) {
            if (!map.is_inside(row, column)) {
                EXPECT_EQ(map.at(row, column), 0.0);
                continue;
            }
            ++inside;
            const Vec2d pupil = map.cosines(row, column);
            const double cosine = std::sqrt(1.0 - pupil.x * pupil.x - pupil.y * pupil.y);
            EXPECT_NEAR(map.at(row, column), 0.05 * (1.0 - cosine) / (spectral::kLineD * 1e-6), 1e-6);
        }
    }
    // A disc's cells, to those of its rim.
    EXPECT_NEAR(inside / (0.25 * std::numbers::pi * kCells * kCells), 1.0, 0.03);
    EXPECT_EQ(map.status, PupilStatus::ok);
}

// Off the axis the cells are those of `wavefront` at the same rays, rim to rim.
TEST(WavefrontMap, IsTheWavefrontOffTheAxis) {
    const optics::Lens lens = formats::load_lens("double-gauss-tronnier");
    const optics::FieldBundle bundle = bundle_at(lens, 14.0 * kDegree);
    const PolychromaticField field =
        polychromatic_field(lens, bundle, spectral::kLineD, std::vector<WeightedWavelength>{{spectral::kLineD, 1.0}});
    const PolychromaticField::Part& part = field.parts.front();
    const WavefrontMap map = wavefront_map(field, part, 48);
    double sum = 0.0;
    double squares = 0.0;
    int cells = 0;
    for (std::size_t i = 0; i < map.opd_waves.size(); ++i) {
        if (map.inside[i] != 0) {
            sum += map.opd_waves[i];
            squares += map.opd_waves[i] * map.opd_waves[i];
            ++cells;
        }
    }
    const double rms = std::sqrt(squares / cells - sum * sum / cells / cells);
    const double expected = wavefront_errors(wavefront(part.lens, spectral::kLineD, bundle, field.sphere,
                                                       optics::region_quadrature(part.outline, 10)))
                                .rms;
    // Even cells in direction against even cells in the beam, and 4/48 of them at the rim.
    EXPECT_NEAR(rms / expected, 1.0, 0.1);
}

// A chief ray that a rim clips leaves the field its rays.
TEST(Wavefront, GoesOnWhereTheChiefRayIsClipped) {
    const optics::Lens lens = formats::load_lens("muller-fisheye");
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, spectral::kLineD);
    const optics::FieldBundle bundle = bundle_at(lens, 75.5 * kDegree);
    ASSERT_EQ(bundle.chief.status, optics::RayStatus::clipped);
    const optics::RegionOutline outline = beam_outline(traced, bundle);
    ASSERT_FALSE(outline.is_empty());
    const Wavefront front = wavefront(traced, spectral::kLineD, bundle, reference_sphere(traced, bundle).value(),
                                      optics::region_quadrature(outline, 6));
    EXPECT_EQ(front.lost_weight, 0.0);
    double area = 0.0;
    for (const WavefrontRay& ray : front.rays) {
        area += ray.weight;
    }
    EXPECT_NEAR(area / outline.area, 1.0, 1e-12);
    EXPECT_GT(wavefront_errors(front).rms, 0.0);
}

}  // namespace lensproof::analysis::wavefront_test
