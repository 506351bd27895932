#include "experiments/cli/run_plan.h"

#include <fmt/format.h>

#include <cmath>

namespace lensproof::cli {

namespace {

struct Totals {
    std::size_t steps = 0;
    std::size_t kept = 0;
    std::size_t unknown = 0;  // studies that find their steps as they go
    double seconds = 0.0;
};

Totals totals_of(const std::vector<AwaitedStudy>& studies) {
    Totals totals;
    for (const AwaitedStudy& study : studies) {
        totals.unknown += study.steps ? 0 : 1;
        for (const AwaitedStep& step : study.steps.value_or(std::vector<AwaitedStep>{})) {
            ++totals.steps;
            totals.kept += step.is_kept ? 1 : 0;
            totals.seconds += step.seconds;
        }
    }
    return totals;
}

std::string time_text(double seconds) {
    constexpr double kMinute = 60.0;
    constexpr double kHour = 3600.0;
    return seconds < kMinute ? fmt::format("{:.0f} s", std::ceil(seconds))
           : seconds < kHour ? fmt::format("{:.0f} min", seconds / kMinute)
                             : fmt::format("{:.1f} h", seconds / kHour);
}

std::string step_line(const AwaitedStep& step, bool has_times) {
    return !has_times     ? fmt::format("  {}\n", step.label)
           : step.is_kept ? fmt::format("  {:10} {}\n", "kept", step.label)
                          : fmt::format("  {:10} {}\n", time_text(step.seconds), step.label);
}

}  // namespace

std::vector<AwaitedStudy> awaited_studies(const runner::Experiment& experiment, const findings::RunSettings& settings) {
    std::vector<AwaitedStudy> studies;
    for (const auto& [table, study] : experiment.studies) {
        AwaitedStudy& awaited = studies.emplace_back();
        awaited.name = study.name;
        awaited.table = table;
        if (!study.steps) {
            continue;
        }
        awaited.steps.emplace();
        for (const findings::PlannedStep& step : study.steps(settings)) {
            awaited.steps->push_back({step.label, settings.steps.is_kept(step), settings.steps.expected_seconds(step)});
        }
    }
    return studies;
}

std::string plan_text(const std::vector<AwaitedStudy>& studies, bool has_times) {
    std::string text;
    for (const AwaitedStudy& study : studies) {
        text += fmt::format("{} {}\n", study.name, study.table);
        if (!study.steps) {
            text += "  steps that it finds as it goes\n";
            continue;
        }
        for (const AwaitedStep& step : *study.steps) {
            text += step_line(step, has_times);
        }
    }
    if (has_times) {
        const Totals totals = totals_of(studies);
        text += fmt::format("{} of {} steps are kept; the others take about {}", totals.kept, totals.steps,
                            time_text(totals.seconds));
        text += totals.unknown == 0 ? "\n"
                                    : fmt::format(", and {} {} will be known when it runs\n", totals.unknown,
                                                  totals.unknown == 1 ? "study's" : "studies'");
    }
    return text;
}

Json plan_json(const std::vector<AwaitedStudy>& studies) {
    const Totals totals = totals_of(studies);
    Json json{{"studies", Json::list()}};
    for (const AwaitedStudy& study : studies) {
        Json one{{"name", study.name}, {"table", study.table}, {"steps", nullptr}};
        if (study.steps) {
            Json steps = Json::list();
            for (const AwaitedStep& step : *study.steps) {
                steps.push_back({{"step", step.label}, {"kept", step.is_kept}, {"seconds", step.seconds}});
            }
            one["steps"] = std::move(steps);
        }
        json["studies"].push_back(std::move(one));
    }
    json["steps"] = totals.steps;
    json["kept"] = totals.kept;
    json["seconds"] = totals.seconds;
    return json;
}

}  // namespace lensproof::cli
