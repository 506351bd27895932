// Astigmatic foci: closed forms, Coddington's equations, and close real rays.
#include "engine/analysis/ray_pencil.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/spectral/wavelengths.h"
#include "tests/engine/analysis/analysis_lens.h"

namespace lensproof::analysis::ray_pencil_test {

optics::PrescribedSurface surface(double radius, double thickness, double semi_diameter, double index = 0.0) {
    optics::PrescribedSurface made{.radius_mm = radius, .thickness_mm = thickness, .semi_diameter_mm = semi_diameter};
    if (index > 0.0) {
        made.medium.n_d = index;
    }
    return made;
}

optics::PrescribedSurface stop(double thickness, double semi_diameter) {
    return {.thickness_mm = thickness, .semi_diameter_mm = semi_diameter, .is_stop = true};
}

AstigmaticFoci foci_at(const optics::Lens& lens, double field, double object_distance = kInfinity) {
    const optics::ChiefRays rays(lens, spectral::kLineD);
    const std::optional<optics::FieldBundle> bundle = optics::field_bundle(rays, field, object_distance);
    return astigmatic_foci(ray_pencil(optics::at_wavelength<double>(lens, spectral::kLineD), bundle.value()).value(),
                           lens.image_z);
}

// A ball with the stop at its centre has no axis: every field has T = S on a sphere about the centre, of radius the
// focal length n R / (2 (n − 1)) (Born & Wolf §4.4; both rays cross the surfaces along their normals).
TEST(RayPencil, BallLensHasOneFocusInEveryDirection) {
    constexpr double kRadius = 10.0;
    constexpr double kIndex = 1.5;
    constexpr double kFocal = kIndex * kRadius / (2.0 * (kIndex - 1.0));
    optics::PrescribedSurface middle = stop(kRadius, 2.0);
    middle.medium.n_d = kIndex;
    const optics::Lens lens = made_of({surface(kRadius, kRadius, 9.9, kIndex), middle, surface(-kRadius, 5.0, 9.9)});
    for (const double field : {0.0, 0.3, 0.9, 1.3}) {
        const AstigmaticFoci foci = foci_at(lens, field);
        const double expected = kRadius + kFocal * std::cos(field) - lens.image_z;
        EXPECT_NEAR(foci.tangential, expected, 1e-12) << field;
        EXPECT_NEAR(foci.sagittal, expected, 1e-12) << field;
    }
}

// A sphere that bends away from an object at the distance R (1 + n) in front of its vertex shows it, from the glass of
// index n behind, at R (1 + n) / n without aberration of any order (Born & Wolf §4.2.3). So T = S there along every
// ray. The rays leave the glass through a sphere about that image, along its normals, and are not bent.
TEST(RayPencil, AplanaticPointsOfASphere) {
    constexpr double kIndex = 1.6;
    constexpr double kRadius = 20.0;
    constexpr double kObject = kRadius * (1.0 + kIndex);
    const optics::Lens lens = made_of(
        {stop(2.0, 10.0), surface(-kRadius, 30.0, 15.0, kIndex), surface(-30.0 - kObject / kIndex, 10.0, 40.0)});
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, spectral::kLineD);
    const double object_z = 2.0 - kObject;
    for (const double slope : {0.0, 0.05, 0.2, 0.35}) {
        optics::FieldBundle bundle{.object_distance = -object_z};
        const Vec3d direction = normalized(Vec3d{0.0, slope, 1.0});
        bundle.chief.front = {{0.0, -object_z * slope, 0.0}, direction};
        const AstigmaticFoci foci = astigmatic_foci(ray_pencil(traced, bundle).value(), lens.image_z);
        const double expected = 2.0 - kObject / kIndex - lens.image_z;
        EXPECT_NEAR(foci.tangential, expected, 1e-11) << slope;
        EXPECT_NEAR(foci.sagittal, expected, 1e-11) << slope;
    }
}

// One refracting sphere by Coddington's equations in their own form (Welford §9.4):
// n' cos²i'/t' − n cos²i/t = (n' cos i' − n cos i) / R, n'/s' − n/s = the same, at a stop on its vertex, and then out
// through a plane, where the bracket vanishes.
TEST(RayPencil, AgreesWithCoddingtonAtASphereAndAPlane) {
    constexpr double kIndex = 1.7;
    constexpr double kRadius = 30.0;
    constexpr double kThickness = 12.0;
    for (const double object : {80.0, kInfinity}) {
        const optics::Lens lens =
            made_of({stop(0.0, 3.0), surface(kRadius, kThickness, 20.0, kIndex), surface(0.0, 20.0, 30.0)});
        for (const double field : {0.1, 0.5, 1.2}) {
            const double inside = std::asin(std::sin(field) / kIndex);
            const double power = (kIndex * std::cos(inside) - std::cos(field)) / kRadius;
            const double cos2 = std::cos(field) * std::cos(field);
            const double cos2_inside = std::cos(inside) * std::cos(inside);
            const double start = -std::cos(field) / object;  // 1/t, 1/s
            const double path = kThickness / std::cos(inside);
            const double t = kIndex * cos2_inside / (cos2 * start + power) - path;
            const double s = kIndex / (start + power) - path;
            const double t_out = t * cos2 / (kIndex * cos2_inside);
            const double s_out = s / kIndex;
            const AstigmaticFoci foci = foci_at(lens, field, object);
            EXPECT_NEAR(foci.tangential, t_out * std::cos(field) - 20.0, 1e-11) << field;
            EXPECT_NEAR(foci.sagittal, s_out * std::cos(field) - 20.0, 1e-11) << field;
        }
    }
}

// Parallel rays stay parallel through a plate: the foci are infinite, not a division by 0.
TEST(RayPencil, PlateLeavesParallelRaysParallel) {
    const optics::Lens lens = made_of({stop(3.0, 3.0), surface(0.0, 10.0, 20.0, 1.5), surface(0.0, 20.0, 30.0)});
    for (const double field : {0.0, 0.7}) {
        const AstigmaticFoci foci = foci_at(lens, field);
        EXPECT_TRUE(std::isinf(foci.tangential));
        EXPECT_TRUE(std::isinf(foci.sagittal));
    }
}

/// Image points around the chief ray by central differences of real rays in long double at a distance of h and 2 h,
/// extrapolated to order h⁴.
std::array<Vec2d, 2> close_rays(const optics::TraceLens<long double>& lens, const optics::FieldBundle& bundle,
                                double image_z) {
    const auto meets = [&](Vec2d offset) {
        // The bundle's rays are rounded to double; the pencil of an infinite object only needs their origins moved.
        const Vec3d at = bundle.chief.front.origin;
        const std::array<Vec3d, 2> axes = bundle.across();
        const auto part = [&](double a, double x, double y) {
            return static_cast<long double>(a) + static_cast<long double>(offset.x) * static_cast<long double>(x) +
                   static_cast<long double>(offset.y) * static_cast<long double>(y);
        };
        const Vec3d& d = bundle.chief.front.direction;
        const Ray<long double> ray{
            {part(at.x, axes[0].x, axes[1].x), part(at.y, axes[0].y, axes[1].y), part(at.z, axes[0].z, axes[1].z)},
            normalized(Vec3<long double>{d.x, d.y, d.z})};
        const auto traced = optics::trace<optics::Direction::forward, optics::Rims::follow>(lens, ray);
        return optics::meet_plane(traced.ray, static_cast<long double>(image_z)).point;
    };
    constexpr double kStep = 1e-3;
    std::array<Vec2d, 2> slopes;
    for (std::size_t i = 0; i < 2; ++i) {
        const auto difference = [&](double h) {
            const Vec2d offset{i == 0 ? h : 0.0, i == 0 ? 0.0 : h};
            const auto ahead = meets(offset);
            const auto back = meets({-offset.x, -offset.y});
            return Vec3<long double>{(ahead.x - back.x) / (2 * h), (ahead.y - back.y) / (2 * h), 0.0L};
        };
        const auto fine = difference(kStep);
        const auto coarse = difference(2 * kStep);
        slopes[i] = {static_cast<double>((4 * fine.x - coarse.x) / 3),
                     static_cast<double>((4 * fine.y - coarse.y) / 3)};
    }
    return slopes;
}

// How image points move with the offset, by the pencil and by close rays: sphere, conic, asphere, toroid, a kinoform
// and an ideal lens, all of them tilted and decentred. The remainder of the extrapolation is of order h⁴ = 1e-12 times
// a fifth derivative; noise is 1e-19 · 100 / 1e-3.
TEST(RayPencil, MovesAsCloseRealRaysDo) {
    optics::Prescription prescription;
    prescription.surfaces = {surface(45.0, 6.0, 15.0, 1.6),  surface(-300.0, 5.0, 15.0), stop(4.0, 6.0),
                             surface(-40.0, 3.0, 15.0, 1.7), surface(80.0, 4.0, 15.0),   surface(150.0, 4.0, 15.0, 1.5),
                             surface(-35.0, 70.0, 15.0)};
    prescription.surfaces[1].conic = -2.5;
    prescription.surfaces[3].asphere = {1e-4, 2e-6, -3e-9};
    prescription.surfaces[4].radius_x_mm = 120.0;
    prescription.surfaces[4].asphere = {0.0, 1e-6};
    prescription.surfaces[4].phase =
        optics::PhaseElement{.radial = {-1e-3, 4e-6, -1e-8}, .design_wavelength_nm = 500.0};
    prescription.surfaces[6].thickness_mm = 10.0;
    prescription.surfaces.push_back(surface(kInfinity, 60.0, 15.0));
    prescription.surfaces[7].ideal_focal_length_mm = 90.0;
    for (const bool is_displaced : {false, true}) {
        if (is_displaced) {
            // Not in a chief ray's way at its vertex, where the third derivative jumps.
            prescription.surfaces[5].odd_asphere = {0.0, 2e-4, -3e-6};
            prescription.surfaces[5].misalignment.decentre_mm = {0.5, 0.3};
            prescription.surfaces[0].misalignment = {.decentre_mm = {0.2, -0.1}, .tilt_deg = {1.5, 0.5, 10.0}};
            prescription.surfaces[7].misalignment = {.decentre_mm = {0.4, -0.5}, .tilt_deg = {3.0, -2.0, 5.0}};
            prescription.surfaces[4].misalignment = {.decentre_mm = {-0.3, 0.2}, .tilt_deg = {-2.0, 1.0, 25.0}};
        }
        const optics::Lens lens = optics::make_lens(prescription, {});
        const optics::ChiefRays rays(lens, spectral::kLineD);
        for (const double field : {0.0, 10.0 * kDegree}) {
            const optics::FieldBundle bundle = optics::field_bundle(rays, field).value();
            const RayPencil pencil = ray_pencil(optics::at_wavelength<double>(lens, spectral::kLineD), bundle).value();
            const auto slopes =
                close_rays(optics::at_wavelength<long double>(lens, spectral::kLineD), bundle, lens.image_z);
            const double distance = optics::meet_plane(pencil.chief, lens.image_z).distance;
            for (std::size_t i = 0; i < 2; ++i) {
                const Vec3d across = pencil.shift[i] + distance * pencil.turn[i];
                const Vec3d& d = pencil.chief.direction;
                EXPECT_NEAR(across.x - d.x / d.z * across.z, slopes[i].x, 1e-10) << is_displaced << field;
                EXPECT_NEAR(across.y - d.y / d.z * across.z, slopes[i].y, 1e-10) << is_displaced << field;
            }
        }
    }
}

// A lens turned about its axis keeps its foci, though its focal lines then lie askew to the offsets' axes; the toroid
// turned by 90° has them exchanged.
TEST(RayPencil, FocalLinesTurnWithTheLens) {
    const auto turned = [](double degrees) {
        optics::Prescription prescription;
        prescription.surfaces = {stop(2.0, 3.0), surface(50.0, 4.0, 15.0, 1.6), surface(-60.0, 40.0, 15.0)};
        prescription.surfaces[1].radius_x_mm = 40.0;
        prescription.surfaces[1].misalignment.tilt_deg = {0.0, 0.0, degrees};
        return foci_at(optics::make_lens(prescription, {}), 0.0);
    };
    const AstigmaticFoci straight = turned(0.0);
    EXPECT_GT(std::abs(straight.tangential - straight.sagittal), 1.0);
    for (const double degrees : {30.0, 44.0, 46.0, 90.0}) {
        const AstigmaticFoci foci = turned(degrees);
        const bool exchanged = degrees > 45.0;
        EXPECT_NEAR(exchanged ? foci.sagittal : foci.tangential, straight.tangential, 1e-11) << degrees;
        EXPECT_NEAR(exchanged ? foci.tangential : foci.sagittal, straight.sagittal, 1e-11) << degrees;
    }
}

}  // namespace lensproof::analysis::ray_pencil_test
