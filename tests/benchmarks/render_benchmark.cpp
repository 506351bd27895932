#include <benchmark/benchmark.h>

#include "engine/render/camera.h"
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

Camera camera_for(const Setting& setting) {
    constexpr int kWidth = 32;
    constexpr int kHeight = 24;
    return {.lens = setting.lens,
            .f_number = 8.0,
            .focus_distance_mm = setting.focus_distance_mm,
            .sensor = {kWidth, kHeight, setting.half_diagonal_mm / 20.0},  // half of hypot(32, 24) is 20
            .exposure = {.time_s = 0.01, .iso = 100.0},
            .response = "camera"};
}

void time_render(benchmark::State& state, const Setting& setting, const Chart& chart) {
    constexpr int kSamples = 64;
    const ChartCamera camera(camera_for(setting), Light{}, SpectralSampling{});
    const Placement placement{.distance_mm = setting.focus_distance_mm};
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(camera.render(chart, placement, {.samples_per_pixel = kSamples, .threads = 1}));
    }
    const Sensor& sensor = camera.sensor();
    state.counters["paths/s"] = benchmark::Counter(
        static_cast<double>(state.iterations()) * sensor.width * sensor.height * kSamples, benchmark::Counter::kIsRate);
}

void time_pupil_map(benchmark::State& state, const Setting& setting) {
    const TraceLens<double> lens = at_wavelength<double>(camera_lens(camera_for(setting)), 550.0);
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(PupilMap({lens}, true, setting.half_diagonal_mm));
    }
}

}  // namespace

void register_render_benchmarks() {
    for (const Setting& setting : settings()) {
        const Chart flat{.pattern = FlatField{}};
        const Chart board{.pattern = Checkerboard{12, 9, setting.square_mm}};
        const Chart discs{.pattern = DiscGrid{12, 9, setting.square_mm, 0.5 * setting.square_mm}};
        for (const Chart& chart : {flat, board, discs}) {
            benchmark::RegisterBenchmark(
                ("render/" + setting.lens + "/" + kind_name(chart)).c_str(),
                [&setting, chart](benchmark::State& state) { time_render(state, setting, chart); })
                ->Unit(benchmark::kMillisecond);
        }
        benchmark::RegisterBenchmark(("pupil_map/" + setting.lens).c_str(), [&setting](benchmark::State& state) {
            time_pupil_map(state, setting);
        })->Unit(benchmark::kMillisecond);
    }
}

}  // namespace lensproof
