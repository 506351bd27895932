// Radii, hemispheres, conics, aspheres, tilts and decentres.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/studies/stability/extreme_parts.h"
#include "experiments/studies/stability/extremes.h"

namespace lensproof::studies {

namespace {

constexpr double kIndex = 1.5;
constexpr double kRadius = 10.0;

/// A surface of glass with a flat back, and 50 mm to the image.
StabilityCase plano(const SurfaceRow& front, std::vector<Ray<double>> rays) {
    return {lens_of({front, {.thickness = 50.0}}), std::move(rays)};
}

StabilityCase radius_case(double radius, std::mt19937_64& random) {
    const double reach = std::min(0.9 * std::abs(radius), 10.0);
    StabilityCase made = plano({.radius = radius, .thickness = std::min(5.0, 2.0 * std::abs(radius)), .n = kIndex},
                               random_rays(reach, 0.3, random, 2.0 * std::min(10.0, std::abs(radius))));
    if (std::isinf(radius)) {
        made.lens.surfaces[1].curvature = std::copysign(0.0, radius);  // a prescription knows one zero only
    }
    return made;
}

std::vector<double> radii(double sign) {
    std::vector<double> values{sign * 1e-4};
    for (const double radius : decades(1e-3, 1e15)) {
        values.push_back(sign * radius);
    }
    values.push_back(sign * kFlatRadius);
    return values;
}

/// Axis-parallel rays at the height R (1 − x), around the rim's whole circle.
StabilityCase tangent_case(double x, std::mt19937_64& random) {
    std::uniform_real_distribution<double> angle(0.0, 2.0 * std::numbers::pi);
    std::vector<Ray<double>> rays;
    rays.reserve(kRaysPerValue);
    for (int i = 0; i < kRaysPerValue; ++i) {
        const double turn = i == 0 ? 0.0 : angle(random);
        const double height = kRadius * (1.0 - x);
        rays.push_back({{height * std::sin(turn), height * std::cos(turn), -5.0}, {0.0, 0.0, 1.0}});
    }
    return {lens_of({{.radius = kRadius, .thickness = 12.0, .n = kIndex}, {.thickness = 1.0}}), rays};
}

StabilityCase hemisphere_case(double fraction, std::mt19937_64& random) {
    return plano({.radius = kRadius, .thickness = 12.0, .n = kIndex, .semi_diameter = fraction * kRadius},
                 random_rays(fraction * kRadius, 0.5, random));
}

StabilityCase conic_case(double conic, std::mt19937_64& random) {
    // An ellipsoid with k > −1 ends at r = R / √(1 + k).
    const double end = conic > -1.0 ? kRadius / std::sqrt(1.0 + conic) : kRadius;
    return plano({.radius = kRadius, .thickness = 5.0, .n = kIndex, .conic = conic},
                 random_rays(0.9 * std::min(end, kRadius), 0.1, random));
}

/// Terms of A u², −2 A u³ and A u⁴ with u = (r / 10 mm)²: at the edge they cancel, value and slope.
StabilityCase asphere_case(double size, std::mt19937_64& random) {
    SurfaceRow row{.radius = 50.0, .thickness = 5.0, .n = kIndex};
    row.asphere[1] = size * 1e-4;
    row.asphere[2] = -2.0 * size * 1e-6;
    row.asphere[3] = size * 1e-8;
    return plano(row, random_rays(10.0, std::min(0.1, 0.1 / size), random));
}

StabilityCase tilt_case(double tilt_deg, std::mt19937_64& random) {
    SurfaceRow row{.radius = kRadius, .thickness = 5.0, .n = kIndex};
    row.misalignment.tilt_deg = {tilt_deg, 0.0, 0.0};
    return plano(row, random_rays(2.0, 0.1, random));
}

StabilityCase decentre_case(double decentre_mm, std::mt19937_64& random) {
    // The rays follow the vertex, which a curved surface shifts by `decentre_mm`.
    SurfaceRow row{.radius = kRadius, .thickness = 5.0, .n = kIndex, .semi_diameter = 8.0};
    row.misalignment.decentre_mm = {0.0, decentre_mm};
    std::vector<Ray<double>> rays = random_rays(5.0, 0.1, random);
    for (Ray<double>& ray : rays) {
        ray.origin.y += decentre_mm;
    }
    StabilityCase made = plano(row, rays);
    for (optics::TraceSurface<double>& surface : made.lens.surfaces) {
        surface.semi_diameter_squared = surface.special < 0 ? 1e20 : surface.semi_diameter_squared;
    }
    return made;
}

constexpr double kLeastRadius = 1e-3;  // mm, that a prescription may have

}  // namespace

std::vector<Extreme> shape_extremes() {
    return {
        {"radius-convex", "Radius, convex", "Plano-convex, n = 1.5, rays over 0.9 R or 10 mm with slopes to 0.3.",
         "radius", "mm", radii(1.0), true, radius_case, kLeastRadius},
        {"radius-concave", "Radius, concave", "The same, with the curve turned; −∞ is a curvature of −0.", "−radius",
         "mm", radii(1.0), true, [](double radius, std::mt19937_64& random) { return radius_case(-radius, random); },
         kLeastRadius},
        {"hemisphere",
         "Hemispheres and beyond",
         "R = 10 mm, rays over the whole semi-diameter with slopes to 0.5.",
         "semi-diameter / radius",
         "",
         {0.1, 0.25, 0.5, 0.75, 0.9, 0.99, 0.999, 1.0, 1.001, 1.01, 1.1, 1.25, 1.5, 2.0},
         false,
         hemisphere_case},
        {"tangent", "Rays near the edge of a hemisphere, and tangent to it",
         "R = 10 mm, rays parallel to the axis at the height R (1 − x); at x = 0 they touch.", "x", "",
         [] {
             std::vector<double> values = decades(1e-17, 0.1);
             values.insert(values.begin(), 0.0);
             return values;
         }(),
         true, tangent_case},
        {"conic-positive", "Conic constants above 0", "R = 10 mm, rays over 0.9 of what the ellipsoid spans.",
         "conic constant", "", decades(1e-6, 1e6), true, conic_case},
        {"conic-negative", "Conic constants below 0", "R = 10 mm, rays over 9 mm or 0.9 of what the conic spans.",
         "−conic constant", "", decades(1e-6, 1e6), true,
         [](double conic, std::mt19937_64& random) { return conic_case(-conic, random); }},
        {"asphere", "Aspheres of large terms that cancel",
         "Terms in r⁴, r⁶ and r⁸ of up to 2 A mm, whose sum is 0 at 10 mm.", "A", "mm", decades(1e-6, 1e6), true,
         asphere_case},
        {"tilt",
         "A tilted surface",
         "R = 10 mm, tilted about x at its vertex.",
         "tilt",
         "°",
         {0.0, 1e-12, 1e-9, 1e-6, 1e-3, 1e-2, 0.1, 1.0, 10.0, 30.0, 60.0, 80.0, 89.0},
         true,
         tilt_case},
        {"decentre", "A decentred surface", "R = 10 mm, moved along y, and the rays with it.", "decentre", "mm",
         decades(1e-12, 1e9, 0.5), true, decentre_case},
    };
}

}  // namespace lensproof::studies
