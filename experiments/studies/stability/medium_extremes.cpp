// Indices, critical angles, thicknesses, many surfaces, ends of glass formulas.
#include <cmath>
#include <numbers>

#include "engine/formats/glass/shipped_glasses.h"
#include "experiments/studies/stability/extreme_parts.h"
#include "experiments/studies/stability/extremes.h"

namespace lensproof::studies {

namespace {

/// Half a ball of index `n` whose centre lies in its flat back: a ray towards that centre meets the back at its own
/// angle from the axis.
StabilityCase half_ball(double n, double angle, std::mt19937_64& random) {
    constexpr double kRadius = 10.0;
    std::uniform_real_distribution<double> about(-1.0, 1.0);
    std::vector<Ray<double>> rays;
    rays.reserve(kRaysPerValue);
    for (int i = 0; i < kRaysPerValue; ++i) {
        const double turn = std::numbers::pi * about(random);
        const Vec3d direction{std::sin(angle) * std::sin(turn), std::sin(angle) * std::cos(turn), std::cos(angle)};
        // Up to 1 mm beside the centre, along the back, so that the curve refracts too.
        const double beside = i < kRaysPerValue / 2 ? 0.0 : about(random);
        const Vec3d aim{beside, 0.0, kRadius};
        rays.push_back({aim - 30.0 * direction, direction});
    }
    return {lens_of({{.radius = kRadius, .thickness = kRadius, .n = n}, {.thickness = 1.0}}), rays};
}

StabilityCase critical_case(double n, double beyond, std::mt19937_64& random) {
    return half_ball(n, std::asin(1.0 / n) + beyond, random);
}

StabilityCase matched_case(double difference, std::mt19937_64& random) {
    return {lens_of({{.thickness = 5.0, .n = 1.5},
                     {.radius = 12.0, .thickness = 5.0, .n = 1.5 + difference},
                     {.thickness = 20.0}}),
            random_rays(10.0, 0.5, random)};
}

/// A flat boundary between nearly the same indices, which light meets about a thousandth of a radian from grazing.
StabilityCase matched_grazing_case(double difference, std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(0.5, 1.5);
    std::vector<Ray<double>> rays;
    rays.reserve(kRaysPerValue);
    for (int i = 0; i < kRaysPerValue; ++i) {
        const double angle = 1e-3 * unit(random);
        rays.push_back({{0.0, 0.0, -0.01}, {0.0, std::cos(angle), std::sin(angle)}});
    }
    optics::TraceLens<double> lens{.surfaces = {}, .image_z = 0.1};
    lens.surfaces.push_back(optics::make_trace_surface(0.0, 0.0, 1e6, 1.5, 1.5 + difference, false));
    return {lens, rays};
}

StabilityCase index_case(double n, std::mt19937_64& random) {
    return {lens_of({{.radius = 30.0, .thickness = 5.0, .n = n}, {.radius = -60.0, .thickness = 20.0}}),
            random_rays(10.0, 0.5, random)};
}

/// Rays from around the axis, `gap` in front of the lens that they are aimed at.
std::vector<Ray<double>> rays_over(double gap, std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(-5.0, 5.0);
    std::vector<Ray<double>> rays;
    rays.reserve(kRaysPerValue);
    for (int i = 0; i < kRaysPerValue; ++i) {
        const Vec3d from{unit(random), unit(random), -1.0};
        const Vec3d aim{unit(random), unit(random), gap};
        rays.push_back(gap > 0.0 ? ray_through(from, aim) : Ray<double>{from, {0.0, 0.0, 1.0}});
    }
    return rays;
}

StabilityCase gap_case(double gap, std::mt19937_64& random) {
    return {
        lens_of(
            {{.thickness = gap}, {.radius = 40.0, .thickness = 4.0, .n = 1.6}, {.radius = -40.0, .thickness = 30.0}}),
        rays_over(gap, random)};
}

StabilityCase glass_thickness_case(double thickness, std::mt19937_64& random) {
    return {lens_of({{.thickness = thickness, .n = 1.6}, {.radius = -40.0, .thickness = 30.0}}),
            rays_over(thickness, random)};
}

/// Forwards to a dummy, back by `thickness` to another, and on to a lens.
StabilityCase backwards_case(double thickness, std::mt19937_64& random) {
    return {lens_of({{.thickness = 3.0},
                     {.thickness = -thickness},
                     {.thickness = thickness},
                     {.radius = 40.0, .thickness = 4.0, .n = 1.6},
                     {.radius = -40.0, .thickness = 30.0}}),
            random_rays(5.0, 0.1, random)};
}

StabilityCase many_surfaces_case(double count, std::mt19937_64& random) {
    std::uniform_real_distribution<double> radius(40.0, 200.0);
    std::vector<SurfaceRow> rows;
    rows.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < static_cast<int>(count); ++i) {
        const double sign = (random() & 1U) != 0 ? 1.0 : -1.0;
        const bool is_last = i + 1 == static_cast<int>(count);
        rows.push_back({.radius = sign * radius(random),
                        .thickness = is_last ? 10.0 : 0.5,
                        .n = i % 2 == 0 && !is_last ? 1.6 : 1.0,
                        .semi_diameter = 30.0});
    }
    return {lens_of(rows), random_rays(3.0, 0.02, random)};
}

/// A cemented doublet of catalogue glasses, whose formulas hold from 300 (N-BK7) and 320 nm (F2) to 2500 nm.
StabilityCase wavelength_case(double wavelength_nm, std::mt19937_64& random) {
    optics::Prescription prescription = prescription_of({{.radius = 60.0, .thickness = 6.0},
                                                         {.radius = -45.0, .thickness = 2.0},
                                                         {.radius = -130.0, .thickness = 95.0}});
    prescription.surfaces[1].medium.glass = "N-BK7";
    prescription.surfaces[2].medium.glass = "F2";
    return {optics::at_wavelength<double>(optics::make_lens(prescription, formats::shipped_glasses()), wavelength_nm),
            random_rays(10.0, 0.1, random)};
}

}  // namespace

std::vector<Extreme> medium_extremes() {
    const auto critical = [](double n, double side) {
        return [n, side](double x, std::mt19937_64& random) { return critical_case(n, side * x, random); };
    };
    const std::vector<double> steps = decades(1e-16, 0.1);
    return {
        {"critical-below", "Short of the critical angle, n = 1.5", "From glass into air, at the critical angle less x.",
         "x", "rad", steps, true, critical(1.5, -1.0)},
        {"critical-beyond", "Beyond the critical angle, n = 1.5", "From glass into air, at the critical angle and x.",
         "x", "rad", steps, true, critical(1.5, 1.0)},
        {"critical-high-index", "Short of the critical angle, n = 4", "From n = 4 into air.", "x", "rad", steps, true,
         critical(4.0, -1.0)},
        {"index-matched", "Nearly the same index on both sides", "A boundary of R = 12 mm between 1.5 and 1.5 + Δn.",
         "Δn", "", decades(1e-16, 1.0), true, matched_case},
        {"index-matched-grazing", "Nearly the same index, at grazing incidence",
         "A flat boundary between 1.5 and 1.5 + Δn, light at 1 mrad from it.", "Δn", "", decades(1e-16, 1.0), true,
         matched_grazing_case},
        {"index",
         "High indices",
         "A biconvex lens; 5 is the most that a prescription may have.",
         "index",
         "",
         {1.0, 1.0000000001, 1.0001, 1.3, 1.5, 1.8, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5},
         false,
         index_case,
         1.0,
         5.0},
        {"gap", "Air in front of a lens", "Rays that cross the gap and meet the lens.", "thickness", "mm",
         [] {
             std::vector<double> values = decades(1e-9, 1e9);
             values.insert(values.begin(), 0.0);
             return values;
         }(),
         true, gap_case},
        {"glass-thickness", "Glass, thin and thick", "A rod with a curved end, and rays that run its length.",
         "thickness", "mm",
         [] {
             std::vector<double> values = decades(1e-9, 1e9);
             values.insert(values.begin(), 0.0);
             return values;
         }(),
         true, glass_thickness_case},
        {"backwards", "Negative thicknesses between dummies", "Back by a length, and forwards again to a lens.",
         "−thickness", "mm", decades(1e-9, 1e9), true, backwards_case},
        {"surfaces",
         "Many surfaces",
         "Random radii from 40 to 200 mm of either sign, n = 1.6 and air in turn.",
         "surfaces",
         "",
         {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0},
         true,
         many_surfaces_case},
        {"wavelength",
         "Ends of glass formulas",
         "A doublet of N-BK7 and F2, at wavelengths up to the ends of their formulas and beyond.",
         "wavelength",
         "nm",
         {1e-3, 200.0, 319.999999, 320.0, 320.000001, 400.0, 550.0, 1000.0, 2000.0, 2499.999999, 2500.0, 2500.000001,
          1e9},
         true,
         wavelength_case,
         320.0,
         2500.0},
    };
}

}  // namespace lensproof::studies
