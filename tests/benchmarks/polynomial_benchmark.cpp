#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "engine/optics/packet/spectral_lens.h"
#include "engine/polynomial/polynomial_fit.h"
#include "engine/pupil/pupil_map.h"
#include "engine/render/camera/camera.h"
#include "tests/benchmarks/benchmarks.h"

namespace lensproof {

namespace {

struct Setting {
    const char* lens;
    const char* zoom;
    double f_number;
    double focus_distance_mm;
    double half_diagonal_mm;  // of the sensor: about the image circle's radius
};

// Each lens at its full stop.
constexpr Setting kSettings[] = {
    {"tessar", "", 2.8, 10000.0, 45.0},
    {"double-gauss-tronnier", "", 2.0, 5000.0, 21.6},
    {"canon-zoom-70-200", "72 mm", 2.8, 5000.0, 21.6},
    {"canon-zoom-70-200", "194 mm", 2.8, 5000.0, 21.6},
    {"muller-fisheye", "", 4.0, 50000.0, 12.75},
};

/// A picture of 40 × 30 pixels.
render::CameraSettings settings_of(const Setting& setting, render::LensModel model) {
    render::CameraSettings settings;
    settings.lens = setting.lens;
    settings.zoom = setting.zoom;
    settings.f_number = setting.f_number;
    settings.focus_distance_mm = setting.focus_distance_mm;
    settings.sensor = {.width = 40, .height = 30, .pixel_pitch_mm = setting.half_diagonal_mm / 25.0};
    settings.response = "luminance";
    settings.model = model;
    return settings;
}

/// Buffers of paths out of the lens, of which nothing is made.
void time_paths(benchmark::State& state, const Setting& setting, render::LensModel model, render::PathCarry carry) {
    const render::Camera camera(settings_of(setting, model), {}, {}, {});
    render::CameraPaths paths = camera.paths(1, carry);
    render::CameraPathBuffer buffer;
    std::int64_t valid = 0;
    while (state.KeepRunning()) {
        paths.start({.pixels = 40 * 30, .samples = 64});
        while (paths.fill(buffer)) {
            valid += buffer.size;
            benchmark::ClobberMemory();
        }
    }
    state.counters["s/valid_path"] =
        benchmark::Counter(static_cast<double>(valid), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// What the polynomials cost to find, beside the pupil's map, and what they are.
void time_fit(benchmark::State& state, const Setting& setting) {
    const optics::Lens lens = render::camera_lens(settings_of(setting, render::LensModel::polynomial));
    const std::vector<double> nm = spectral::WavelengthStrata{400.0, 700.0, 64}.midpoints();
    const optics::SpectralLens<double> at = optics::at_wavelengths<double>(lens, nm);
    const pupil::PupilMap pupil(at.at(), true, setting.half_diagonal_mm);
    polynomial::PolynomialError error;
    while (state.KeepRunning()) {
        const polynomial::PolynomialLens found = polynomial::fit_polynomial(lens, nm, pupil, setting.half_diagonal_mm);
        error = found.error();
        state.counters["terms"] = found.exits().terms();
        state.counters["degree"] = found.exits().degree();
    }
    state.counters["rms_um"] = error.rms_um;
    state.counters["bound_um"] = error.bound_um;
    state.counters["entry_um"] = error.entry_rms_um;
    state.counters["light_%"] = 100.0 * error.irradiance;
    state.counters["worst_ring_%"] = 100.0 * error.worst_irradiance;
}

}  // namespace

void register_polynomial_benchmarks() {
    using enum render::LensModel;
    for (const Setting& setting : kSettings) {
        const auto add = [&](const std::string& what, auto run) {
            const std::string lens = setting.lens + std::string(*setting.zoom != '\0' ? " " : "") + setting.zoom;
            benchmark::RegisterBenchmark(fmt::format("polynomial/{}/{}", lens, what).c_str(),
                                         [&setting, run](benchmark::State& state) { run(state, setting); })
                ->Unit(benchmark::kMillisecond);
        };
        add("fit", time_fit);
        for (const render::LensModel model : {exact, polynomial}) {
            add(render::name_of(model) + "/hero", [=](benchmark::State& state, const Setting& of) {
                time_paths(state, of, model, render::PathCarry::hero);
            });
            add(render::name_of(model) + "/wavelengths", [=](benchmark::State& state, const Setting& of) {
                time_paths(state, of, model, render::PathCarry::wavelengths);
            });
        }
    }
}

}  // namespace lensproof
