#include "experiments/studies/stability/stability_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/base/json.h"
#include "engine/base/parallel.h"
#include "experiments/studies/stability/stability_words.h"

namespace lensproof::studies {

namespace {
/// Of each number type; where the checks' text says more, a double's.
constexpr std::array<double, kNumberTypes.size()> kTroubleMm = {1e-3, kErrorBoundMm, kErrorBoundMm};

/// A check of a count that has to be 0.
findings::Check none_of(const std::string& id, const std::string& label, int count, const std::string& explanation) {
    return {.id = id,
            .group = "Every ray of every extreme",
            .subject = "",
            .label = label,
            .value = static_cast<double>(count),
            .unit = "",
            .limit = 0.0,
            .expectation = findings::Expectation::at_most,
            .explanation = explanation};
}

template <class Count>
int sum_over(const std::vector<StabilitySweep>& sweeps, const Count& count) {
    int sum = 0;
    for (const StabilitySweep& sweep : sweeps) {
        for (const StabilityPoint& point : sweep.points) {
            sum += count(point);
        }
    }
    return sum;
}

findings::Check bound_check(const StabilitySweep& sweep) {
    const auto worst = std::ranges::max_element(sweep.points, {}, &StabilityPoint::excess);
    const double error = worst->types[kDouble].error_mm;
    return {.id = sweep.extreme.id,
            .group = "A double's error, as a share of what it may be",
            .subject = sweep.extreme.id,
            .label = sweep.extreme.title,
            .value = worst->excess,
            .unit = "",
            .limit = 1.0,
            .expectation = findings::Expectation::at_most,
            .explanation = fmt::format(
                "Closest to its bound at {} {}: there the largest error is {:.2g} mm, and rounding the input moves a "
                "point by {:.2g} mm.",
                sweep.extreme.parameter, value_text(worst->value, sweep.extreme.unit), error, worst->conditioning_mm)};
}

Json value_json(double value) {
    return std::isfinite(value) ? Json(value) : Json(value > 0.0 ? "inf" : "-inf");
}

Json point_json(const StabilityPoint& point) {
    Json json{{"value", value_json(point.value)}};
    if (!point.refusal.empty()) {
        json["refusal"] = point.refusal;
        return json;
    }
    json["rays"] = point.rays;
    json["statuses"] = point.fates;
    json["at_a_change"] = point.at_a_change;
    json["conditioning_mm"] = point.conditioning_mm;
    json["excess"] = point.excess;
    json["packet_lanes_unlike_scalar"] = point.lanes_unlike_scalar;
    for (std::size_t type = 0; type < kNumberTypes.size(); ++type) {
        const TypeResult& result = point.types[type];
        json["types"][kNumberTypes[type]] = {{"error_mm", result.error_mm},
                                             {"other_statuses", result.other_statuses},
                                             {"close_calls", result.close_calls},
                                             {"not_finite", result.not_finite}};
    }
    return json;
}

Json onset_json(const std::optional<Onset>& onset) {
    if (!onset) {
        return nullptr;
    }
    return {{"limit_mm", onset->limit_mm},
            {"from", value_json(onset->from)},
            {"to", value_json(onset->to)},
            {"largest_mm", onset->largest_mm},
            {"is_conditioning", onset->is_conditioning}};
}

Json extreme_json(const StabilitySweep& sweep) {
    Json json{{"id", sweep.extreme.id},
              {"title", sweep.extreme.title},
              {"setting", sweep.extreme.setting},
              {"parameter", sweep.extreme.parameter},
              {"unit", sweep.extreme.unit}};
    for (std::size_t type = 0; type < kNumberTypes.size(); ++type) {
        json["onset"][kNumberTypes[type]] = onset_json(onset_of_trouble(sweep, type));
    }
    for (const StabilityPoint& point : sweep.points) {
        json["points"].push_back(point_json(point));
    }
    return json;
}

findings::Subject extreme_subject(const StabilitySweep& sweep) {
    findings::Subject subject{.id = sweep.extreme.id, .kind = sweep.extreme.setting, .label = sweep.extreme.title};
    for (std::size_t type = 0; type < kNumberTypes.size(); ++type) {
        subject.facts.push_back({kNumberTypes.at(type), trouble_text(sweep, type, kTroubleMm.at(type))});
    }
    std::ranges::move(what_happens(sweep), std::back_inserter(subject.facts));
    subject.pictures = {{.name = sweep.extreme.id + ".svg",
                         .caption = fmt::format("Largest error against the {}", sweep.extreme.parameter),
                         .width = kStabilityChartWidth,
                         .height = kStabilityChartHeight,
                         .bytes = stability_chart(sweep)}};
    return subject;
}

}  // namespace

std::vector<findings::Check> stability_checks(const std::vector<StabilitySweep>& sweeps) {
    std::vector<findings::Check> checks;
    std::ranges::transform(sweeps, std::back_inserter(checks), bound_check);
    const int rays = sum_over(sweeps, [](const StabilityPoint& point) { return point.rays; });
    const int at_a_change = sum_over(sweeps, [](const StabilityPoint& point) { return point.at_a_change; });
    checks.push_back(
        none_of("status", "double: rays with another status than in a hundred digits",
                sum_over(sweeps, [](const StabilityPoint& point) { return point.types[kDouble].other_statuses; }),
                fmt::format("Of {} rays; {} more are within rounding of a change of status, where either is right.",
                            rays - at_a_change, at_a_change)));
    const auto not_finite = [](const StabilityPoint& point) {
        int sum = 0;
        for (const TypeResult& type : point.types) {
            sum += type.not_finite;
        }
        return sum;
    };
    checks.push_back(none_of("finite", "all types: rays with a NaN, an infinity or a transmittance beyond 0 to 1",
                             sum_over(sweeps, not_finite), fmt::format("Of {} rays in each of three types.", rays)));
    checks.push_back(none_of("packets", "SIMD: lanes that have not the bits of the float alone",
                             sum_over(sweeps, [](const StabilityPoint& point) { return point.lanes_unlike_scalar; }),
                             fmt::format("Of {} lanes.", rays)));
    checks.push_back(
        none_of("refusals", "values that are refused and should not be, or taken and should not be",
                sum_over(sweeps, [](const StabilityPoint& point) { return !point.is_rightly_refused; }),
                "What lies beyond a prescription's limits or a glass's formula is refused with its reason."));
    return checks;
}

std::optional<Onset> onset_of_trouble(const StabilitySweep& sweep, std::size_t type) {
    std::optional<Onset> onset;
    for (const StabilityPoint& point : sweep.points) {
        const double error = point.types.at(type).error_mm;
        if (!(error > kTroubleMm.at(type))) {
            continue;
        }
        if (!onset) {
            onset = Onset{.limit_mm = kTroubleMm.at(type),
                          .from = point.value,
                          .to = point.value,
                          .largest_mm = 0.0,
                          .is_conditioning = type == kDouble};
        }
        onset->to = point.value;
        onset->largest_mm = std::max(onset->largest_mm, error);
        onset->is_conditioning = onset->is_conditioning && point.excess <= 1.0;
    }
    return onset;
}

findings::Findings stability_findings(const std::vector<StabilitySweep>& sweeps) {
    findings::Findings found{.checks = stability_checks(sweeps), .counts_checks = true, .subjects_title = "Extremes"};
    std::ranges::transform(sweeps, std::back_inserter(found.subjects), extreme_subject);
    Json extremes;
    std::ranges::transform(sweeps, std::back_inserter(extremes), extreme_json);
    found.tables = {{"extremes", std::move(extremes)}};
    return found;
}

namespace {

constexpr const char* kExtremeStep = "extreme";

findings::StepInput input_of(const Extreme& extreme, const findings::RunSettings& settings) {
    return {.settings = {{"id", extreme.id}, {"seed", settings.seed}}};
}

std::vector<StabilityPoint> points_of(const Extreme& extreme, const findings::RunSettings& settings) {
    return settings.steps.step(kExtremeStep, input_of(extreme, settings),
                               [&] { return measure_stability(extreme, settings.seed).points; });
}

findings::Study stability_study(TomlTable& table, findings::ExperimentFile& file, const std::string& name,
                                const std::string& kind) {
    std::vector<Extreme> extremes = stability_extremes();
    std::vector<std::string> ids;
    std::ranges::transform(extremes, std::back_inserter(ids), &Extreme::id);
    const std::vector<std::string> wanted = findings::names_of(table, "extremes", ids);
    table.finish();
    std::erase_if(extremes, [&](const Extreme& extreme) { return !findings::is_wanted(wanted, extreme.id); });
    for (const Extreme& extreme : extremes) {
        file.add_subject(table, "extremes", name == kind ? extreme.id : name + "-" + extreme.id);
    }
    const auto planned = [extremes](const findings::RunSettings& settings) {
        std::vector<findings::PlannedStep> steps;
        std::ranges::transform(extremes, std::back_inserter(steps), [&](const Extreme& extreme) {
            const auto carry_out = [&extreme](const findings::RunSettings& run, const findings::RunProgress&) {
                points_of(extreme, run);
            };
            return findings::PlannedStep{kExtremeStep, extreme.id, input_of(extreme, settings), 3.0, carry_out};
        });
        return steps;
    };
    const auto carry_out = [extremes = std::move(extremes), name, kind](const findings::RunSettings& settings,
                                                                        const findings::RunProgress& progress,
                                                                        const findings::Findings&) {
        std::vector<StabilitySweep> sweeps(extremes.size());
        const int count = static_cast<int>(extremes.size());
        parallel_for(
            count, settings.threads,
            [&](int i) {
                const auto at = static_cast<std::size_t>(i);
                sweeps[at] = {.extreme = extremes[at], .points = points_of(extremes[at], settings)};
            },
            [&](int done) { progress("extremes", static_cast<double>(done) / count); });
        return findings::told_apart(stability_findings(sweeps), name, kind);
    };
    return {name, carry_out, planned};
}

}  // namespace

std::vector<findings::Study> read_stability(findings::ExperimentFile& file) {
    static const std::string kKind = "stability";
    std::vector<findings::Study> studies;
    for (TomlTable& table : file.tables(kKind)) {
        studies.push_back(stability_study(table, file, findings::name_or(table, kKind), kKind));
    }
    return studies;
}

}  // namespace lensproof::studies
