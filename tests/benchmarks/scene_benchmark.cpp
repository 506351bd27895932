#include <benchmark/benchmark.h>

#include "engine/render/integrators/passes.h"
#include "engine/render/progressive.h"
#include "tests/benchmarks/benchmarks.h"
#include "tests/validation/small_scene.h"

namespace lensproof {

namespace {

constexpr int kWidth = 150;  // a sixteenth of 600 × 400
constexpr int kHeight = 100;
constexpr render::Sensor kSensor{.width = kWidth, .height = kHeight, .pixel_pitch_mm = 36.0 / kWidth};
constexpr render::PathSettings kPaths{.max_bounces = 5};

scene::Scene wall_sphere_and_lamp(const spectral::SpectralGrid& grid) {
    const scene::Chart checks{.pattern = scene::Checkerboard{.columns = 40, .rows = 40, .square_mm = 100.0},
                              .white_reflectance = 0.9,
                              .black_reflectance = 0.04};
    SceneParts parts(grid);
    parts.add(scene::Quad{4000.0, 4000.0}, {.linear = about_x(180.0), .translation = {0.0, 0.0, 2000.0}},
              {scene::DiffuseMaterial{scene::chart_texture(checks, 4000.0, 4000.0, grid)}});
    parts.add(scene::Sphere{200.0}, {.linear = kIdentity3, .translation = {150.0, 0.0, 1700.0}}, 0.5);
    const std::uint32_t lamp =
        parts.add(scene::Quad{500.0, 500.0}, {.linear = about_x(90.0), .translation = {0.0, 800.0, 1500.0}}, 0.5);
    parts.lights.emplace_back(scene::AreaLight{.object = lamp, .radiance = spectral::constant_spectrum(20.0, grid)});
    return parts.scene();
}

void time_camera_paths(benchmark::State& state, render::LensModel model) {
    const render::Camera camera({.lens = "double-gauss-tronnier",
                                 .f_number = 2.0,
                                 .focus_distance_mm = 2000.0,
                                 .sensor = kSensor,
                                 .response = "cie-1931",
                                 .model = model},
                                {.layers = 8, .strata_per_layer = 8}, {}, {});
    const render::World world = wall_sphere_and_lamp(camera.grid());
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
            time_camera_paths(state, model);
        })->Unit(benchmark::kMillisecond);
    }
}

}  // namespace lensproof
