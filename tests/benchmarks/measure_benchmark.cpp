#include <benchmark/benchmark.h>

#include "calibration/detection/refine.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/chief_ray.h"
#include "engine/scene/chart/chart.h"
#include "tests/benchmarks/benchmarks.h"

namespace lensproof {

namespace {

constexpr double kWavelengthNm = 550.0;

void time_chief_ray_construction(benchmark::State& state, const std::string& name) {
    const optics::Lens lens = formats::load_lens(name);
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(optics::ChiefRays(lens, kWavelengthNm));
    }
}

void time_chief_ray_aiming(benchmark::State& state, const std::string& name) {
    const optics::ChiefRays rays(formats::load_lens(name), kWavelengthNm);
    const double field = 0.7 * rays.largest_field();
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(rays.at_field(field));
    }
}

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr double kPixelsPerMm = 1.4;
constexpr double kTurn = 0.03;  // slope, so that edges do not run along pixel rows

Vec2d to_pixel(const Vec2d& mm) {
    return {0.5 * kWidth + kPixelsPerMm * (mm.x - kTurn * mm.y), 0.5 * kHeight + kPixelsPerMm * (mm.y + kTurn * mm.x)};
}

/// The chart seen straight on, slightly turned, with edges a pixel wide (4 × 4 samples a pixel).
formats::Image painted(const scene::Chart& chart) {
    constexpr int kSub = 4;
    const double norm = kPixelsPerMm * (1.0 + kTurn * kTurn);
    formats::Image image = formats::make_image(kWidth, kHeight, {"Y"});
    for (int v = 0; v < kHeight; ++v) {
        for (int u = 0; u < kWidth; ++u) {
            double sum = 0.0;
            for (int row = 0; row < kSub; ++row) {
                for (int column = 0; column < kSub; ++column) {
                    const double x = u + (column + 0.5) / kSub - 0.5 - 0.5 * kWidth;
                    const double y = v + (row + 0.5) / kSub - 0.5 - 0.5 * kHeight;
                    sum += scene::reflectance(chart, (x + kTurn * y) / norm, (y - kTurn * x) / norm);
                }
            }
            image.at(u, v, 0) = static_cast<float>(sum / (kSub * kSub));
        }
    }
    return image;
}

void time_refinement(benchmark::State& state, const scene::Chart& chart) {
    const formats::Image image = painted(chart);
    calibration::ChartPoints approximate;
    for (const Vec2d& point : scene::feature_points(chart)) {
        const Vec2d exact = to_pixel(point);
        approximate.image_px.push_back({exact.x + 0.4, exact.y - 0.3});  // as far off as a detector is
        approximate.found.push_back(true);
    }
    int found = 0;
    while (state.KeepRunning()) {
        found = calibration::count_found(calibration::refine(image, 0, approximate, chart));
        benchmark::DoNotOptimize(found);
    }
    if (found != static_cast<int>(approximate.found.size())) {
        state.SkipWithError("not every point was found");
    }
    state.counters["points/s"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(approximate.found.size()),
                           benchmark::Counter::kIsRate);
}

}  // namespace

void register_measure_benchmarks() {
    for (const std::string lens : {"tessar", "petzval", "muller-fisheye"}) {
        benchmark::RegisterBenchmark(("chief_rays/" + lens + "/construct").c_str(),
                                     [lens](benchmark::State& state) { time_chief_ray_construction(state, lens); });
        benchmark::RegisterBenchmark(("chief_rays/" + lens + "/at_field").c_str(),
                                     [lens](benchmark::State& state) { time_chief_ray_aiming(state, lens); });
    }
    const scene::Chart board{.pattern = scene::Checkerboard{10, 7, 40.0}};
    const scene::Chart discs{.pattern = scene::DiscGrid{9, 6, 40.0, 20.0}};
    for (const scene::Chart& chart : {board, discs}) {
        benchmark::RegisterBenchmark(("refine/" + scene::kind_name(chart)).c_str(), [chart](benchmark::State& state) {
            time_refinement(state, chart);
        })->Unit(benchmark::kMillisecond);
    }
}

}  // namespace lensproof
