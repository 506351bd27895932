#include "experiments/studies/tradeoff/account_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <limits>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"

namespace lensproof::studies {

void fields(JsonArchive& json, PlannedOutcome& outcome) {
    json.field("name", outcome.name)
        .field("model", outcome.model)
        .field("predicted", outcome.predicted)
        .field("measured", outcome.measured)
        .field("speed_up", outcome.speed_up)
        .field("probe_seconds", outcome.probe_seconds)
        .field("effects", outcome.effects)
        .field("refused", outcome.refused);
}

namespace {

struct PlannedSet {
    std::string name;
    std::string title;
    std::string stated_tolerance;
    Tolerance tolerance;
    std::vector<SceneCase> cases;
};

PlannedSet read_set(TomlTable& table, findings::ExperimentFile& file) {
    PlannedSet set{.name = findings::read_name(table)};
    set.title = table.text_or("title", set.name);
    file.add_subject(table, "name", set.name);
    const std::filesystem::path scene_file = referred_file(table.file(), table.text("scene"));
    const TomlTable scene = TomlTable::read(scene_file);
    set.stated_tolerance = table.text("tolerance");
    try {
        set.tolerance = parse_tolerance(set.stated_tolerance);
    } catch (const InputError& error) {
        table.fail("tolerance", error.what());
    }
    for (TomlTable& one : table.tables("cases")) {
        set.cases.push_back(read_scene_case(one, scene, scene_file));
    }
    if (set.cases.empty()) {
        table.fail("cases", "has no table, expected one at least");
    }
    table.finish();
    return set;
}

std::string account_svg(const PlannedSet& set, const std::vector<PlannedOutcome>& outcomes) {
    draw::PlotChart chart{
        .title = set.title,
        .caption = fmt::format("Planned at {}: the part of the error that comes nearest to what may be, over that",
                               set.stated_tolerance),
        .x = {.label = "The full model's time over the planned one's, a sample", .scale = draw::AxisScale::logarithmic},
        .y = {.label = "Measured error over tolerance", .holds_zero = true}};
    chart.references.push_back({.direction = draw::ReferenceDirection::horizontal, .at = 1.0, .label = "tolerance"});
    std::vector<std::string> models;
    for (const PlannedOutcome& outcome : outcomes) {
        if (!outcome.refused.empty()) {
            continue;
        }
        auto model = std::ranges::find(models, outcome.model);
        if (model == models.end()) {
            models.push_back(outcome.model);
            model = models.end() - 1;
        }
        const auto index = static_cast<std::size_t>(model - models.begin());
        chart.curves.push_back({.label = outcome.model,
                                .points = {{outcome.speed_up, over_tolerance(outcome.measured, set.tolerance)}},
                                .colour = draw::series_colour(index),
                                .line = draw::CurveLine::none,
                                .marker = static_cast<draw::CurveMarker>(1 + index % 7),
                                .marker_size = 8.0});
    }
    return draw::chart_svg(chart);
}

Json part_json(const Contribution& found) {
    return {{"px", found.px.value},
            {"px_standard_error", found.px.standard_error},
            {"ev", found.ev.value},
            {"ev_standard_error", found.ev.standard_error},
            {"ciede2000", found.ciede2000.value},
            {"ciede2000_standard_error", found.ciede2000.standard_error}};
}

Json effects_json(const std::vector<EffectAccount>& accounts) {
    Json rows = Json::list();
    for (const EffectAccount& account : accounts) {
        rows.push_back({{"effects", account.effects},
                        {"is_bound", account.is_bound},
                        {"predicted", part_json(account.predicted)},
                        {"measured", part_json(account.measured)}});
    }
    return rows;
}

/// A part of a contribution, how the charts call it, and how much of it is tolerated.
struct ContributionPart {
    const char* name;
    const char* unit;
    Measured Contribution::*of;
    double Tolerance::*tolerated;
};
constexpr std::array kParts = {
    ContributionPart{"px", "px", &Contribution::px, &Tolerance::px},
    ContributionPart{"ev", "EV", &Contribution::ev, &Tolerance::ev},
    ContributionPart{"ciede2000", "CIEDE2000", &Contribution::ciede2000, &Tolerance::ciede2000}};

constexpr double kTooLittleToMatter = 0.02;  // of the tolerance

/// Predictions of a part whose error bars hold what was measured, of all that are more than nothing.
std::string coverage(const PlannedSet& set, const std::vector<PlannedOutcome>& outcomes, const ContributionPart& part,
                     bool of_bounds) {
    const double tolerated = set.tolerance.*part.tolerated;
    const double slack = std::isfinite(tolerated) ? kTooLittleToMatter * tolerated : 0.0;
    int all = 0;
    int held = 0;
    for (const PlannedOutcome& outcome : outcomes) {
        for (const EffectAccount& account : outcome.effects) {
            const Measured& predicted = account.predicted.*part.of;
            if (account.is_bound == of_bounds && predicted.value > 0.0) {
                ++all;
                held += covers(predicted, account.measured.*part.of, of_bounds, slack) ? 1 : 0;
            }
        }
    }
    return fmt::format("{} of {}", held, all);
}

std::string scatter_svg(const PlannedSet& set, const std::vector<PlannedOutcome>& outcomes,
                        const ContributionPart& part) {
    constexpr double kLeast = 1e-4;
    draw::PlotChart chart{
        .title = fmt::format("{}: what effects contribute", set.title),
        .caption = fmt::format("Predicted by the plan, and measured by renders with other seeds. Not shown: below {:g}",
                               kLeast),
        .x = {.label = fmt::format("Predicted, {}", part.unit), .scale = draw::AxisScale::logarithmic},
        .y = {.label = fmt::format("Measured, {}", part.unit), .scale = draw::AxisScale::logarithmic}};
    std::vector<std::pair<std::string, std::vector<Vec2d>>> by_effect;
    double least = std::numeric_limits<double>::infinity();
    double most = 0.0;
    for (const PlannedOutcome& outcome : outcomes) {
        for (const EffectAccount& account : outcome.effects) {
            const double x = (account.predicted.*part.of).value;
            const double y = (account.measured.*part.of).value;
            if (!(x >= kLeast && y >= kLeast)) {
                continue;
            }
            const std::string label = account.effects + (account.is_bound ? " (at most)" : "");
            auto found = std::ranges::find(by_effect, label, &decltype(by_effect)::value_type::first);
            if (found == by_effect.end()) {
                found = by_effect.insert(by_effect.end(), {label, {}});
            }
            found->second.push_back({x, y});
            least = std::min({least, x, y});
            most = std::max({most, x, y});
        }
    }
    if (most > 0.0) {
        chart.curves.push_back(
            {.label = "as predicted", .points = {{least, least}, {most, most}}, .colour = "#8a909b"});
    }
    for (std::size_t i = 0; i < by_effect.size(); ++i) {
        chart.curves.push_back({.label = by_effect[i].first,
                                .points = by_effect[i].second,
                                .colour = draw::series_colour(i),
                                .line = draw::CurveLine::none,
                                .marker = static_cast<draw::CurveMarker>(1 + i % 7)});
    }
    return draw::chart_svg(chart);
}

findings::Findings account_findings(const PlannedSet& set, const std::vector<PlannedOutcome>& outcomes) {
    findings::Findings found{.subjects_title = "Plans"};
    std::vector<double> speed_ups;
    double kept = 0.0;
    Json rows = Json::list();
    for (const PlannedOutcome& outcome : outcomes) {
        if (!outcome.refused.empty()) {
            rows.push_back({{"name", outcome.name}, {"refused", outcome.refused}});
            continue;
        }
        const bool keeps = keeps_tolerance(outcome, set.tolerance);
        kept += keeps ? 1.0 : 0.0;
        speed_ups.push_back(outcome.speed_up);
        rows.push_back({{"name", outcome.name},
                        {"model", outcome.model},
                        {"keeps", keeps},
                        {"predicted", part_json(outcome.predicted)},
                        {"measured", part_json(outcome.measured)},
                        {"effects", effects_json(outcome.effects)},
                        {"speed_up", outcome.speed_up},
                        {"probe_seconds", outcome.probe_seconds}});
    }
    const auto planned = static_cast<double>(speed_ups.size());
    const double fraction = planned > 0.0 ? kept / planned : std::nan("");
    std::ranges::sort(speed_ups);
    using Binomial = boost::math::binomial_distribution<>;
    constexpr double kEachSide = 0.025;
    const std::string interval =
        planned > 0.0
            ? fmt::format("{:.1f} to {:.1f} %", 100.0 * Binomial::find_lower_bound_on_p(planned, kept, kEachSide),
                          100.0 * Binomial::find_upper_bound_on_p(planned, kept, kEachSide))
            : "unknown";
    constexpr double kWanted = 0.95;
    found.checks.push_back(
        {.id = set.name + "-kept",
         .group = set.title,
         .subject = set.name,
         .label = fmt::format("plans that keep {}", set.stated_tolerance),
         .value = 100.0 * fraction,
         .sigma = 100.0 * std::sqrt(fraction * (1.0 - fraction) / planned),
         .unit = "%",
         .limit = 100.0 * kWanted,
         .expectation = findings::Expectation::at_least,
         .explanation = fmt::format("Against the full model with other seeds, by two standard errors. Of "
                                    "all such pictures it may be {} (Clopper and Pearson, 95 %).",
                                    interval)});
    constexpr double kSlowest = 0.95;  // of a time that differs from run to run
    found.checks.push_back({.id = set.name + "-slowest",
                            .group = set.title,
                            .subject = set.name,
                            .label = "the least that a plan makes faster",
                            .value = speed_ups.empty() ? std::nan("") : speed_ups.front(),
                            .limit = kSlowest,
                            .expectation = findings::Expectation::at_least,
                            .explanation = "The full model's time over the planned one's, a sample."});
    findings::Subject subject{.id = set.name, .kind = "plans", .label = set.title};
    subject.facts = {{"plans that keep their tolerance, of all such pictures, 95 % interval", interval},
                     {"plans", fmt::format("{}, of {} cases", speed_ups.size(), outcomes.size())},
                     {"times as fast, the median",
                      speed_ups.empty() ? "none" : fmt::format("{:.2f}", speed_ups[speed_ups.size() / 2])}};
    constexpr draw::ChartSize kSize{};
    subject.pictures.push_back({.name = set.name + "/account.svg",
                                .caption = "Error and time, a mark a case",
                                .width = kSize.width,
                                .height = kSize.height,
                                .bytes = account_svg(set, outcomes)});
    for (const ContributionPart& part : kParts) {
        subject.facts.push_back(
            {fmt::format(
                 "predictions in {} that hold what was measured, by two standard errors or {:g} of what is tolerated",
                 part.unit, kTooLittleToMatter),
             coverage(set, outcomes, part, false)});
        subject.facts.push_back(
            {fmt::format("bounds in {} that hold it", part.unit), coverage(set, outcomes, part, true)});
        subject.pictures.push_back({.name = fmt::format("{}/effects-{}.svg", set.name, part.name),
                                    .caption = fmt::format("Contributions in {}, predicted and measured", part.unit),
                                    .width = kSize.width,
                                    .height = kSize.height,
                                    .bytes = scatter_svg(set, outcomes, part)});
    }
    found.subjects.push_back(std::move(subject));
    found.tables = {
        {"planned",
         Json::list({Json{{"name", set.name}, {"tolerance", set.stated_tolerance}, {"cases", std::move(rows)}}})}};
    return found;
}

constexpr const char* kAccountStep = "planned";

findings::StepInput input_of(const PlannedSet& set, const SceneCase& planned, const findings::RunSettings& settings) {
    return {.settings = {{"scene", planned.stated},
                         {"name", planned.name},
                         {"tolerance", set.stated_tolerance},
                         {"seed", settings.seed}},
            .files = planned.files};
}

}  // namespace

bool keeps_tolerance(const PlannedOutcome& outcome, const Tolerance& tolerance) {
    return keeps(surely(outcome.measured), tolerance);
}

PlannedOutcome hold_to_account(const SceneCase& planned, const Tolerance& tolerance, const PilotSettings& settings) {
    PlannedOutcome outcome{.name = planned.name};
    try {
        const Plan plan = plan_render(planned.setup, tolerance, settings);
        PilotSettings other = settings;
        constexpr std::uint64_t kOtherSeeds = 1000;
        other.probe.seed += kOtherSeeds;
        other.samples *= 4;
        other.stray_samples *= 8;
        other.smooth_samples *= 2;
        const PlannedCheck found = check_plan(planned.setup, plan.render, accountable_passes(plan), other);
        outcome.model = plan.render.rung.name;
        outcome.predicted = plan.checked;
        outcome.measured = found.error;
        outcome.speed_up = found.full_ns_per_sample / found.ns_per_sample;
        outcome.probe_seconds = plan.probe_seconds;
        outcome.effects = account_effects(planned.setup, plan, other);
    } catch (const InputError& error) {
        outcome.refused = error.what();
    }
    return outcome;
}

static PlannedOutcome outcome_of(const PlannedSet& set, const SceneCase& planned,
                                 const findings::RunSettings& settings) {
    PilotSettings own;
    own.probe.seed = settings.seed;
    own.probe.threads = settings.threads;
    own.cache = settings.cache;
    return settings.steps.step(kAccountStep, input_of(set, planned, settings),
                               [&] { return hold_to_account(planned, set.tolerance, own); });
}

std::vector<findings::Study> read_planned(findings::ExperimentFile& file) {
    std::vector<findings::Study> studies;
    for (TomlTable& table : file.tables("planned")) {
        const PlannedSet set = read_set(table, file);
        const auto carry_out = [set](const findings::RunSettings& settings, const findings::RunProgress& progress,
                                     const findings::Findings&) {
            std::vector<PlannedOutcome> outcomes;
            for (const SceneCase& planned : set.cases) {
                progress(fmt::format("{}: {}", set.name, planned.name),
                         static_cast<double>(outcomes.size()) / static_cast<double>(set.cases.size()));
                outcomes.push_back(outcome_of(set, planned, settings));
            }
            return account_findings(set, outcomes);
        };
        studies.push_back(
            {set.name, carry_out, [set](const findings::RunSettings& settings) {
                 std::vector<findings::PlannedStep> steps;
                 std::ranges::transform(set.cases, std::back_inserter(steps), [&](const SceneCase& planned) {
                     const auto alone = [&](const findings::RunSettings& run, const findings::RunProgress&) {
                         outcome_of(set, planned, run);
                     };
                     return findings::PlannedStep{kAccountStep, planned.name, input_of(set, planned, settings), 30.0,
                                                  alone};
                 });
                 return steps;
             }});
    }
    return studies;
}

}  // namespace lensproof::studies
