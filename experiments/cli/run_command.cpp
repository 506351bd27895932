// experiments/cli/run_command.cpp — `lensproof run EXPERIMENT`: end to end, to a report.
#include <fmt/format.h>

#include <functional>
#include <map>
#include <memory>
#include <stdexcept>

#include "engine/base/cache.h"
#include "engine/base/data_root.h"
#include "engine/base/json.h"
#include "engine/base/write_file.h"
#include "experiments/cli/command.h"
#include "experiments/cli/interruption.h"
#include "experiments/cli/progress.h"
#include "experiments/cli/terminal.h"
#include "experiments/draw/report/report.h"
#include "experiments/runner/kept_steps.h"
#include "experiments/runner/report_content.h"

namespace lensproof::cli {

namespace {

struct RunOptions {
    CommonOptions common;
    std::string experiment;
    std::string output;
    bool fresh = false;
};

/// Thrown where a signal asked the run to end.
struct Interrupted {};

/// A new progress bar for every new step. Throws Interrupted once a signal has come.
class StepProgress {
  public:
    explicit StepProgress(bool quiet) : quiet_(quiet) {}

    void operator()(const std::string& step, double done) {
        if (Interruption::has_come()) {
            throw Interrupted();
        }
        if (step != step_) {
            bar_.reset();
            step_ = step;
            bar_ = std::make_unique<ProgressBar>(step, quiet_);
        }
        bar_->update(done);
    }

  private:
    bool quiet_;
    std::string step_;
    std::unique_ptr<ProgressBar> bar_;
};

void print_checks(const std::vector<findings::Check>& checks) {
    std::string group;
    for (const findings::Check& check : checks) {
        if (check.group != group) {
            group = check.group;
            print("{}\n", group);
        }
        const std::string bound =
            check.expectation == findings::Expectation::within ? fmt::format("{:g} ± {:g}", check.target, check.limit)
            : check.expectation == findings::Expectation::differs  ? fmt::format("> {:g}", check.limit)
            : check.expectation == findings::Expectation::at_least ? fmt::format("≥ {:g}", check.limit)
                                                                   : fmt::format("≤ {:g}", check.limit);
        print("  {:13} {:44} {:.4g} ± {:.2g} {} (wanted {})\n", findings::verdict_name(check.verdict()), check.label,
              check.value, check.sigma, check.unit, bound);
    }
}

/// Writes profiles, pictures, report.json and report.html.
void write_report(const std::filesystem::path& folder, const findings::Findings& found, const Json& report) {
    for (const calibration::Profile& profile : found.profiles) {
        calibration::write_profile(profile, folder / "profiles" / (profile.name + ".json"));
    }
    const std::map<std::string, std::string> pictures = runner::report_pictures(found);
    for (const auto& [name, bytes] : pictures) {
        write_file(folder / "images" / name, bytes);
    }
    write_file(folder / "report.json", report.dump(2) + "\n");
    write_file(folder / "report.html", draw::report_html(report, pictures));
}

void say_what_was_kept(const RunOptions& options, const findings::Steps& steps, const std::filesystem::path& folder) {
    if (steps.kept() > 0 && !options.common.quiet) {
        print_message("lensproof: {} of {} steps were finished before, and kept in {} (--fresh: do all again)\n",
                      steps.kept(), steps.kept() + steps.made(), folder.string());
    }
}

int run(const RunOptions& options) {
    const runner::Experiment experiment = runner::read_experiment(options.experiment);
    const std::filesystem::path folder =
        options.output.empty() ? std::filesystem::path("output") / std::filesystem::path(options.experiment).stem()
                               : std::filesystem::path(options.output);
    // A folder that cannot be made is better known before the long part than after it.
    check_output_name(folder / "report.html");
    check_output_name(folder / "report.json");
    check_json_name(options.common);
    const std::filesystem::path kept = folder / "steps";
    const findings::RunSettings settings{.seed = options.common.seed,
                                         .threads = options.common.threads,
                                         .cache = Cache::standard(),
                                         .steps = runner::steps_kept_in(kept, options.fresh)};
    findings::Findings found;
    try {
        const Interruption interruption;
        StepProgress progress(options.common.quiet);
        found = runner::run_experiment(experiment, settings, std::ref(progress));
    } catch (const Interrupted&) {
        throw std::runtime_error(fmt::format("ended early, with {} steps finished; the same command goes on from {}",
                                             settings.steps.kept() + settings.steps.made(), kept.string()));
    }
    say_what_was_kept(options, settings.steps, kept);
    const Json report = runner::report_json(experiment, found, settings);
    const Delivery delivery =
        write_somewhere({folder}, [&](const std::filesystem::path& place) { write_report(place, found, report); });
    const findings::Verdict verdict = findings::overall(found.checks);
    if (prints_text(options.common)) {
        print_checks(found.checks);
        print("{}: {}\n", findings::verdict_name(verdict), (delivery.place / "report.html").string());
    }
    write_json_result(options.common, report);
    check_place(delivery);
    return verdict == findings::Verdict::pass ? kDone : kCheckFailed;
}

}  // namespace

void add_run_command(Program& program) {
    const auto options = std::make_shared<RunOptions>();
    Command command = program.add_command("run", "Run an experiment end to end and write its report");
    command.footer("Example: lensproof run experiments/first_light.toml -o output/first_light");
    command.add_option("EXPERIMENT", options->experiment, "An experiment file").required();
    command.add_option("-o,--output", options->output, "Folder to write (default: output/EXPERIMENT)").type_name("DIR");
    command.add_flag("--fresh", options->fresh, "Do every step again, also those that an earlier run has finished");
    add_common_options(command, options->common);
    command.runs([options] { return run(*options); });
}

void add_demo_command(Program& program) {
    const auto options = std::make_shared<RunOptions>();
    Command command = program.add_command("demo", "Run the demo, the experiment first_light, and write its report");
    command.footer("Example: lensproof demo -o output/first_light");
    command.add_option("-o,--output", options->output, "Folder to write (default: output/first_light)")
        .type_name("DIR");
    add_common_options(command, options->common);
    command.runs([options] {
        options->experiment = (data_root() / "experiments" / "first_light.toml").string();
        return run(*options);
    });
}

}  // namespace lensproof::cli
