// Rays along ghosts against closed forms and conservation laws.
#include "engine/optics/ghost_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "engine/base/file.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/lens.h"
#include "tests/engine/optics/some_ghosts.h"
#include "tests/engine/random_lens.h"
#include "tests/places.h"

namespace lensproof::optics::ghost_path_test {

constexpr double kUlp = std::numeric_limits<double>::epsilon();

struct Row {
    double curvature;
    double z;
    double index_after;
    double semi_diameter = 1e6;
    bool is_stop = false;
};

template <class T = double>
TraceLens<T> build(const std::vector<Row>& rows, double image_z = 100.0) {
    TraceLens<T> lens{.surfaces = {}, .image_z = static_cast<T>(image_z)};
    T before = T(1);
    for (const Row& row : rows) {
        lens.surfaces.push_back(make_trace_surface<T>(static_cast<T>(row.curvature), static_cast<T>(row.z),
                                                      static_cast<T>(row.semi_diameter), before,
                                                      static_cast<T>(row.index_after), row.is_stop));
        before = static_cast<T>(row.index_after);
    }
    return lens;
}

Ray<double> towards_origin(double slope_angle) {
    const Vec3d direction{0.0, std::sin(slope_angle), std::cos(slope_angle)};
    return {-5.0 * direction, direction};
}

// A plate of thickness t: each return inside it shifts the outgoing ray by 2 t sin i' of its own length across, which
// is 2 t tan i' cos i across the ray outside; the direction stays, the path inside is (2 k + 1) t / cos i', and R² T²
// of it leaves (Airy's sum, term by term; Born & Wolf 7.6.1). Some twenty operations on numbers of size 5 t / cos i'.
TEST(GhostPath, PlateShiftsByWholeReturns) {
    constexpr double kThickness = 7.0;
    constexpr double kIndex = 1.7;
    const TraceLens<double> plate = build({{0, 0, kIndex}, {0, kThickness, 1.0}});
    for (const double incidence : {0.0, 0.1, 0.7, 1.4}) {
        const double sin_inside = std::sin(incidence) / kIndex;
        const double cos_inside = std::sqrt(1.0 - sin_inside * sin_inside);
        const double once = kThickness * sin_inside / cos_inside;
        for (const GhostPath& path : {GhostPath{}, GhostPath{1, 0}, GhostPath{1, 0, 1, 0}}) {
            const auto passages = static_cast<double>(1 + path.size());
            const TracedRay<double> out = trace_ghost(plate, path, towards_origin(incidence));
            ASSERT_EQ(out.status, RayStatus::ok);
            const double tolerance = 40 * kUlp * passages * kThickness;
            EXPECT_NEAR(out.ray.origin.y, passages * once, tolerance);
            EXPECT_NEAR(out.ray.origin.z, kThickness, tolerance);
            EXPECT_NEAR(out.ray.direction.y, std::sin(incidence), 20 * kUlp);
            EXPECT_NEAR(out.ray.direction.z, std::cos(incidence), 20 * kUlp * kIndex * kIndex / std::cos(incidence));
            EXPECT_NEAR(out.optical_path, 5.0 + kIndex * passages * kThickness / cos_inside, 4 * tolerance);
            const auto reflectance = [&](double a, double b) { return std::pow((a - b) / (a + b), 2); };
            const double s = reflectance(std::cos(incidence), kIndex * cos_inside);
            const double p = reflectance(kIndex * std::cos(incidence), cos_inside);
            const double r = 0.5 * (s + p);  // unpolarised at every surface
            EXPECT_NEAR(out.transmittance, std::pow(r, path.size()) * std::pow(1.0 - r, 2), 1e-14);
        }
    }
}

// Energy: over all even ghosts the plate passes T² (1 + R² + R⁴ + …) = (1 − R) / (1 + R), R being either surface's.
// What eight returns leave out is R¹⁶.
TEST(GhostPath, PlatePassesTheGeometricSum) {
    const TraceLens<double> plate = build({{0, 0, 2.0}, {0, 3.0, 1.0}});
    const Ray<double> ray = towards_origin(0.6);
    double sum = 0.0;
    GhostPath path;
    for (int returns = 0; returns < 8; ++returns) {
        sum += trace_ghost(plate, path, ray).transmittance;
        path.insert(path.end(), {1, 0});
    }
    const double r = 1.0 - std::sqrt(trace(plate, ray).transmittance);
    EXPECT_NEAR(sum, (1.0 - r) / (1.0 + r), 1e-15 + std::pow(r, 16));
}

// Two concentric spheres: a ray aimed at their common centre meets every surface along its normal, whatever it
// reflects from, and stays on its line; R = ((n − 1) / (n + 1))² each time. Paths are sums of the radii.
TEST(GhostPath, ConcentricSpheresSendARayThroughTheirCentreBackOnItsLine) {
    constexpr double kOuter = 30.0;
    constexpr double kInner = 20.0;
    constexpr double kIndex = 1.6;
    const TraceLens<double> shells =
        build({{1.0 / kOuter, 0, kIndex}, {1.0 / kInner, kOuter - kInner, 1.0}}, 2.0 * kOuter);
    const double r = std::pow((kIndex - 1.0) / (kIndex + 1.0), 2);
    for (const double angle : {0.0, 0.3, 0.8}) {
        const Vec3d direction{0.0, std::sin(angle), std::cos(angle)};
        const Vec3d centre{0.0, 0.0, kOuter};
        const Ray<double> ray{centre - 2.0 * kOuter * direction, direction};
        const TracedRay<double> out = trace_ghost(shells, {1, 0}, ray);
        ASSERT_EQ(out.status, RayStatus::ok);
        EXPECT_NEAR(length(out.ray.direction - direction), 0.0, 40 * kUlp);
        EXPECT_NEAR(length(out.ray.origin - (centre - kInner * direction)), 0.0, 40 * kUlp * kOuter);
        EXPECT_NEAR(out.optical_path, kOuter + 3.0 * kIndex * (kOuter - kInner), 40 * kUlp * 4 * kOuter);
        EXPECT_NEAR(out.transmittance, r * r * (1.0 - r) * (1.0 - r), 1e-15);
    }
}

// A flat mirror and one of radius R at a distance R / 2: a round trip turns a paraxial ray's phase by θ with
// cos θ = 2 g₁ g₂ − 1 = 0 (Kogelnik & Li 1966, §2.2), so that a ray which enters parallel to the axis meets the sphere
// at heights in proportion to cos(n θ + 45°), and after four round trips is what it was. Beside the axis it differs by
// some squares of height / R.
TEST(GhostPath, MirrorPairRepeatsAfterEightReflections) {
    constexpr double kRadius = 100.0;
    constexpr double kHeight = 1e-4;
    TraceLens<double> cavity = build({{0, 0, 1.0}, {-1.0 / kRadius, 0.5 * kRadius, 1.0}});
    for (TraceSurface<double>& surface : cavity.surfaces) {
        surface.special = static_cast<int>(cavity.specials.size());
        cavity.specials.push_back({});
        cavity.specials.back().coating.reflectance = 1.0;
    }
    const Ray<double> ray{{0.0, kHeight, -1.0}, {0.0, 0.0, 1.0}};
    std::vector<double> heights;
    trace_ghost(cavity, {1, 0, 1, 0, 1, 0, 1, 0}, ray, {}, [&](const SurfaceEvent<double>& event) {
        if (event.surface == 1) {
            heights.push_back(event.ray.origin.y);
        }
    });
    ASSERT_EQ(heights.size(), 5U);
    const double expected[] = {1.0, -1.0, -1.0, 1.0, 1.0};
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_NEAR(heights[i] / kHeight, expected[i], 10.0 * std::pow(kHeight / kRadius, 2) + 1e-9) << i;
    }
}

// A sphere sends a beam that is parallel to its axis through the point (R / 2) / cos i before its centre, i being the
// angle of incidence: the mirror equation without approximation.
TEST(GhostPath, SphereFocusesAsTheMirrorEquationSays) {
    constexpr double kRadius = 50.0;
    const TraceLens<double> mirror = build({{0, 0, 1.0}, {-1.0 / kRadius, 40.0, 1.5}});
    for (const double height : {0.5, 10.0, 25.0, 40.0}) {
        Ray<double> back{};
        trace_ghost(mirror, {1, 0}, Ray<double>{{0.0, height, -5.0}, {0.0, 0.0, 1.0}}, {},
                    [&](const SurfaceEvent<double>& event) {
                        if (event.surface == 1 && back.direction.z == 0.0) {
                            back = event.ray;
                        }
                    });
        const double crossing = back.origin.z - back.origin.y * back.direction.z / back.direction.y;
        const double centre = 40.0 - kRadius;
        const double cos_incidence = std::sqrt(1.0 - std::pow(height / kRadius, 2));
        EXPECT_NEAR(crossing, centre + 0.5 * kRadius / cos_incidence, 100 * kUlp * kRadius * kRadius / height);
    }
}

// Unfolding: where the mirrors are flat, the ghost's ray is that of the lens with the space between them laid out
// again: plate, gap, sphere.
TEST(GhostPath, FlatMirrorsUnfold) {
    const double t = 4.0;
    const double n = 1.5;
    const double c = 0.02;
    const TraceLens<double> folded = build({{0, 0, n}, {0, t, 1.0}, {c, t + 6.0, 1.7}});
    const TraceLens<double> unfolded = build({{0, 0, n}, {0, 3.0 * t, 1.0}, {c, 3.0 * t + 6.0, 1.7}});
    const Ray<double> ray{{1.0, -2.0, -3.0}, normalized(Vec3d{0.1, 0.2, 1.0})};
    const TracedRay<double> a = trace_ghost(folded, {1, 0}, ray);
    const TracedRay<double> b = trace(unfolded, ray);
    ASSERT_EQ(a.status, RayStatus::ok);
    EXPECT_NEAR(length(a.ray.direction - b.ray.direction), 0.0, 40 * kUlp);
    EXPECT_NEAR(length(a.ray.origin - b.ray.origin + Vec3d{0.0, 0.0, 2.0 * t}), 0.0, 100 * kUlp * 20.0);
    EXPECT_NEAR(a.optical_path, b.optical_path, 100 * kUlp * 30.0);
}

/// Rays into the front of a lens.
std::vector<Ray<double>> rays_into(const TraceLens<double>& lens, int count, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const double reach = std::sqrt(lens.surfaces.front().semi_diameter_squared);
    std::uniform_real_distribution<double> position(-reach, reach);
    std::uniform_real_distribution<double> slope(-0.2, 0.2);
    std::vector<Ray<double>> rays;
    for (int i = 0; i < count; ++i) {
        const Vec3d direction = normalized(Vec3d{slope(random), slope(random), 1.0});
        rays.push_back({Vec3d{position(random), position(random), 0.0} - 50.0 * direction, direction});
    }
    return rays;
}

// A path of no reflections is what `trace` does, to the last bit, in either direction, of every kind of surface.
TEST(GhostPath, WithoutReflectionsIsTheTracer) {
    RandomLenses random(3);
    for (int i = 0; i < 40; ++i) {
        const TraceLens<double> lens = at_wavelength<double>(make_lens(random.next(), {}), 550.0);
        for (const Ray<double>& ray : rays_into(lens, 20, static_cast<std::uint64_t>(i))) {
            const auto same = [&](const TracedRay<double>& a, const TracedRay<double>& b) {
                EXPECT_EQ(a.status, b.status);
                EXPECT_EQ(a.surface, b.surface);
                EXPECT_EQ(a.ray.origin, b.ray.origin);
                EXPECT_EQ(a.ray.direction, b.ray.direction);
                EXPECT_EQ(a.optical_path, b.optical_path);
                EXPECT_EQ(a.transmittance, b.transmittance);
            };
            const TracedRay<double> out = trace(lens, ray);
            same(trace_ghost(lens, {}, ray), out);
            same(trace_ghost<Direction::forward, Rims::follow>(lens, {}, ray),
                 trace<Direction::forward, Rims::follow>(lens, ray));
            const Ray<double> back{out.ray.origin + out.ray.direction, -1.0 * out.ray.direction};
            same(trace_ghost<Direction::reverse>(lens, {}, back), trace<Direction::reverse>(lens, back));
        }
    }
}

// Light finds the same path back: a ghost's ray, followed in reverse from where it arrived along the reversed path,
// returns to its origin with the same optical path and transmittance. Steep curvatures amplify rounding, so what is
// asked for is 1e-9 mm of rays whose neighbours 1e-6 mm beside them return too.
TEST(GhostPath, ReverseRetracesForward) {
    for (const char* name : {"tessar", "heliar-tronnier"}) {
        const TraceLens<double> lens = at_wavelength<double>(formats::load_lens(name), 550.0);
        int passed = 0;
        for (const GhostPath& path : some_ghosts(static_cast<int>(lens.surfaces.size()))) {
            for (const Ray<double>& ray : rays_into(lens, 30, 1)) {
                const StrayMirrors<double> mirrors{.sensor = 0.1, .blades = 0.05};
                const TracedRay<double> out = trace_ghost(lens, path, ray, mirrors);
                if (out.status != RayStatus::ok || !(out.ray.direction.z > 0.1)) {
                    continue;
                }
                ++passed;
                const Ray<double> returning{out.ray.origin + 3.0 * out.ray.direction, -1.0 * out.ray.direction};
                const GhostPath reversed(path.rbegin(), path.rend());
                const TracedRay<double> back = trace_ghost<Direction::reverse>(lens, reversed, returning, mirrors);
                ASSERT_EQ(back.status, RayStatus::ok);
                EXPECT_NEAR(length(back.ray.direction + ray.direction), 0.0, 1e-10);
                EXPECT_NEAR(length(cross(back.ray.direction, ray.origin - back.ray.origin)), 0.0, 1e-8);
                EXPECT_NEAR(back.optical_path + length(back.ray.origin - ray.origin), out.optical_path + 3.0, 1e-9);
                EXPECT_NEAR(back.transmittance, out.transmittance, 1e-10 * out.transmittance);
            }
        }
        EXPECT_GT(passed, 100) << name;
    }
}

// Double against long double: each of the same lens and ray. What a rounding at the front becomes on the last surface
// is measured by a ray that starts 1e-9 mm beside; 1000 ulps of the lens's size may be carried that far.
TEST(GhostPath, DoubleIsLongDoubleToItsRounding) {
    const Lens lens = formats::load_lens("tessar");
    const TraceLens<double> narrow = at_wavelength<double>(lens, 550.0);
    const TraceLens<long double> wide = convert_lens<long double>(narrow);
    int compared = 0;
    for (const GhostPath& path : some_ghosts(static_cast<int>(lens.surfaces.size()))) {
        for (const Ray<double>& ray : rays_into(narrow, 30, 2)) {
            constexpr double kBeside = 1e-9;
            const TracedRay<double> a = trace_ghost(narrow, path, ray);
            const TracedRay<long double> b = trace_ghost(wide, path, convert_ray<long double>(ray));
            const TracedRay<double> beside =
                trace_ghost(narrow, path, Ray<double>{ray.origin + Vec3d{kBeside, kBeside, 0.0}, ray.direction});
            if (a.status != RayStatus::ok || b.status != RayStatus::ok || beside.status != RayStatus::ok) {
                continue;
            }
            ++compared;
            const double grows = 1.0 + length(beside.ray.origin - a.ray.origin) / kBeside;
            const double error = length(convert_vector<double>(b.ray.origin) - a.ray.origin);
            EXPECT_LT(error, 1000 * kUlp * 100.0 * grows);
        }
    }
    EXPECT_GT(compared, 100);
}

// Beyond the critical angle a surface that should pass a ray ends it, and one that should reflect it reflects all.
TEST(GhostPath, TotalReflectionEndsWhatShouldPassAndReflectsTheRestWhole) {
    // Into glass through a flat along the normal, out at a flat that is tilted by 50°: beyond 41.8° for n = 1.5.
    const double tilt = 50.0 * std::numbers::pi / 180.0;
    TraceLens<double> prism = build({{0, 0, 1.5}, {0, 20.0, 1.0}});
    prism.surfaces[1].special = 0;
    prism.specials.push_back({});
    prism.specials[0].axes = {
        {{1.0, 0.0, 0.0}, {0.0, std::cos(tilt), -std::sin(tilt)}, {0.0, std::sin(tilt), std::cos(tilt)}}};
    const Ray<double> ray{{0.0, 0.0, -1.0}, {0.0, 0.0, 1.0}};
    EXPECT_EQ(trace_ghost(prism, {}, ray).status, RayStatus::total_internal_reflection);
    std::vector<SurfaceEvent<double>> events;
    trace_ghost(prism, {1, 0}, ray, {}, [&](const SurfaceEvent<double>& event) { events.push_back(event); });
    ASSERT_GE(events.size(), 2U);
    const double t = 4.0 * 1.5 / (2.5 * 2.5);
    EXPECT_NEAR(events[1].transmittance, t, 1e-15);  // all of it reflected
    EXPECT_NEAR(events[1].ray.direction.y, -std::sin(2.0 * tilt), 1e-15);
    EXPECT_NEAR(events[1].ray.direction.z, -std::cos(2.0 * tilt), 1e-15);
}

// The sensor is a mirror in its plane, the stop's blades one around its opening.
TEST(GhostPath, SensorAndBladesReflectAsStated) {
    const TraceLens<double> lens = build({{0, 0, 1.5}, {0, 2.0, 1.0}, {0, 5.0, 1.0, 3.0, true}}, 20.0);
    const StrayMirrors<double> mirrors{.sensor = 0.25, .blades = 0.5};
    const auto down = [](double height) { return Ray<double>{{0.0, height, -1.0}, {0.0, 0.0, 1.0}}; };
    const double r = 0.04;
    const double t = 0.96;
    // Sensor, then the plate's rear; then the stop is passed three times, so a rim clips a ray outside it at once.
    const TracedRay<double> by_sensor = trace_ghost(lens, {3, 1}, down(2.0), mirrors);
    EXPECT_EQ(by_sensor.status, RayStatus::ok);
    EXPECT_NEAR(by_sensor.transmittance, t * t * 0.25 * r, 1e-15);
    EXPECT_NEAR(by_sensor.optical_path, 1.0 + 3.0 + 3.0 + 15.0 + 18.0 + 3.0, 1e-14 * 43.0);
    EXPECT_EQ(trace_ghost(lens, {3, 1}, down(4.0), mirrors).status, RayStatus::stopped);
    // Blades: only outside the opening, and what they send back has to come in through it again.
    EXPECT_EQ(trace_ghost(lens, {2, 1}, down(2.0), mirrors).status, RayStatus::missed);
    double reflected = 0.0;
    const TracedRay<double> by_blades =
        trace_ghost(lens, {2, 1}, down(4.0), mirrors, [&](const SurfaceEvent<double>& event) {
            reflected = event.surface == 2 && event.ray.direction.z < 0.0 ? event.transmittance : reflected;
        });
    EXPECT_NEAR(reflected, t * t * 0.5, 1e-15);
    EXPECT_EQ(by_blades.status, RayStatus::stopped);
    EXPECT_EQ(
        trace_ghost(lens, {3, 2}, Ray<double>{{0.0, 2.0, -1.0}, normalized(Vec3d{0.0, 0.1, 1.0})}, mirrors).status,
        RayStatus::ok);  // 2.5 mm high there, 4.1 mm on its way back: the rear of the blades
}

// Rims clip at every passage, also where the ray passed the first time; followed, it names the first.
TEST(GhostPath, RimsClipAtEveryPassage) {
    // Past a small rim at an angle, back from a flat: outside the rim by then.
    const TraceLens<double> lens = build({{0, 0, 1.5}, {0, 2.0, 1.0, 1.0}, {0, 12.0, 1.5}, {0, 14.0, 1.0}});
    const Ray<double> ray{{0.0, 0.0, -1.0}, normalized(Vec3d{0.0, 0.2, 1.0})};
    EXPECT_EQ(trace(lens, ray).status, RayStatus::ok);
    const TracedRay<double> clipped = trace_ghost(lens, {2, 0}, ray);
    EXPECT_EQ(clipped.status, RayStatus::clipped);
    EXPECT_EQ(clipped.surface, 1);
    const TracedRay<double> followed = trace_ghost<Direction::forward, Rims::follow>(lens, {2, 0}, ray);
    EXPECT_EQ(followed.status, RayStatus::clipped);
    EXPECT_EQ(followed.surface, 1);
    EXPECT_GT(followed.ray.origin.z, 13.9);
}

// Rays along ghosts of six lenses by Optiland's multi-sequence tracing, which make_ghost_rays.py recorded: all within
// 1e-9 mm on the image plane.
TEST(GhostPath, AgreesWithOptiland) {
    const auto recorded = nlohmann::json::parse(read_file(reference_numbers_folder() / "ghost_rays.json"));
    int compared = 0;
    double worst = 0.0;
    for (const auto& from : recorded["lenses"]) {
        const std::string name = from["lens"];
        const TraceLens<double> lens = at_wavelength<double>(formats::load_lens(name), recorded["wavelength_nm"]);
        for (const auto& ghost : from["ghosts"]) {
            const GhostPath path{ghost["surfaces"][0].get<int>() - 1, ghost["surfaces"][1].get<int>() - 1};
            for (const auto& entry : ghost["rays"]) {
                const std::vector<double> ray = entry["ray"];
                const TracedRay<double> out =
                    trace_ghost(lens, path, {{ray[0], ray[1], ray[2]}, normalized(Vec3d{ray[3], ray[4], ray[5]})});
                ASSERT_EQ(out.status, RayStatus::ok) << name;
                const Vec3d image = meet_plane(out.ray, lens.image_z).point;
                const double distance = std::hypot(image.x - entry["image_mm"][0].get<double>(),
                                                   image.y - entry["image_mm"][1].get<double>());
                EXPECT_LT(distance, 1e-9) << name;
                worst = std::max(worst, distance);
                ++compared;
            }
        }
    }
    EXPECT_EQ(compared, 207);
    RecordProperty("largest_distance_mm", std::to_string(worst));
}

TEST(GhostPath, OnlyEvenCountsInTheOrderOfTheLight) {
    for (const GhostPath& path : {GhostPath{1, 0}, {7, 3}, {8, 0}, {4, 2, 3, 0}, {4, 2, 8, 7}}) {
        EXPECT_EQ(path_fault(path, 8), "");
    }
    for (const GhostPath& path :
         {GhostPath{}, {1}, {0, 1}, {3, 3}, {9, 1}, {1, -1}, {4, 2, 2, 1}, {4, 2, 1, 0}, {4, 2, 3, 3}, {4, 2, 5}}) {
        EXPECT_NE(path_fault(path, 8), "");
    }
}

}  // namespace lensproof::optics::ghost_path_test
