#include <benchmark/benchmark.h>

#include "engine/render/integrators/passes.h"
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

/// Under a sky of radiance 1.
scene::Scene lit_evenly(const spectral::SpectralGrid& grid) {
    SceneParts parts = wall_and_sphere(grid);
    parts.lights.emplace_back(scene::ConstantLight{spectral::constant_spectrum(1.0, grid)});
    return parts.scene();
}

/// Under a map as panoramas come: 4096 × 2048 pixels of many colours, bright and dark.
scene::Scene lit_by_map(const spectral::SpectralGrid& grid) {
    constexpr int kMapHeight = 2048;
    scene::ImageTexture picture{.grid = {2 * kMapHeight, kMapHeight, scene::Wrap::repeat, scene::Wrap::clamp},
                                .texel = {},
                                .abscissa = spectral::tabulated(grid, spectral::sigmoid_abscissa),
                                .white = spectral::constant_spectrum(1.0, grid)};
    picture.texel.reserve(std::size_t{2} * kMapHeight * kMapHeight);
    scene::Uniform uniform(1);
    for (int i = 0; i < 2 * kMapHeight * kMapHeight; ++i) {
        const auto number = [&] { return static_cast<float>(4.0 * uniform() - 2.0); };
        picture.texel.push_back(
            {.shape = {.coefficient = {number(), number(), number()}}, .scale = static_cast<float>(4.0 * uniform())});
    }
    SceneParts parts = wall_and_sphere(grid);
    parts.lights.emplace_back(scene::EnvironmentLight{
        std::make_shared<const scene::Environment>(std::move(picture), Vec3d{0.0, -1.0, 0.0}, 0.0)});
    return parts.scene();
}

using MakeScene = scene::Scene (*)(const spectral::SpectralGrid&);

void time_camera_paths(benchmark::State& state, render::LensModel model, MakeScene make_scene) {
    const render::Camera camera({.lens = "double-gauss-tronnier",
                                 .f_number = 2.0,
                                 .focus_distance_mm = 2000.0,
                                 .sensor = kSensor,
                                 .response = "cie-1931",
                                 .model = model},
                                {.layers = 8, .strata_per_layer = 8}, {}, {});
    const render::World world = make_scene(camera.grid());
    const render::Render render =
        render::pass_named("camera").render({.world = &world, .camera = &camera, .paths = kPaths});
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
    for (const render::LensModel model : {exact, paraxial, thin_lens, pinhole}) {
        benchmark::RegisterBenchmark(("scene/" + render::name_of(model)).c_str(), [model](benchmark::State& state) {
            time_camera_paths(state, model, lit_by_lamp);
        })->Unit(benchmark::kMillisecond);
    }
    benchmark::RegisterBenchmark("scene/sky/even", time_camera_paths, exact, lit_evenly)->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark("scene/sky/map", time_camera_paths, exact, lit_by_map)->Unit(benchmark::kMillisecond);
}

}  // namespace lensproof
