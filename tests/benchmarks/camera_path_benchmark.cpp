#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <memory>

#include "engine/render/packet/path_kernels.h"
#include "engine/render/sampler.h"
#include "tests/benchmarks/benchmarks.h"

namespace lensproof {

namespace {

constexpr std::uint32_t kSamples = 64;  // of a pixel

void count_points(benchmark::State& state) {
    state.counters["points/s"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * kSamples, benchmark::Counter::kIsRate);
}

void time_points_one_by_one(benchmark::State& state) {
    std::uint32_t pixel = 0;
    while (state.KeepRunning()) {
        const PixelSampler sampler(0, pixel++);
        for (std::uint32_t i = 0; i < kSamples; ++i) {
            benchmark::DoNotOptimize(sampler.point(i));
        }
    }
    count_points(state);
}

/// As camera paths take them: in columns, film positions included.
void time_points_in_columns(benchmark::State& state, SimdLevel level) {
    const PathSampling sampling{
        .sensor = {.width = 64, .height = 48, .pixel_pitch_mm = 0.01}, .seed = 0, .wavelengths = kSamples};
    const auto starts = std::make_unique<PathStarts>();
    PathCursor cursor{.samples = kSamples};
    while (state.KeepRunning()) {
        path_kernels<double>(level).draw(sampling, kSamples, cursor, *starts);
        benchmark::DoNotOptimize(*starts);
    }
    count_points(state);
}

}  // namespace

void register_camera_path_benchmarks() {
    benchmark::RegisterBenchmark("sampler/points/one_by_one", time_points_one_by_one);
    for (const SimdLevel level : available_simd_levels()) {
        benchmark::RegisterBenchmark(fmt::format("sampler/points/{}", simd_name(level)).c_str(),
                                     [level](benchmark::State& state) { time_points_in_columns(state, level); });
    }
}

}  // namespace lensproof
