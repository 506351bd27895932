#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <memory>
#include <string>

#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/render/camera/camera.h"
#include "engine/render/camera/lens_paths.h"
#include "engine/render/integrators/chart_tracer.h"
#include "engine/render/sampling/sampler.h"
#include "engine/spectral/wavelengths.h"
#include "tests/benchmarks/benchmarks.h"

namespace lensproof {

namespace {

constexpr std::uint32_t kSamples = 64;  // of a pixel

void time_points_one_by_one(benchmark::State& state) {
    std::uint32_t pixel = 0;
    while (state.KeepRunning()) {
        const render::PixelSampler sampler(0, pixel++);
        for (std::uint32_t i = 0; i < kSamples; ++i) {
            benchmark::DoNotOptimize(sampler.point(i));
        }
    }
    state.counters["points/s"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * kSamples, benchmark::Counter::kIsRate);
}

/// As camera paths take them: in columns, film positions included.
void time_points_in_columns(benchmark::State& state, SimdLevel level) {
    const render::PathSampling sampling{
        .sensor = {.width = 64, .height = 48, .pixel_pitch_mm = 0.01}, .seed = 0, .wavelengths = kSamples};
    const auto starts = std::make_unique<render::PathStarts>();
    render::PathCursor cursor{.samples = kSamples};
    while (state.KeepRunning()) {
        render::path_kernels(level).draw_samples(sampling, kSamples, cursor, *starts);
        benchmark::DoNotOptimize(*starts);
    }
    state.counters["points/s"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * kSamples, benchmark::Counter::kIsRate);
}

struct Setting {
    const char* lens;
    double f_number;
    double focus_distance_mm;
    double half_diagonal_mm;  // of the sensor: about the image circle's radius
};

constexpr Setting kSettings[] = {
    {"tessar", 2.8, 10000.0, 45.0},          {"petzval", 2.2, 10000.0, 22.5},
    {"muller-fisheye", 8.0, 50000.0, 12.75}, {"double-gauss-tronnier", 2.0, 5000.0, 21.6},
    {"wide-nakamura", 8.0, 5000.0, 17.0},    {"westrogon-24", 8.0, 5000.0, 18.0},
};

/// A picture of 40 × 30 pixels, at 64 wavelengths from 400 nm to 700 nm.
class PathScene {
  public:
    explicit PathScene(const Setting& setting)
        : lens_(optics::at_wavelengths<double>(
              optics::focused_at(optics::with_f_number(formats::load_lens(setting.lens), setting.f_number),
                                 setting.focus_distance_mm),
              spectral::WavelengthStrata{400.0, 700.0, 64}.midpoints())),
          sensor_{.width = 40, .height = 30, .pixel_pitch_mm = setting.half_diagonal_mm / 25.0},
          chart_{.chart = {.pattern = scene::DiscGrid{12, 9, 0.05 * setting.focus_distance_mm,
                                                      0.025 * setting.focus_distance_mm}},
                 .pose = scene::place({.distance_mm = setting.focus_distance_mm}),
                 .white_radiance = {}},
          pupil_(lens_.at(), true, setting.half_diagonal_mm),
          slices_(pupil_, lens_.wavelengths()) {}

    [[nodiscard]] std::uint32_t pixels() const { return 40 * 30; }
    [[nodiscard]] const render::Sensor& sensor() const { return sensor_; }
    [[nodiscard]] const pupil::PupilMap& pupil() const { return pupil_; }

    [[nodiscard]] const optics::SpectralLens<double>& lens() const { return lens_; }
    [[nodiscard]] render::LensPaths paths(SimdLevel level) const {
        return {{.sensor = sensor_}, lens_, slices_, level};
    }

    /// Work as a scene makes it: what the ray sees of a chart.
    [[nodiscard]] double look_up(const Ray<double>& ray) const {
        const render::ChartMeeting at = render::meet_chart(chart_.pose, ray);
        return render::is_met(at.distance_mm) ? scene::reflectance(chart_.chart, at.x_mm, at.y_mm)
                                              : chart_.chart.white_reflectance;
    }

  private:
    optics::SpectralLens<double> lens_;
    render::Sensor sensor_;
    render::EvenChart chart_;
    pupil::PupilMap pupil_;
    pupil::PupilSlices slices_;
};

enum class Consumer { none, chart };

void count_paths(benchmark::State& state, std::int64_t valid, std::int64_t started) {
    const double total = static_cast<double>(valid) * static_cast<double>(state.iterations());
    state.counters["valid_paths/s"] = benchmark::Counter(total, benchmark::Counter::kIsRate);
    state.counters["s/valid_path"] =
        benchmark::Counter(total, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["passage"] = static_cast<double>(valid) / static_cast<double>(started);
}

/// Path by path through the scalar tracer, each shaded before the next is begun.
void time_one_by_one(benchmark::State& state, const Setting& setting, Consumer consumer) {
    const PathScene scene(setting);
    const pupil::PupilMap& pupil = scene.pupil();
    std::int64_t valid = 0;
    std::int64_t started = 0;
    while (state.KeepRunning()) {
        valid = 0;
        started = 0;
        for (std::uint32_t pixel = 0; pixel < scene.pixels(); ++pixel) {
            const render::PixelSampler sampler(0, pixel);
            const std::uint32_t row = pixel / 40;
            for (std::uint32_t sample = 0; sample < kSamples; ++sample) {
                const auto xi = sampler.point(sample);
                const int wavelength = static_cast<int>(xi[4] * 64);
                const optics::TraceLens<double>& lens = scene.lens().at(wavelength);
                const Vec2d at = scene.sensor().position(pixel % 40 - 0.5 + xi[0], row - 0.5 + xi[1]);
                const pupil::PupilSample in_pupil = pupil.sample(at, wavelength / 63.0, xi[2], xi[3]);
                if (!(in_pupil.pdf > 0.0)) {
                    continue;
                }
                ++started;
                const Vec3d film{at.x, at.y, lens.image_z};
                const Vec3d to_pupil = Vec3d{in_pupil.point.x, in_pupil.point.y, pupil.plane_z()} - film;
                const double distance2 = dot(to_pupil, to_pupil);
                const Ray<double> ray{film, (1.0 / std::sqrt(distance2)) * to_pupil};
                const optics::TracedRay<double> traced = optics::trace<optics::Direction::reverse>(lens, ray);
                if (traced.status == optics::RayStatus::ok) {
                    ++valid;
                    const double weight =
                        traced.transmittance * ray.direction.z * ray.direction.z / (distance2 * in_pupil.pdf);
                    benchmark::DoNotOptimize(consumer == Consumer::chart ? weight * scene.look_up(traced.ray) : weight);
                }
            }
        }
    }
    count_paths(state, valid, started);
}

void time_buffers(benchmark::State& state, const Setting& setting, SimdLevel level, Consumer consumer) {
    const PathScene scene(setting);
    render::LensPaths producer = scene.paths(level);
    render::CameraPathBuffer paths;
    std::int64_t valid = 0;
    while (state.KeepRunning()) {
        valid = 0;
        producer.start({.pixels = scene.pixels(), .samples = kSamples});
        while (producer.fill(paths)) {
            valid += paths.size;
            const auto looked_up = consumer == Consumer::chart ? static_cast<std::size_t>(paths.size) : 0;
            for (std::size_t i = 0; i < looked_up; ++i) {
                benchmark::DoNotOptimize(paths.weight[i] * scene.look_up(paths.ray(i)));
            }
            benchmark::ClobberMemory();
        }
    }
    count_paths(state, valid, producer.started() / static_cast<std::int64_t>(state.iterations()));
}

/// A whole camera, whichever stands for the lens: paths that carry four wavelengths, as a render has them.
void time_model(benchmark::State& state, render::LensModel model) {
    const render::Camera camera({.lens = "double-gauss-tronnier",
                                 .f_number = 2.0,
                                 .focus_distance_mm = 2000.0,
                                 .sensor = {.width = 40, .height = 30, .pixel_pitch_mm = 21.6 / 25.0},
                                 .response = "luminance",
                                 .model = model},
                                {.layers = 64, .strata_per_layer = 1}, {}, {});
    render::CameraPaths producer = camera.paths(0, render::PathCarry::wavelengths);
    render::CameraPathBuffer paths;
    std::int64_t valid = 0;
    while (state.KeepRunning()) {
        valid = 0;
        producer.start({.pixels = 40 * 30, .samples = kSamples});
        while (producer.fill(paths)) {
            valid += paths.size;
            benchmark::ClobberMemory();
        }
    }
    count_paths(state, valid, producer.started() / static_cast<std::int64_t>(state.iterations()));
}

/// What a start without a cache costs: the map and its tables.
void time_set_up(benchmark::State& state, const Setting& setting) {
    const PathScene scene(setting);
    const std::vector<optics::TraceLens<double>>& band = scene.lens().at();
    while (state.KeepRunning()) {
        const pupil::PupilMap map(band, true, setting.half_diagonal_mm);
        benchmark::DoNotOptimize(pupil::PupilSlices(map, scene.lens().wavelengths()).tables());
    }
}

void register_camera_paths(const Setting& setting, Consumer consumer) {
    const auto add = [&](const std::string& technique, auto run) {
        benchmark::RegisterBenchmark(
            fmt::format("camera_paths/{}/{}{}", setting.lens, technique, consumer == Consumer::chart ? "/chart" : "")
                .c_str(),
            run)
            ->Unit(benchmark::kMillisecond);
    };
    add("one_by_one", [=](benchmark::State& state) { time_one_by_one(state, setting, consumer); });
    for (const SimdLevel level : available_simd_levels()) {
        add(fmt::format("buffers/{}", simd_name(level)),
            [=](benchmark::State& state) { time_buffers(state, setting, level, consumer); });
    }
}

}  // namespace

void register_camera_path_benchmarks() {
    benchmark::RegisterBenchmark("sampler/points/one_by_one", time_points_one_by_one);
    for (const SimdLevel level : available_simd_levels()) {
        benchmark::RegisterBenchmark(fmt::format("sampler/points/{}", simd_name(level)).c_str(),
                                     [level](benchmark::State& state) { time_points_in_columns(state, level); });
    }
    for (const std::string& name : render::lens_model_names()) {
        const render::LensModel model = render::lens_model_named(name).value();
        benchmark::RegisterBenchmark(("camera_paths/model/" + name).c_str(), [model](benchmark::State& state) {
            time_model(state, model);
        })->Unit(benchmark::kMillisecond);
    }
    for (const Setting& setting : kSettings) {
        benchmark::RegisterBenchmark(fmt::format("camera_paths/{}/set_up", setting.lens).c_str(),
                                     [&setting](benchmark::State& state) { time_set_up(state, setting); })
            ->Unit(benchmark::kMillisecond);
        register_camera_paths(setting, Consumer::none);
        register_camera_paths(setting, Consumer::chart);
    }
}

}  // namespace lensproof
