// Radiance by path tracing against closed forms: what a surface gets from lights of known shape, and furnaces.
#include "engine/render/integrators/path_tracer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/base/angle.h"
#include "tests/validation/measured.h"
#include "tests/validation/small_scene.h"

namespace lensproof::path_tracer_test {

const spectral::SpectralGrid kGrid = spectral::spectral_grid(400.0, 700.0, 8);

AffineMap at(double x, double y, double z) {
    return {.linear = kIdentity3, .translation = {x, y, z}};
}

/// The mean over many paths along one ray, all wavelengths.
Measured radiance(const scene::Scene& scene, const Ray<double>& ray, int paths,
                  const render::PathSettings& settings = {}) {
    std::vector<double> values;
    for (int i = 0; i < paths; ++i) {
        render::PathSampler numbers(7, 0, static_cast<std::uint32_t>(i));
        values.push_back(
            spectral::mean(render::trace_path(scene, ray, kGrid.path(i % kGrid.size()), settings, numbers).radiance));
    }
    return mean_of(values);
}

/// Four standard errors as if samples were independent, which stratified ones stay well within; and float's rounding.
void expect_estimate(const Measured& found, double expected) {
    EXPECT_NEAR(found.value, expected, 4.0 * found.error + 1e-6 * expected);
    EXPECT_LT(found.error, 0.01 * expected);
}

const Ray<double> kDownwards{{0.0, 0.0, 50.0}, {0.0, 0.0, -1.0}};

// A sphere of radiance L seen from a point of a plane under it gives the irradiance π L (R/d)² (Lambert; the sphere's
// projected solid angle is that of its disc). A Lambertian plane then has the radiance ρ L (R/d)².
TEST(PathTracer, SphereLightLightsAPlaneAsItsDiscDoes) {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{1000.0, 1000.0}, {}, 0.5);
    const std::uint32_t sphere = parts.add(scene::Sphere{30.0}, at(0.0, 0.0, 200.0), 0.0);
    parts.lights.emplace_back(scene::AreaLight{.object = sphere, .radiance = spectral::constant_spectrum(10.0, kGrid)});
    const scene::Scene scene = parts.scene();
    expect_estimate(radiance(scene, kDownwards, 4096), 0.5 * 10.0 * std::pow(30.0 / 200.0, 2));
    // The same on a sphere that is none to the last digits, which is sampled by its area.
    parts.objects.back().to_world.linear[2].z = 1.0 + 1e-9;
    expect_estimate(radiance(parts.scene(), kDownwards, 65536), 0.5 * 10.0 * std::pow(30.0 / 200.0, 2));
}

// Of two directly opposed discs' kin, parallel squares: a point under the middle of a square light of side 2a at height
// h gets E = π L F with F = 4/π · X/√(1+X²) · atan(X/√(1+X²)), X = a/h (Howell, A Catalog of Radiation Heat Transfer
// Configuration Factors, B-3, four times the corner's).
TEST(PathTracer, QuadLightHasItsConfigurationFactor) {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{1000.0, 1000.0}, {}, 0.8);
    AffineMap facing_down = at(0.0, 0.0, 100.0);
    facing_down.linear = about_x(180.0);
    const std::uint32_t quad = parts.add(scene::Quad{120.0, 120.0}, facing_down, 0.0);
    parts.lights.emplace_back(scene::AreaLight{.object = quad, .radiance = spectral::constant_spectrum(3.0, kGrid)});
    const scene::Scene scene = parts.scene();
    const double x = 60.0 / 100.0;
    const double side = x / std::sqrt(1.0 + x * x);
    const double factor = 4.0 / (2.0 * kPi) * 2.0 * side * std::atan(side);
    expect_estimate(radiance(scene, kDownwards, 4096), 0.8 * 3.0 * factor);
}

// A point's irradiance is I cos θ / d², a spot's within its full cone the same, and the sun's L Ω cos θ.
TEST(PathTracer, PointSpotAndSunKeepTheirLaws) {
    const double height_m = 0.3;
    const auto lit_by = [](const scene::LightSource& light) {
        SceneParts parts(kGrid);
        parts.add(scene::Quad{1000.0, 1000.0}, {}, 0.5);
        parts.lights.push_back(light);
        return radiance(parts.scene(), kDownwards, 256).value;
    };
    const Vec3d above{400.0, 0.0, 300.0};  // so that cos θ = 3/5 and d = 0.5 m
    const double of_point = 0.5 / kPi * 2.0 * (height_m / 0.5) / (0.5 * 0.5);
    EXPECT_NEAR(lit_by(scene::PointLight{above, spectral::constant_spectrum(2.0, kGrid)}), of_point, 1e-6 * of_point);
    EXPECT_NEAR(
        lit_by(scene::SpotLight{above, normalized(-1.0 * above), 0.99, 0.9, spectral::constant_spectrum(2.0, kGrid)}),
        of_point, 1e-6 * of_point);
    EXPECT_EQ(lit_by(scene::SpotLight{above, {1.0, 0.0, 0.0}, 0.99, 0.9, spectral::constant_spectrum(2.0, kGrid)}),
              0.0);
    // The mean cosine over a disc of 0.265° differs from its centre's by less than its radius squared.
    const double cos_radius = std::cos(radians(0.265));
    const double of_sun = 0.5 / kPi * 1e4 * 2.0 * kPi * (1.0 - cos_radius) * 0.6;
    EXPECT_NEAR(lit_by(scene::SunLight{normalized(above), cos_radius, spectral::constant_spectrum(1e4, kGrid)}), of_sun,
                3e-5 * of_sun);
}

// In a closed room of albedo ρ whose walls radiate 1, the radiance after n bounces is 1 + ρ + … + ρⁿ everywhere.
TEST(PathTracer, GlowingRoomSumsItsBounces) {
    SceneParts parts(kGrid);
    const std::uint32_t walls = parts.add(scene::Sphere{100.0}, {}, 0.6);
    parts.lights.emplace_back(
        scene::AreaLight{.object = walls, .radiance = spectral::constant_spectrum(1.0, kGrid), .is_two_sided = true});
    const scene::Scene scene = parts.scene();
    double expected = 0.0;
    double power = 1.0;
    for (const int bounces : {0, 1, 2, 3}) {
        expected += power;
        power *= 0.6;
        const Measured found =
            radiance(scene, {{10.0, 20.0, 30.0}, normalized(Vec3d{1.0, 2.0, -0.5})}, 4096, {.max_bounces = bounces});
        EXPECT_NEAR(found.value, expected, 4.0 * found.error + 1e-5) << bounces;
    }
    // Roulette ends paths early and makes up for it.
    const Measured all =
        radiance(scene, {{10.0, 20.0, 30.0}, {0.0, 0.0, 1.0}}, 16384, {.max_bounces = 200, .roulette_from = 1});
    expect_estimate(all, 1.0 / (1.0 - 0.6));
}

// White surfaces of any shape vanish in an even sky: every path carries its radiance out again.
TEST(PathTracer, WhiteVanishesInAnEvenSky) {
    SceneParts parts(kGrid);
    parts.add(scene::Sphere{30.0}, at(0.0, 0.0, 0.0), 1.0);
    parts.add(scene::Sphere{20.0}, at(40.0, 0.0, 10.0), 1.0);
    parts.add(scene::Quad{400.0, 400.0}, at(0.0, 0.0, -30.0), 1.0);
    parts.lights.emplace_back(scene::ConstantLight{spectral::constant_spectrum(5.0, kGrid)});
    const scene::Scene scene = parts.scene();
    for (const double x : {0.0, 15.0, 25.0, 35.0}) {
        const Measured found = radiance(scene, {{x, 3.0, 200.0}, {0.0, 0.0, -1.0}}, 4096, {.max_bounces = 500});
        EXPECT_NEAR(found.value, 5.0, 4.0 * found.error + 5e-5) << x;
    }
}

// An empty scene has no size, so that its sky sends no power into it, and is seen all the same.
TEST(PathTracer, SkyIsSeenBesideALampInAnEmptyScene) {
    SceneParts parts(kGrid);
    parts.lights.emplace_back(scene::ConstantLight{spectral::constant_spectrum(5.0, kGrid)});
    parts.lights.emplace_back(scene::PointLight{{0.0, 0.0, 0.0}, spectral::constant_spectrum(1.0, kGrid)});
    EXPECT_EQ(radiance(parts.scene(), kDownwards, 16).value, 5.0);
}

// --- Dispersion ---

/// The deviation of a ray that meets the first face of a prism straight on: it leaves the second at the angle of
/// Snell's law, having met it at the apex angle.
double prism_exit_angle(double index, double apex) {
    return std::asin(index * std::sin(apex)) - apex;
}

// A white beam through a prism of dispersive glass: each wavelength meets a strip of a screen of its own where Snell's
// law says, and no other's. Its radiance is the strip's times what Fresnel's equations let pass of both faces, the
// squeeze of n² at the first being undone at the second. Faces choose at random between mirror and window, so the mean
// of n walks has the error √(T (1 − T) / n).
TEST(PathTracer, PrismSendsEachWavelengthWhereSnellSays) {
    constexpr double kApex = radians(30.0);
    constexpr double kScreen = 1000.0;  // from the prism
    // Cauchy's formula with numbers like those of a dense flint.
    const auto index_at = [](double nm) { return 1.70 + 13000.0 / (nm * nm); };
    SceneParts parts(kGrid);
    spectral::GridSpectrum eta;
    for (const double nm : kGrid.strata.midpoints()) {
        eta.value.push_back(static_cast<float>(index_at(nm)));
    }
    const scene::Material glass{scene::DielectricMaterial{.eta = eta, .roughness = {}}};
    // Light comes down along −z: the first face looks up, the second down, turned by the apex about y.
    parts.add(scene::Quad{20.0, 20.0}, at(0.0, 0.0, 5.0), glass);
    AffineMap second;
    second.linear = product(about_y(30.0), about_x(180.0));
    parts.add(scene::Quad{20.0, 20.0}, second, glass);
    const auto strip_centre = [&](double nm) {
        // The ray along z meets the second face in the origin, and turns towards +x.
        return kScreen * std::tan(prism_exit_angle(index_at(nm), kApex));
    };
    for (int k = 0; k < kGrid.size(); ++k) {
        AffineMap facing_up = at(strip_centre(kGrid.strata.midpoint(k)), 0.0, -kScreen);
        const std::uint32_t strip = parts.add(scene::Quad{0.2, 50.0}, facing_up, 0.0);
        parts.lights.emplace_back(
            scene::AreaLight{.object = strip, .radiance = spectral::constant_spectrum(1.0 + k, kGrid)});
    }
    const scene::Scene scene = parts.scene();
    for (int k = 0; k < kGrid.size(); ++k) {
        const double n = index_at(kGrid.strata.midpoint(k));
        const double exit = prism_exit_angle(n, kApex) + kApex;
        const double first = 4.0 * n / ((n + 1.0) * (n + 1.0));
        const double across = std::sin(exit - kApex) / std::sin(exit + kApex);
        const double along = std::tan(exit - kApex) / std::tan(exit + kApex);
        const double passing = first * (1.0 - 0.5 * (across * across + along * along));
        constexpr int kWalks = 4096;
        double hero = 0.0;
        for (int i = 0; i < kWalks; ++i) {
            render::PathSampler numbers(11, 0, static_cast<std::uint32_t>(i));
            const render::PathRadiance found = render::trace_path(scene, {{0.0, 0.0, 100.0}, {0.0, 0.0, -1.0}},
                                                                  kGrid.path(k), {.max_bounces = 2}, numbers);
            EXPECT_EQ(found.radiance, spectral::SpectralSample());
            hero += found.hero_radiance / kWalks;
        }
        EXPECT_NEAR(hero / (1.0 + k), passing, 4.0 * std::sqrt(passing * (1.0 - passing) / kWalks)) << k;
    }
}

// A path finds the same, to the bit, alone and among others: through glass that parts its wavelengths, mirrored, under
// lamps and sky, with a number of paths that is no whole number of batches or packets.
TEST(PathTracer, PathsFindTogetherWhatEachFindsAlone) {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{1000.0, 1000.0}, {}, 0.5);
    parts.add(scene::Sphere{20.0}, at(0.0, 0.0, 30.0),
              {scene::dielectric_material(
                  spectral::tabulated(kGrid, [](double nm) { return 1.5 + 13000.0 / (nm * nm); }), {0.0, 0.0})});
    parts.add(scene::Sphere{20.0}, at(60.0, 0.0, 30.0),
              {scene::plastic_material(spectral::constant_spectrum(0.5, kGrid), 1.5, 0.1)});
    const std::uint32_t lamp = parts.add(scene::Sphere{10.0}, at(0.0, 80.0, 200.0), 0.0);
    parts.lights.emplace_back(scene::AreaLight{.object = lamp, .radiance = spectral::constant_spectrum(10.0, kGrid)});
    parts.lights.emplace_back(scene::ConstantLight{spectral::constant_spectrum(0.1, kGrid)});
    const scene::Scene scene = parts.scene();
    std::vector<render::PathStart> starts;
    for (std::uint32_t i = 0; i < 301; ++i) {
        starts.push_back({.ray = {{0.3 * i - 40.0, 0.1 * i - 20.0, 100.0}, {0.0, 0.0, -1.0}},
                          .path = kGrid.path(static_cast<int>(i) % kGrid.size()),
                          .numbers = render::PathSampler(3, i, 5),
                          .wants_first = i % 2 == 0});
    }
    std::vector<render::PathRadiance> found(starts.size());
    render::trace_paths(scene, {}, starts, found);
    int by_heroes = 0;
    for (std::size_t i = 0; i < starts.size(); ++i) {
        render::PathSampler numbers = starts[i].numbers;
        const render::PathRadiance expected = render::trace_path(scene, starts[i].ray, starts[i].path, {}, numbers);
        EXPECT_EQ(found[i].radiance, expected.radiance) << i;
        EXPECT_EQ(found[i].hero_radiance, expected.hero_radiance) << i;
        EXPECT_EQ(found[i].rays, expected.rays) << i;
        EXPECT_EQ(found[i].first.has_value(), i % 2 == 0) << i;
        by_heroes += expected.hero_radiance > 0.0F ? 1 : 0;
    }
    EXPECT_GT(by_heroes, 10);
}

}  // namespace lensproof::path_tracer_test
