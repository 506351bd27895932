#include <benchmark/benchmark.h>

#include <string>

#include "engine/analysis/field_curves.h"
#include "engine/analysis/lens_analysis.h"
#include "engine/analysis/ray_curves.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/spectral/wavelengths.h"
#include "tests/benchmarks/benchmarks.h"

namespace lensproof {

namespace {

/// What a designer asks of a lens: ten fields up to the stated one, three wavelengths.
analysis::AnalysisSettings usual_settings(const optics::Lens& lens) {
    constexpr double kFieldDeg = 20.0;  // where none is stated
    return {.wavelengths_nm = {spectral::kLineD, spectral::kLineF, spectral::kLineC},
            .reference_wavelength_nm = spectral::kLineD,
            .fields_deg = analysis::even_fields(lens.stated.half_field_deg.value_or(kFieldDeg), 10)};
}

void analyze_table(benchmark::State& state, const std::string& name) {
    const optics::Lens lens = formats::load_lens(name);
    const analysis::AnalysisSettings settings = usual_settings(lens);
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(analysis::analyze_lens(lens, settings));
    }
}

void analyze_curves(benchmark::State& state, const std::string& name) {
    const optics::Lens lens = formats::load_lens(name);
    const analysis::AnalysisSettings settings = usual_settings(lens);
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(analysis::ray_curves(lens, settings));
    }
}

}  // namespace

void register_analysis_benchmarks() {
    for (const std::string lens : {"tessar", "westrogon-24", "muller-fisheye"}) {
        const auto add = [&](const char* what, auto run) {
            benchmark::RegisterBenchmark(("analyze/" + lens + "/" + what).c_str(), run, lens)
                ->Unit(benchmark::kMillisecond);
        };
        add("table", analyze_table);
        add("curves", analyze_curves);
    }
}

}  // namespace lensproof
