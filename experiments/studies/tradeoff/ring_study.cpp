#include "experiments/studies/tradeoff/ring_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/optics/focus.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"
#include "experiments/studies/tradeoff/processor_time.h"

namespace lensproof::studies {

void fields(JsonArchive& json, RingError& error) {
    json.field("rings", error.rings)
        .field("spot_um", error.spot_um)
        .field("centroid_um", error.centroid_um)
        .field("wavefront_waves", error.wavefront_waves)
        .field("milliseconds", error.milliseconds);
}

namespace {

constexpr std::array kRingCounts = {1, 2, 3, 4, 6, 8, 12, 16, 24};

struct AnalysedLens {
    std::string lens;
    std::optional<double> f_number;
    std::vector<double> fields_deg;
};

std::string label_of(const AnalysedLens& analysed) {
    return analysed.lens + (analysed.f_number ? fmt::format(" at f/{:g}", *analysed.f_number) : ", wide open");
}

std::vector<RingError> measure_rings(const AnalysedLens& analysed) {
    optics::Lens lens = formats::load_lens(analysed.lens);
    if (analysed.f_number) {
        lens = optics::with_f_number(std::move(lens), *analysed.f_number);
    }
    return ring_errors(lens,
                       {.wavelengths_nm = {spectral::kLineD, spectral::kLineF, spectral::kLineC},
                        .reference_wavelength_nm = spectral::kLineD,
                        .fields_deg = analysed.fields_deg},
                       {kRingCounts.begin(), kRingCounts.end()});
}

std::string rings_svg(const std::string& title, const std::vector<RingError>& errors) {
    draw::PlotChart chart{
        .title = title,
        .caption = fmt::format("Against {} rings, rms over fields and wavelengths; from {} rings at the left to {}",
                               kManyRings, errors.front().rings, errors.back().rings),
        .x = {.label = "Time of an analysis", .unit = "ms", .scale = draw::AxisScale::logarithmic},
        .y = {.label = "Error", .unit = "µm", .scale = draw::AxisScale::logarithmic}};
    struct Kind {
        const char* label;
        double RingError::*what;
    };
    constexpr double kLeast = 1e-9;  // what double leaves
    for (const Kind& kind :
         {Kind{"rms radius of the spot", &RingError::spot_um}, Kind{"its centroid", &RingError::centroid_um}}) {
        draw::ChartCurve curve{.label = kind.label,
                               .points = {},
                               .colour = draw::series_colour(chart.curves.size()),
                               .marker = draw::CurveMarker::dot};
        for (const RingError& error : errors) {
            curve.points.push_back({error.milliseconds, std::max(kLeast, error.*kind.what)});
        }
        chart.curves.push_back(std::move(curve));
    }
    return draw::chart_svg(chart);
}

void add_findings(const AnalysedLens& analysed, const std::vector<RingError>& errors, findings::Findings& found,
                  Json& table) {
    findings::Subject subject{
        .id = "rings-" + analysed.lens, .kind = "rings of an analysis", .label = label_of(analysed)};
    Json rows = Json::list();
    for (const RingError& error : errors) {
        subject.facts.push_back(
            {fmt::format("{} ring{}", error.rings, error.rings == 1 ? "" : "s"),
             fmt::format("spot {:.2g} µm, centroid {:.2g} µm, wavefront {:.2g} waves, {:.2g} ms", error.spot_um,
                         error.centroid_um, error.wavefront_waves, error.milliseconds)});
        rows.push_back({{"rings", error.rings},
                        {"spot_um", error.spot_um},
                        {"centroid_um", error.centroid_um},
                        {"wavefront_waves", error.wavefront_waves},
                        {"milliseconds", error.milliseconds}});
    }
    constexpr draw::ChartSize kSize{};
    subject.pictures.push_back({.name = subject.id + "/rings.svg",
                                .caption = "Error against time",
                                .width = kSize.width,
                                .height = kSize.height,
                                .bytes = rings_svg(label_of(analysed), errors)});
    found.subjects.push_back(std::move(subject));
    table.push_back({{"lens", analysed.lens}, {"rings", std::move(rows)}});
}

}  // namespace

std::vector<RingError> ring_errors(const optics::Lens& lens, const analysis::AnalysisSettings& settings,
                                   const std::vector<int>& rings) {
    const auto analyse = [&](int count) {
        analysis::AnalysisSettings own = settings;
        own.rings = count;
        return analysis::analyze_lens(lens, own).fields;
    };
    const std::vector<analysis::FieldAnalysis> exact = analyse(kManyRings);
    std::vector<RingError> errors;
    for (const int count : rings) {
        constexpr int kRuns = 3;
        std::array<double, kRuns> seconds{};
        std::vector<analysis::FieldAnalysis> found;
        for (double& run : seconds) {
            const double start = processor_seconds(CLOCK_THREAD_CPUTIME_ID);
            found = analyse(count);
            run = processor_seconds(CLOCK_THREAD_CPUTIME_ID) - start;
        }
        RingError error{.rings = count, .milliseconds = 1e3 * *std::ranges::min_element(seconds)};
        double fields = 0.0;
        for (std::size_t i = 0; i < exact.size(); ++i) {
            if (!exact[i].spot_rms || !found[i].spot_rms) {
                continue;
            }
            fields += 1.0;
            const Vec2d off = *found[i].spot_centroid - *exact[i].spot_centroid;
            error.spot_um += std::pow(1e3 * (*found[i].spot_rms - *exact[i].spot_rms), 2);
            error.centroid_um += 1e6 * (off.x * off.x + off.y * off.y);
            error.wavefront_waves +=
                std::pow(found[i].wavefront_rms_waves.value_or(0.0) - exact[i].wavefront_rms_waves.value_or(0.0), 2);
        }
        for (double RingError::*sum : {&RingError::spot_um, &RingError::centroid_um, &RingError::wavefront_waves}) {
            error.*sum = std::sqrt(error.*sum / std::max(1.0, fields));
        }
        errors.push_back(error);
    }
    return errors;
}

static constexpr const char* kRingStep = "analysis-rings";

std::vector<findings::Study> read_analysis_rings(findings::ExperimentFile& file) {
    std::vector<findings::Study> studies;
    for (TomlTable& table : file.tables("analysis_rings")) {
        AnalysedLens analysed{.lens = formats::read_lens_name(table)};
        analysed.f_number = table.has("f_number") ? std::optional(table.number("f_number", kPositive)) : std::nullopt;
        analysed.fields_deg = table.numbers("fields_deg", 0, {.min = -90.0, .max = 90.0});
        const std::string id = "rings-" + analysed.lens;
        file.add_subject(table, "lens", id);
        table.finish();
        const findings::StepInput input{.settings = {{"lens", analysed.lens},
                                                     {"f_number", analysed.f_number.value_or(0.0)},
                                                     {"fields_deg", analysed.fields_deg}},
                                        .files = formats::files_of_lens(analysed.lens)};
        const auto measured = [analysed, input](const findings::RunSettings& settings,
                                                const findings::RunProgress& progress) {
            progress(label_of(analysed), 0.0);
            return settings.steps.step(kRingStep, input, [&] { return measure_rings(analysed); });
        };
        const auto carry_out = [analysed, input, measured](const findings::RunSettings& settings,
                                                           const findings::RunProgress& progress,
                                                           const findings::Findings&) {
            findings::Findings found{.subjects_title = "Analyses"};
            Json list = Json::list();
            add_findings(analysed, measured(settings, progress), found, list);
            std::ranges::copy(input.files, std::back_inserter(found.inputs));
            found.tables = {{"analysis_rings", std::move(list)}};
            return found;
        };
        studies.push_back({id, carry_out, [input, measured, label = label_of(analysed)](const findings::RunSettings&) {
                               return std::vector<findings::PlannedStep>{{kRingStep, label, input, 10.0, measured}};
                           }});
    }
    return studies;
}

}  // namespace lensproof::studies
