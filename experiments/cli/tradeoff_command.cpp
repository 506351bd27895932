// experiments/cli/tradeoff_command.cpp — `lensproof tradeoff SCENE`: what each model of the scene's camera gets wrong,
// and what it costs.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "engine/base/cache.h"
#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "engine/render/metering.h"
#include "engine/render/scene_setup.h"
#include "experiments/cli/command.h"
#include "experiments/cli/progress.h"
#include "experiments/cli/terminal.h"
#include "experiments/draw/report/report.h"
#include "experiments/runner/provenance.h"
#include "experiments/runner/report_content.h"
#include "experiments/studies/tradeoff/tradeoff_findings.h"
#include "experiments/studies/tradeoff/tradeoff_study.h"

namespace lensproof::cli {

namespace {

struct TradeoffOptions {
    CommonOptions common;
    std::string scene;
    std::vector<std::string> rungs;
    studies::TradeoffSettings settings;
    std::string plot_file;
    std::string report_file;
};

studies::TradeoffScene scene_of(const TradeoffOptions& options) {
    const std::string title = std::filesystem::path(options.scene).stem().string();
    studies::TradeoffScene scene{.name = "tradeoff",
                                 .title = title,
                                 .picture = title,
                                 .setup = render::read_scene_setup(options.scene),
                                 .rungs = studies::rungs_named(options.rungs),
                                 .settings = options.settings};
    render::meter(scene.setup, Cache::standard(), options.common.threads);
    scene.lens = scene.setup.camera.lens;
    scene.settings.probe.seed = options.common.seed;
    scene.settings.probe.threads = options.common.threads;
    scene.settings.cache = Cache::standard();
    return scene;
}

std::string command_of(const TradeoffOptions& options) {
    const studies::TradeoffSettings& settings = options.settings;
    std::string command = fmt::format("lensproof tradeoff {} --pixels {} --spp {} --seeds {} --noise {:g} --seed {}",
                                      runner::portable_path(options.scene), settings.pixels, settings.samples,
                                      settings.seeds, settings.noise, options.common.seed);
    for (std::size_t i = 0; i < options.rungs.size(); ++i) {
        command += (i == 0 ? " --rungs " : ",") + options.rungs[i];
    }
    return command + " --report " + options.report_file;
}

std::string page(const TradeoffOptions& options, const studies::TradeoffScene& scene,
                 const std::vector<studies::MeasuredRung>& rungs) {
    const findings::Findings found = studies::tradeoff_findings({{scene, rungs}});
    Json report = runner::report_json(
        {.title = "What each model costs and gets wrong: " + scene.title,
         .summary = "Each model of the camera against the lens itself, traced surface by surface in double: where it "
                    "puts light, how bright, in which colours, and what it costs.",
         .settings = {{"pixels", scene.settings.pixels},
                      {"samples_per_pixel", scene.settings.samples},
                      {"seeds", scene.settings.seeds},
                      {"noise", scene.settings.noise}},
         .reproduce = command_of(options)},
        found);
    report["verdict"] = findings::verdict_name(findings::Verdict::inconclusive);  // nothing is judged
    return draw::report_html(report, runner::report_pictures(found));
}

void print_rungs(const std::vector<studies::MeasuredRung>& rungs, const TradeoffOptions& options) {
    print("{:<29}{:>19}{:>19}{:>19}{:>19}{:>19}{:>10}{:>9}{:>10}{:>9}\n", "model", "rays µm", "image px", "MTF",
          "exposure EV", "CIEDE2000", "FLIP", "ns/path", "seconds", "MiB");
    const auto with_error = [](const studies::Measured& measured) {
        return fmt::format("{:.3g} ± {:.1g}", measured.value, measured.standard_error);
    };
    for (const studies::MeasuredRung& rung : rungs) {
        if (!rung.not_applicable.empty()) {
            print("{:<29} not here: {}\n", rung.name, rung.not_applicable);
            continue;
        }
        const studies::FieldError& frame = rung.field.frame;
        print("{:<29}{:>19}{:>19}{:>19}{:>19}{:>19}{:>10.3g}{:>9.0f}{:>10.3g}{:>9.3g}{}\n", rung.name,
              with_error(frame.position_um), with_error(frame.image_px), with_error(frame.mtf),
              with_error(frame.exposure_ev), with_error(rung.picture.ciede2000.bias), rung.picture.flip.bias.value,
              rung.cost.ns_per_path, rung.cost.seconds, rung.cost.memory_mib, rung.is_pareto ? "  *" : "");
    }
    print(
        "* no other model is cheaper and no worse; seconds of one core, for the scene's own frame to {:g} % noise; MTF "
        "at the pixels' Nyquist "
        "frequency\n",
        100.0 * options.settings.noise);
}

int run_tradeoff(const TradeoffOptions& options) {
    check_json_name(options.common);
    for (const std::string& file : {options.plot_file, options.report_file}) {
        if (!file.empty()) {
            check_output_name(file);
        }
    }
    const studies::TradeoffScene scene = scene_of(options);
    std::vector<studies::MeasuredRung> rungs;
    try {
        ProgressBar bar("measuring models", options.common.quiet);
        rungs = studies::measure_tradeoff(scene.setup, scene.rungs, scene.settings,
                                          [&](const std::string&, double done) { bar.update(done); });
    } catch (const InputError& error) {
        const std::string message = error.what();
        throw InputError(message.starts_with(options.scene) ? message : fmt::format("{}: {}", options.scene, message));
    }
    if (!options.plot_file.empty()) {
        write_file(options.plot_file, studies::pareto_svg(scene.title, rungs, scene.settings.noise));
    }
    if (!options.report_file.empty()) {
        write_file(options.report_file, page(options, scene, rungs));
    }
    if (prints_text(options.common)) {
        print_rungs(rungs, options);
    }
    Json json = studies::tradeoff_json(rungs);
    json["scene"] = options.scene;
    write_json_result(options.common, json);
    return kDone;
}

}  // namespace

void add_tradeoff_command(Program& program) {
    const auto options = std::make_shared<TradeoffOptions>();
    Command command =
        program.add_command("tradeoff", "Measure what each model of a scene's camera gets wrong and what it costs");
    command.footer(
        "Example: lensproof tradeoff experiments/scenes/checker_wall.toml --plot front.svg\n"
        "Errors are against the lens itself, traced in double. Times are of this machine, and differ from run to run; "
        "all else does not.");
    studies::TradeoffSettings& settings = options->settings;
    command.add_option("SCENE", options->scene, "A scene file").required();
    command.add_option("--rungs", options->rungs, "Only these models, beside the reference (default: all)")
        .check(one_of(studies::rung_names()))
        .separated_by(',')
        .takes_one_argument();
    command
        .add_option("--pixels", settings.pixels,
                    "Pictures are compared at about so many pixels of the scene's frame (image_rms_px is told in the "
                    "scene's own)")
        .check(in_range(64, 100'000'000))
        .shows_default();
    command.add_option("--samples,--spp", settings.samples, "Samples of a pixel and a seed")
        .check(in_range(1, render::kMostSamplesPerPixel))
        .shows_default();
    command.add_option("--seeds", settings.seeds, "Pictures of each model, which tell its noise from its error")
        .check(in_range(2, 1000))
        .shows_default();
    command
        .add_option("--noise", settings.noise, "Costs are told to where a pixel's standard error is this share of it")
        .check(kPositiveOption)
        .shows_default();
    command.add_option("--plot", options->plot_file, "Draw errors against costs (SVG)").type_name("FILE");
    command.add_option("--report", options->report_file, "Write a page with pictures and curves (HTML)")
        .type_name("FILE");
    add_common_options(command, options->common);
    command.runs([options] { return run_tradeoff(*options); });
}

}  // namespace lensproof::cli
