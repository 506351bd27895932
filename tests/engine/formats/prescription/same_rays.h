// tests/engine/formats/prescription/same_rays.h — two prescriptions held to be the same lens, ray by ray.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/optics/lens.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::formats {

/// A path of a ray: its points and states at every surface, and where it meets the sensor's plane.
struct Path {
    std::vector<Vec3d> points;
    std::vector<optics::RayStatus> states;
};

inline Path path_of(const optics::TraceLens<double>& lens, const Ray<double>& ray) {
    Path path;
    const optics::TracedRay<double> traced =
        optics::trace<optics::Direction::forward, optics::Rims::follow>(lens, ray, [&](const auto& event) {
            path.points.push_back(event.ray.origin);
            path.states.push_back(event.status);
        });
    if (path.points.size() == lens.surfaces.size() && traced.status != optics::RayStatus::missed &&
        traced.status != optics::RayStatus::total_internal_reflection) {
        path.points.push_back(optics::meet_plane(traced.ray, lens.image_z).point);
    }
    return path;
}

/// Rays over the front surface's aperture and from all over the field, most of them skew.
inline std::vector<Ray<double>> rays_into(const optics::Lens& lens) {
    std::vector<Ray<double>> rays;
    const double rim = lens.surfaces.front().semi_diameter;
    for (int field = 0; field < 7; ++field) {
        const double angle = 0.14 * field;
        const double azimuth = 1.1 * field;
        const Vec3d direction{std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth),
                              std::cos(angle)};
        for (int point = 0; point < 60; ++point) {
            const double radius = rim * std::sqrt((point + 0.5) / 60.0);
            const double turn = 2.399963229728653 * point;  // the golden angle: an even spread
            const Vec3d on_front{radius * std::cos(turn), radius * std::sin(turn), 0.0};
            rays.push_back({on_front - 20.0 * direction, direction});
        }
    }
    return rays;
}

/// The furthest apart that two lenses take any ray at any surface; infinite where one of them stops or loses a ray that
/// the other does not. Counts the points compared.
inline double furthest_apart(const optics::Lens& a, const optics::Lens& b, double wavelength_nm, int& points) {
    const optics::TraceLens<double> trace_a = optics::at_wavelength<double>(a, wavelength_nm);
    const optics::TraceLens<double> trace_b = optics::at_wavelength<double>(b, wavelength_nm);
    double furthest = 0.0;
    for (const Ray<double>& ray : rays_into(a)) {
        const Path path_a = path_of(trace_a, ray);
        const Path path_b = path_of(trace_b, ray);
        if (path_a.states != path_b.states || path_a.points.size() != path_b.points.size()) {
            return kInfinity;
        }
        for (std::size_t i = 0; i < path_a.points.size(); ++i) {
            furthest = std::max(furthest, length(path_a.points[i] - path_b.points[i]));
            ++points;
        }
    }
    return furthest;
}

inline const std::vector<double> kColours = {spectral::kLineF, spectral::kLineD, spectral::kLineC};

/// At each of the wavelengths every ray meets every surface at the same point to 1e-9 mm.
inline void expect_same_rays(const optics::Prescription& expected, const optics::Prescription& found,
                             const std::vector<double>& wavelengths_nm = kColours) {
    const optics::GlassCatalogue& glasses = shipped_glasses();
    const optics::Lens first = optics::make_lens(expected, glasses);
    const optics::Lens second = optics::make_lens(found, glasses);
    EXPECT_NEAR(first.image_z, second.image_z, 1e-10);
    int points = 0;
    for (const double wavelength_nm : wavelengths_nm) {
        EXPECT_LE(furthest_apart(first, second, wavelength_nm, points), 1e-9) << wavelength_nm << " nm";
    }
    EXPECT_GT(points, 1000);
}

}  // namespace lensproof::formats
