#include <benchmark/benchmark.h>

#include <array>
#include <vector>

#include "engine/pupil/pupil_map.h"
#include "engine/render/integrators/chart_tracer.h"
#include "engine/render/integrators/integrators.h"
#include "engine/render/progressive.h"
#include "engine/render/sampling/sampler.h"
#include "tests/benchmarks/benchmarks.h"

namespace lensproof {

namespace {

struct Setting {
    std::string lens;
    double focus_distance_mm;
    double half_diagonal_mm;  // of the sensor
    double square_mm;         // of a checkerboard of 12 × 9 that fills the frame at the focus distance
};

const std::vector<Setting>& settings() {
    static const std::vector<Setting> all = {{"tessar", 10000.0, 45.0, 560.0},
                                             {"petzval", 10000.0, 22.5, 280.0},
                                             {"muller-fisheye", 50000.0, 12.75, 6000.0}};
    return all;
}

render::CameraSettings camera_for(const Setting& setting) {
    constexpr int kWidth = 32;
    constexpr int kHeight = 24;
    return {.lens = setting.lens,
            .f_number = 8.0,
            .focus_distance_mm = setting.focus_distance_mm,
            .sensor = {kWidth, kHeight, setting.half_diagonal_mm / 20.0},  // half of hypot(32, 24) is 20
            .exposure = {.time_s = 0.01, .iso = 100.0},
            .response = "camera"};
}

void time_render(benchmark::State& state, const Setting& setting, const scene::Chart& chart) {
    constexpr int kSamples = 64;
    const render::Camera camera(camera_for(setting), {}, {}, {});
    const render::World world = render::even_chart(chart, {.distance_mm = setting.focus_distance_mm}, 1000.0, camera);
    const render::View view{.world = &world, .camera = &camera};
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(
            render::render_film(render::integrator_named("chart").render(view), {.first = 0, .end = kSamples}, 1));
    }
    const render::Sensor& sensor = camera.sensor();
    state.counters["paths/s"] = benchmark::Counter(
        static_cast<double>(state.iterations()) * sensor.width * sensor.height * kSamples, benchmark::Counter::kIsRate);
}

/// The lens at 64 wavelengths, as a render has it.
std::vector<optics::TraceLens<double>> band_of(const Setting& setting) {
    const optics::Lens lens = render::camera_lens(camera_for(setting));
    std::vector<optics::TraceLens<double>> band;
    band.reserve(64);
    for (int i = 0; i < 64; ++i) {
        band.push_back(optics::at_wavelength<double>(lens, 400.0 + 300.0 * (i + 0.5) / 64));
    }
    return band;
}

void time_pupil_samples(benchmark::State& state, const Setting& setting) {
    constexpr std::uint32_t kPoints = 4096;
    const pupil::PupilMap map(band_of(setting), true, setting.half_diagonal_mm);
    std::vector<std::array<double, 5>> points;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
        points.push_back(render::PixelSampler(1, 0).point(i));
    }
    std::size_t i = 0;
    while (state.KeepRunning()) {
        const std::array<double, 5>& xi = points[i++ % kPoints];
        const Vec2d at{0.6 * setting.half_diagonal_mm * xi[0], 0.6 * setting.half_diagonal_mm * xi[1]};
        benchmark::DoNotOptimize(map.sample(at, xi[4], xi[2], xi[3]));
    }
}

}  // namespace

void register_render_benchmarks() {
    for (const Setting& setting : settings()) {
        const scene::Chart flat{.pattern = scene::FlatField{}};
        const scene::Chart board{.pattern = scene::Checkerboard{12, 9, setting.square_mm}};
        const scene::Chart discs{.pattern = scene::DiscGrid{12, 9, setting.square_mm, 0.5 * setting.square_mm}};
        for (const scene::Chart& chart : {flat, board, discs}) {
            benchmark::RegisterBenchmark(
                ("render/" + setting.lens + "/" + scene::kind_name(chart)).c_str(),
                [&setting, chart](benchmark::State& state) { time_render(state, setting, chart); })
                ->Unit(benchmark::kMillisecond);
        }
        benchmark::RegisterBenchmark(("pupil_sample/" + setting.lens).c_str(),
                                     [&setting](benchmark::State& state) { time_pupil_samples(state, setting); });
    }
}

}  // namespace lensproof
