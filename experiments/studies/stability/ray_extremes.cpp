// Objects near and far, fields, grazing light, stops, rays that meet a vertex or a rim exactly.
#include <cmath>
#include <numbers>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "experiments/studies/stability/extreme_parts.h"
#include "experiments/studies/stability/extremes.h"

namespace lensproof::studies {

namespace {

optics::TraceLens<double> doublet() {
    return lens_of({{.radius = 60.0, .thickness = 6.0, .n = 1.5, .semi_diameter = 20.0},
                    {.radius = -45.0, .thickness = 2.0, .n = 1.7, .semi_diameter = 20.0},
                    {.radius = -130.0, .thickness = 95.0, .semi_diameter = 20.0}});
}

/// Rays from an object point `distance` in front of the lens, `field` off the axis, to its first surface.
StabilityCase object_case(double distance, double field, std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(-10.0, 10.0);
    std::vector<Ray<double>> rays;
    rays.reserve(kRaysPerValue);
    const bool is_far = std::isinf(distance);
    for (int i = 0; i < kRaysPerValue; ++i) {
        const double reach = is_far ? 1.0 : std::min(1.0, distance / 5.0);
        const Vec3d aim{reach * unit(random), reach * unit(random), 0.0};
        const Vec3d along{0.0, std::sin(field), std::cos(field)};
        rays.push_back(is_far ? Ray<double>{aim - 50.0 * along, along}
                              : ray_through({0.0, -distance * std::tan(field), -distance}, aim));
    }
    return {doublet(), rays};
}

std::vector<double> object_distances() {
    std::vector<double> values = decades(1e-3, 1e15);
    values.push_back(kInfinity);
    return values;
}

/// A flat boundary, met at the angle 90° − x.
StabilityCase grazing_case(double x_deg, bool is_plate, std::mt19937_64& random) {
    const double angle = x_deg * kDegree;
    std::uniform_real_distribution<double> unit(0.5, 1.5);
    std::vector<Ray<double>> rays;
    rays.reserve(kRaysPerValue);
    for (int i = 0; i < kRaysPerValue; ++i) {
        const double own = i == 0 ? angle : angle * unit(random);
        // From so near that it arrives within a few mm.
        rays.push_back({{0.0, 0.0, -std::sin(own)}, {0.0, std::cos(own), std::sin(own)}});
    }
    std::vector<SurfaceRow> rows{{.thickness = 2.0, .n = 1.5}};
    if (is_plate) {
        rows.push_back({.thickness = 0.0});
    } else {
        rows.push_back({.radius = -20.0, .thickness = 10.0});
    }
    return {lens_of(rows), rays};
}

/// A thick dome of a fisheye's kind, and rays at a field angle that meet its front.
StabilityCase field_case(double field_deg, std::mt19937_64& random) {
    constexpr double kRadius = 40.0;
    const double field = field_deg * kDegree;
    // At 90° exactly the direction has no z, which no cosine of a double says.
    const Vec3d along{0.0, std::sin(field), field_deg == 90.0 ? 0.0 : std::cos(field)};
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<Ray<double>> rays;
    rays.reserve(kRaysPerValue);
    for (int i = 0; i < kRaysPerValue; ++i) {
        // Onto the part of the dome that faces the light.
        const double polar = std::min(field, 0.5 * std::numbers::pi) * 0.6 + 0.05 * unit(random);
        const Vec3d aim{2.0 * unit(random), -kRadius * std::sin(polar), kRadius * (1.0 - std::cos(polar))};
        rays.push_back({aim - 100.0 * along, along});
    }
    optics::TraceLens<double> lens = lens_of({{.radius = kRadius, .thickness = 2.0, .n = 1.7, .semi_diameter = 39.9},
                                              {.radius = 24.0, .thickness = 60.0, .semi_diameter = 23.9}});
    lens.surfaces.erase(lens.surfaces.begin());  // a stop in front of a dome would be in its way
    return {lens, rays};
}

/// Parallel light through a stop of f/N onto a hyperbola (k = −n²), which makes a perfect point of it.
StabilityCase stop_case(double f_number, std::mt19937_64& random) {
    constexpr double kFocalLength = 20.0;
    constexpr double kIndex = 1.5;
    const double opening = std::isinf(f_number) ? 0.0 : 0.5 * kFocalLength / f_number;
    StabilityCase made{
        lens_of({{.thickness = 30.0, .n = kIndex},
                 {.radius = -kFocalLength * (kIndex - 1.0), .thickness = kFocalLength, .conic = -kIndex * kIndex}}),
        random_rays(1.1 * opening, 1e-4, random)};
    optics::TraceSurface<double>& stop = made.lens.surfaces.front();
    stop = optics::make_trace_surface(0.0, 0.0, opening, 1.0, 1.0, true);
    return made;
}

/// Rays parallel to the axis, beside a rim of 5 mm by x.
StabilityCase rim_case(double beside, std::mt19937_64& random) {
    std::uniform_real_distribution<double> angle(0.0, 2.0 * std::numbers::pi);
    std::vector<Ray<double>> rays{{{3.0, 4.0 + beside, -5.0}, {0.0, 0.0, 1.0}},
                                  {{0.0, 5.0 + beside, -5.0}, {0.0, 0.0, 1.0}},
                                  {{-5.0 - beside, 0.0, -5.0}, {0.0, 0.0, 1.0}}};
    while (rays.size() < kRaysPerValue) {
        const double turn = angle(random);
        rays.push_back({{(5.0 + beside) * std::sin(turn), (5.0 + beside) * std::cos(turn), -5.0}, {0.0, 0.0, 1.0}});
    }
    return {lens_of({{.radius = 20.0, .thickness = 4.0, .n = 1.5, .semi_diameter = 5.0}, {.thickness = 30.0}}), rays};
}

/// Rays whose point on the first surface is its vertex, or beside it by x.
StabilityCase vertex_case(double beside, std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<Ray<double>> rays;
    rays.reserve(kRaysPerValue);
    for (int i = 0; i < kRaysPerValue; ++i) {
        rays.push_back(ray_through({4.0 * unit(random), 4.0 * unit(random), -10.0}, {beside, -beside, 0.0}));
    }
    return {doublet(), rays};
}

std::vector<double> with_zero(std::vector<double> values) {
    values.insert(values.begin(), 0.0);
    return values;
}

}  // namespace

std::vector<Extreme> ray_extremes() {
    return {
        {"grazing", "Grazing incidence on flat glass", "Into n = 1.5 at 90° less x, and out through a curve.", "x", "°",
         decades(1e-12, 10.0), true, [](double x, std::mt19937_64& random) { return grazing_case(x, false, random); }},
        {"grazing-plate", "Grazing incidence on a plate", "The same, and out through a parallel face.", "x", "°",
         decades(1e-12, 10.0), true, [](double x, std::mt19937_64& random) { return grazing_case(x, true, random); }},
        {"object-on-axis", "Object distance, on the axis", "Rays from the object point over a cemented doublet.",
         "distance", "mm", object_distances(), true,
         [](double distance, std::mt19937_64& random) { return object_case(distance, 0.0, random); }},
        {"object-off-axis", "Object distance, 10° off the axis", "Rays from the object point over a cemented doublet.",
         "distance", "mm", object_distances(), true,
         [](double distance, std::mt19937_64& random) { return object_case(distance, 10.0 * kDegree, random); }},
        {"field",
         "Field angle",
         "Parallel light onto the dome of a fisheye's first lens, from the front to behind.",
         "field angle",
         "°",
         {0.0, 1e-12, 1e-9, 1e-6, 1e-3, 1.0, 10.0, 30.0, 60.0, 80.0, 89.0, 90.0 - 1e-9, 90.0, 90.0 + 1e-9, 91.0, 100.0,
          110.0, 120.0, 135.0},
         false,
         field_case},
        {"stop",
         "Stops from f/0.5 to closed",
         "Parallel light through the stop onto a hyperbola, f = 20 mm.",
         "f-number",
         "",
         {0.5, 0.7, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0, 1024.0, 1e9, kInfinity},
         true,
         stop_case},
        {"rim-outside", "Rays on a rim, and outside by x", "A rim of 5 mm, rays parallel to the axis.", "x", "mm",
         with_zero(decades(1e-17, 0.1)), true, rim_case},
        {"rim-inside", "Rays on a rim, and inside by x", "A rim of 5 mm, rays parallel to the axis.", "x", "mm",
         with_zero(decades(1e-17, 0.1)), true, [](double x, std::mt19937_64& random) { return rim_case(-x, random); }},
        {"vertex", "Rays through a vertex, and beside it by x", "A cemented doublet.", "x", "mm",
         with_zero(decades(1e-18, 0.1)), true, vertex_case},
    };
}

std::vector<Extreme> stability_extremes() {
    std::vector<Extreme> all = shape_extremes();
    for (const std::vector<Extreme>& more : {medium_extremes(), ray_extremes()}) {
        all.insert(all.end(), more.begin(), more.end());
    }
    return all;
}

}  // namespace lensproof::studies
