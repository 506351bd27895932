#include "experiments/studies/tradeoff/tradeoff_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/render/scene_setup.h"
#include "experiments/studies/tradeoff/scene_case.h"
#include "experiments/studies/tradeoff/tradeoff_findings.h"

namespace lensproof::studies {

namespace {

std::vector<std::string> error_keys() {
    std::vector<std::string> keys;
    std::ranges::transform(rung_errors(), std::back_inserter(keys), &RungError::key);
    return keys;
}

TradeoffCheck read_check(TomlTable& table, const TradeoffScene& scene) {
    std::vector<std::string> names;
    std::ranges::transform(scene.rungs, std::back_inserter(names), &Rung::name);
    TradeoffCheck check{.rung = table.choice("of", names), .error = table.choice("error", error_keys())};
    check.at_most = table.number("at_most", kNotNegative);
    table.finish();
    return check;
}

std::vector<TradeoffScene> read_scenes(TomlTable& table, findings::ExperimentFile& file) {
    const std::string name = findings::read_name(table);
    TradeoffScene common{.name = name, .title = table.text_or("title", name)};
    common.picture = common.title;
    file.add_subject(table, "name", name);
    const std::filesystem::path scene_file = referred_file(table.file(), table.text("scene"));
    const TomlTable scene = TomlTable::read(scene_file);
    common.rungs = rungs_named(findings::names_of(table, "rungs", rung_names()));
    TradeoffSettings& settings = common.settings;
    settings.pixels = table.integer_or("pixels", settings.pixels, 64, 100'000'000);
    settings.samples = table.integer_or("samples_per_pixel", settings.samples, 1, render::kMostSamplesPerPixel);
    settings.seeds = table.integer_or("seeds", settings.seeds, 2, 1000);
    settings.noise = table.number_or("noise", settings.noise, kPositive);
    common.stated_tolerance = table.text_or("tolerance", kVisibleError);
    try {
        parse_tolerance(common.stated_tolerance);
    } catch (const InputError& error) {
        table.fail("tolerance", error.what());
    }
    for (TomlTable& check : table.tables("checks")) {
        common.checks.push_back(read_check(check, common));
    }
    std::vector<SceneCase> cases;
    for (TomlTable& one : table.tables("cases")) {
        cases.push_back(read_scene_case(one, scene, scene_file));
    }
    table.finish();
    if (cases.empty()) {
        cases.push_back(scene_case(scene, scene_file));
    }
    std::vector<TradeoffScene> scenes;
    for (SceneCase& one : cases) {
        TradeoffScene& through = scenes.emplace_back(common);
        through.setup = std::move(one.setup);
        through.lens = one.name.empty() ? through.setup.camera.lens : one.name;
        through.stated = std::move(one.stated);
        through.files = std::move(one.files);
        if (!one.name.empty()) {
            through.name += "-" + one.name;
            through.title += ", " + one.name;
            file.add_subject(table, "cases", through.name);
        }
    }
    return scenes;
}

constexpr const char* kTradeoffStep = "tradeoff";

findings::StepInput input_of(const TradeoffScene& scene, const findings::RunSettings& settings) {
    std::vector<std::string> names;
    std::ranges::transform(scene.rungs, std::back_inserter(names), &Rung::name);
    return {.settings = {{"scene", scene.stated},
                         {"rungs", names},
                         {"pixels", scene.settings.pixels},
                         {"samples_per_pixel", scene.settings.samples},
                         {"seeds", scene.settings.seeds},
                         {"noise", scene.settings.noise},
                         {"seed", settings.seed}},
            .files = scene.files};
}

MeasuredScene measure(const TradeoffScene& scene, const findings::RunSettings& settings,
                      const findings::RunProgress& progress) {
    TradeoffSettings own = scene.settings;
    own.probe.seed = settings.seed;
    own.probe.threads = settings.threads;
    own.cache = settings.cache;
    MeasuredScene measured{scene, settings.steps.step(kTradeoffStep, input_of(scene, settings), [&] {
                               return measure_tradeoff(scene.setup, scene.rungs, own, progress);
                           })};
    compare_rungs(measured.rungs);
    return measured;
}

}  // namespace

std::vector<std::string> rung_names() {
    std::vector<std::string> names;
    std::ranges::transform(ladder(), std::back_inserter(names), &Rung::name);
    return names;
}

std::vector<Rung> rungs_named(const std::vector<std::string>& names) {
    std::vector<Rung> rungs;
    std::ranges::copy_if(ladder(), std::back_inserter(rungs), [&](const Rung& rung) {
        return rung.name == kReferenceRung || findings::is_wanted(names, rung.name);
    });
    return rungs;
}

std::vector<findings::Study> read_tradeoff(findings::ExperimentFile& file) {
    std::vector<TradeoffScene> scenes;
    for (TomlTable& table : file.tables("tradeoff")) {
        std::ranges::move(read_scenes(table, file), std::back_inserter(scenes));
    }
    if (scenes.empty()) {
        return {};
    }
    const auto planned = [scenes](const findings::RunSettings& settings) {
        std::vector<findings::PlannedStep> steps;
        std::ranges::transform(scenes, std::back_inserter(steps), [&](const TradeoffScene& scene) {
            const auto carry_out = [&scene](const findings::RunSettings& run, const findings::RunProgress& progress) {
                measure(scene, run, progress);
            };
            return findings::PlannedStep{kTradeoffStep, scene.title, input_of(scene, settings), 60.0, carry_out};
        });
        return steps;
    };
    // One study for all tables, since what suffices is told of all of them together.
    const auto carry_out = [scenes = std::move(scenes)](const findings::RunSettings& settings,
                                                        const findings::RunProgress& progress,
                                                        const findings::Findings&) {
        std::vector<MeasuredScene> measured;
        for (const TradeoffScene& scene : scenes) {
            measured.push_back(measure(scene, settings, [&](const std::string& rung, double done) {
                progress(fmt::format("{}: {}", scene.name, rung),
                         (static_cast<double>(measured.size()) + done) / static_cast<double>(scenes.size()));
            }));
        }
        return tradeoff_findings(measured);
    };
    return {{"tradeoff", carry_out, planned}};
}

}  // namespace lensproof::studies
