#include <benchmark/benchmark.h>

#include <cmath>

#include "engine/render/integrators/integrators.h"
#include "engine/render/progressive.h"
#include "tests/benchmarks/benchmarks.h"
#include "tests/engine/scene/bsdf/bsdf_cases.h"
#include "tests/validation/small_scene.h"

namespace lensproof {

namespace {

constexpr int kWidth = 150;  // a sixteenth of 600 × 400
constexpr int kHeight = 100;
constexpr render::Sensor kSensor{.width = kWidth, .height = kHeight, .pixel_pitch_mm = 36.0 / kWidth};
constexpr render::PathSettings kPaths{.max_bounces = 5};

/// A checkered wall and a sphere before it.
SceneParts wall_and_sphere(const spectral::SpectralGrid& grid) {
    const scene::Chart checks{.pattern = scene::Checkerboard{.columns = 40, .rows = 40, .square_mm = 100.0},
                              .white_reflectance = 0.9,
                              .black_reflectance = 0.04};
    SceneParts parts(grid);
    parts.add(scene::Quad{4000.0, 4000.0}, {.linear = about_x(180.0), .translation = {0.0, 0.0, 2000.0}},
              {scene::DiffuseMaterial{scene::chart_texture(checks, 4000.0, 4000.0, grid)}});
    parts.add(scene::Sphere{200.0}, {.linear = kIdentity3, .translation = {150.0, 0.0, 1700.0}}, 0.5);
    return parts;
}

scene::Scene lit_by_lamp(const spectral::SpectralGrid& grid) {
    SceneParts parts = wall_and_sphere(grid);
    const std::uint32_t lamp =
        parts.add(scene::Quad{500.0, 500.0}, {.linear = about_x(90.0), .translation = {0.0, 800.0, 1500.0}}, 0.5);
    parts.lights.emplace_back(scene::AreaLight{.object = lamp, .radiance = spectral::constant_spectrum(20.0, grid)});
    return parts.scene();
}

/// A still life in the open: four spheres, of plastic, frosted glass, clear glass and rough gold, on a checkered floor.
SceneParts still_life(const spectral::SpectralGrid& grid) {
    const scene::Chart checks{.pattern = scene::Checkerboard{.columns = 40, .rows = 40, .square_mm = 100.0},
                              .white_reflectance = 0.8,
                              .black_reflectance = 0.1};
    SceneParts parts(grid);
    parts.add(scene::Quad{8000.0, 8000.0}, {.linear = about_x(90.0), .translation = {0.0, 200.0, 2000.0}},
              {scene::DiffuseMaterial{scene::chart_texture(checks, 8000.0, 8000.0, grid)}});
    const auto glass = [&](double alpha) {
        return scene::dielectric_material(spectral::constant_spectrum(1.5, grid), {alpha, alpha});
    };
    const scene::Material materials[] = {
        {scene::plastic_material(spectral::constant_spectrum(0.5, grid), 1.5, 0.1)},
        {glass(0.2)},
        {glass(0.0)},
        {scene::conductor_material(spectral::constant_spectrum(0.3, grid), spectral::constant_spectrum(3.0, grid),
                                   {0.2, 0.2})}};
    double x = -450.0;
    for (const scene::Material& material : materials) {
        parts.add(scene::Sphere{150.0}, {.linear = kIdentity3, .translation = {x, 50.0, 2000.0}}, material);
        x += 300.0;
    }
    return parts;
}

constexpr int kMapHeight = 2048;
constexpr int kMapWidth = 2 * kMapHeight;

/// A map twice as wide as high as light, the top row's direction up in the picture.
template <class TexelAt>
scene::LightSource map_of(const spectral::SpectralGrid& grid, int height, const TexelAt& texel_at) {
    scene::ImageTexture picture{.grid = {2 * height, height, scene::Wrap::repeat, scene::Wrap::clamp},
                                .texel = {},
                                .abscissa = spectral::tabulated(grid, spectral::sigmoid_abscissa),
                                .white = spectral::constant_spectrum(1.0, grid)};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < 2 * height; ++x) {
            picture.texel.push_back(texel_at(x, y));
        }
    }
    return scene::EnvironmentLight{
        std::make_shared<const scene::Environment>(std::move(picture), Vec3d{0.0, -1.0, 0.0}, 0.0)};
}

/// Of radiance 1.
scene::LightSource even_sky(const spectral::SpectralGrid& grid) {
    return scene::ConstantLight{spectral::constant_spectrum(1.0, grid)};
}

/// The hardest: every pixel another colour and brightness, so that no look-up is near the one before. Of 64 rows it
/// stays in the caches: what is then left is arithmetic.
template <int height = kMapHeight>
scene::LightSource noise(const spectral::SpectralGrid& grid) {
    scene::Uniform uniform(1);
    const auto number = [&] { return static_cast<float>(4.0 * uniform() - 2.0); };
    return map_of(grid, height, [&](int, int) {
        return scene::ImageTexture::Texel{.shape = {.coefficient = {number(), number(), number()}},
                                          .scale = static_cast<float>(4.0 * uniform())};
    });
}

/// As panoramas are: a sky that brightens towards the horizon, some grain, a dim ground, and a sun of half a degree
/// that gives as much light as all the rest.
scene::LightSource panorama(const spectral::SpectralGrid& grid) {
    scene::Uniform uniform(1);
    constexpr double kSunRadius = kMapHeight * 0.265 / 180.0;
    return map_of(grid, kMapHeight, [&](int x, int y) {
        const double down = (y + 0.5) / kMapHeight;
        const bool is_sun = std::hypot(x - 0.6 * kMapWidth, y - 0.25 * kMapHeight) < kSunRadius;
        const double radiance = is_sun ? 1e5 : down < 0.5 ? 0.5 + down : 0.3;
        const auto blue = static_cast<float>(down < 0.5 ? -1.0 + down : 0.3);
        return scene::ImageTexture::Texel{.shape = {.coefficient = {0.1F, blue, 0.2F}},
                                          .scale = static_cast<float>(radiance * (0.9 + 0.2 * uniform()))};
    });
}

template <SceneParts (&parts_of)(const spectral::SpectralGrid&),
          scene::LightSource (&sky_of)(const spectral::SpectralGrid&)>
scene::Scene under(const spectral::SpectralGrid& grid) {
    SceneParts parts = parts_of(grid);
    parts.lights.push_back(sky_of(grid));
    return parts.scene();
}

using MakeScene = scene::Scene (*)(const spectral::SpectralGrid&);

void time_paths(benchmark::State& state, const std::string& integrator, render::LensModel model, MakeScene make_scene) {
    const bool meets_light_paths = integrator != "camera";
    const render::Camera camera({.lens = "double-gauss-tronnier",
                                 .f_number = 2.0,
                                 .focus_distance_mm = 2000.0,
                                 .sensor = kSensor,
                                 .response = "cie-1931",
                                 .model = model},
                                {.layers = 8, .strata_per_layer = 8}, {}, {}, meets_light_paths);
    const render::World world = make_scene(camera.grid());
    const render::Render render =
        render::integrator_named(integrator).render({.world = &world, .camera = &camera, .paths = kPaths});
    render::Film film(render.film);
    render::FilmTile tile(film.layout());
    const auto tiles = render::film_tiles(kWidth, kHeight);
    std::uint32_t sample = 0;
    constexpr std::uint32_t kSamples = 16;
    std::uint64_t rays = 0;
    for (auto _ : state) {
        for (const render::PixelRect& rect : tiles) {
            const render::TileSamples samples{rect, sample, sample + kSamples};
            film.load(samples, tile);
            render.renderer(samples, tile);
            tile.finish();
            film.store(tile);
            rays += tile.rays();
        }
        sample += kSamples;
    }
    const auto paths = static_cast<double>(state.iterations()) * kWidth * kHeight * kSamples;
    state.counters["paths"] = benchmark::Counter(paths, benchmark::Counter::kIsRate);
    state.counters["rays_a_path"] = static_cast<double>(rays) / paths;
}

}  // namespace

void register_scene_benchmarks() {
    using enum render::LensModel;
    for (const render::LensModel model :
         {exact, exact_float, polynomial, paraxial, thin_lens_profile, thin_lens, pinhole_profile, pinhole}) {
        benchmark::RegisterBenchmark(("scene/" + render::name_of(model)).c_str(), [model](benchmark::State& state) {
            time_paths(state, "camera", model, lit_by_lamp);
        })->Unit(benchmark::kMillisecond);
    }
    const auto add = [](const char* name, MakeScene make_scene) {
        benchmark::RegisterBenchmark(name, time_paths, "camera", exact, make_scene)->Unit(benchmark::kMillisecond);
    };
    for (const std::string integrator : {"light", "both"}) {
        benchmark::RegisterBenchmark(("scene/" + integrator).c_str(), time_paths, integrator, exact, lit_by_lamp)
            ->Unit(benchmark::kMillisecond);
    }
    add("scene/sky/even", under<wall_and_sphere, even_sky>);
    add("scene/sky/noise", under<wall_and_sphere, noise<>>);
    add("scene/sky/small_noise", under<wall_and_sphere, noise<64>>);
    add("scene/sky/panorama", under<wall_and_sphere, panorama>);
    add("scene/still_life/even", under<still_life, even_sky>);
    add("scene/still_life/noise", under<still_life, noise<>>);
    add("scene/still_life/small_noise", under<still_life, noise<64>>);
    add("scene/still_life/panorama", under<still_life, panorama>);
}

}  // namespace lensproof
