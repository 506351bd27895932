// experiments/cli/plan_command.cpp — `lensproof plan SCENE --tolerance T`: which effects the scene's picture needs.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "engine/base/cache.h"
#include "engine/base/input_error.h"
#include "engine/render/metering.h"
#include "experiments/cli/command.h"
#include "experiments/cli/planned_render.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

using studies::Contribution;
using studies::Measured;
using studies::Plan;
using studies::PlannedEffect;

std::string with_error(const Measured& measured) {
    return measured.value > 0.0 || measured.standard_error > 0.0
               ? fmt::format("{:.2g} ± {:.1g}", measured.value, measured.standard_error)
               : "-";
}

void print_plan(const Plan& plan) {
    print("{:<20}{:>18}{:>18}{:>16}  {}\n", "effect", "px", "EV", "CIEDE2000", "decision");
    for (const PlannedEffect& planned : plan.effects) {
        const Contribution& found = planned.effect.contribution;
        print("{:<20}{:>18}{:>18}{:>16}  {}: {}\n", planned.effect.name, with_error(found.px), with_error(found.ev),
              with_error(found.ciede2000), planned.is_modelled ? "model" : "leave out", planned.why);
    }
    for (const std::string& refused : plan.refused) {
        print("refused: {}\n", refused);
    }
    show(plan_text(plan) + "\n");
    print("checked on other seeds: {} px, {} EV, {} CIEDE2000 from the full model\n", with_error(plan.checked.px),
          with_error(plan.checked.ev), with_error(plan.checked.ciede2000));
    print("probes took {:.2g} s\n", plan.probe_seconds);
}

}  // namespace

studies::Plan plan_of(const render::SceneSetup& setup, const std::string& scene, const std::string& tolerance,
                      const CommonOptions& common) {
    studies::PilotSettings settings;
    settings.probe.seed = common.seed;
    settings.probe.threads = common.threads;
    settings.cache = Cache::standard();
    const studies::Tolerance wanted = studies::parse_tolerance(tolerance);
    try {
        return studies::plan_render(setup, wanted, settings);
    } catch (const InputError& error) {
        const std::string message = error.what();
        throw InputError(message.starts_with(scene) ? message : fmt::format("{}: {}", scene, message));
    }
}

std::string plan_text(const Plan& plan) {
    std::string text = plan.render.rung.name;
    if (plan.render.rung.wavelengths) {
        text += fmt::format(", {} wavelengths", *plan.render.rung.wavelengths);
    }
    text += fmt::format(", paths of at most {} scattering{}", plan.render.max_bounces,
                        plan.render.max_bounces == 1 ? "" : "s");
    if (!plan.render.passes.empty()) {
        text += fmt::format(", with {}", fmt::join(plan.render.passes, ", "));
    }
    for (const render::SmoothPass& smooth : plan.render.smooth) {
        text +=
            fmt::format(", {} of 1/{} of the samples spread over {:g} px", smooth.pass, smooth.fewer, smooth.sigma_px);
    }
    text += fmt::format("; a sample costs 1/{:.2g} of the full model's", plan.speed_up);
    if (plan.noise_ev > plan.tolerance.ev) {
        const double times = plan.noise_ev / plan.tolerance.ev;
        text += fmt::format(
            "; the scene's samples leave {:.2g} EV of noise in a pixel, for the tolerance it takes {:.2g} "
            "times as many",
            plan.noise_ev, times * times);
    }
    return text;
}

void add_plan_command(Program& program) {
    struct Options {
        CommonOptions common;
        std::string scene;
        std::string tolerance;
    };
    const auto options = std::make_shared<Options>();
    Command command = program.add_command("plan", "Say which effects a scene's picture needs at a tolerance, and why");
    command.footer(
        "Example: lensproof plan experiments/scenes/checker_wall.toml --tolerance 0.5px,0.02ev,1de\n"
        "`lensproof render SCENE --model auto --tolerance T` acts on it.");
    command.add_option("SCENE", options->scene, "A scene file").required();
    command
        .add_option("--tolerance", options->tolerance,
                    "What may be wrong: px (rms over the frame), ev (rms), de (mean CIEDE2000), each optional; or "
                    "visible, for 1px,0.03ev,1de")
        .required()
        .type_name("T");
    add_common_options(command, options->common);
    command.runs([options] {
        check_json_name(options->common);
        render::SceneSetup setup = render::read_scene_setup(options->scene);
        render::meter(setup, Cache::standard(), options->common.threads);
        const Plan plan = plan_of(setup, options->scene, options->tolerance, options->common);
        if (prints_text(options->common)) {
            print_plan(plan);
        }
        Json json = studies::plan_json(plan);
        json["scene"] = options->scene;
        write_json_result(options->common, json);
        return static_cast<int>(kDone);
    });
}

}  // namespace lensproof::cli
