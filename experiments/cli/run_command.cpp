// experiments/cli/run_command.cpp — `lensproof run EXPERIMENT`: end to end, to a report.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>

#include "engine/base/cache.h"
#include "engine/base/data_root.h"
#include "engine/base/json.h"
#include "engine/base/write_file.h"
#include "experiments/cli/command.h"
#include "experiments/cli/device_option.h"
#include "experiments/cli/interruption.h"
#include "experiments/cli/progress.h"
#include "experiments/cli/run_parts.h"
#include "experiments/cli/run_plan.h"
#include "experiments/cli/shard.h"
#include "experiments/cli/terminal.h"
#include "experiments/draw/report/report.h"
#include "experiments/runner/against.h"
#include "experiments/runner/junit.h"
#include "experiments/runner/kept_steps.h"
#include "experiments/runner/report_content.h"
#include "experiments/runner/report_index.h"
#include "experiments/runner/step_shard.h"

namespace lensproof::cli {

namespace {

struct RunOptions {
    CommonOptions common;
    std::string experiment;
    std::string output;
    bool fresh = false;
    bool lists = false;
    bool is_dry = false;
    std::vector<std::string> only;
    std::string against;
    std::string junit;
    std::string shard;
    std::string quality = "full";
    std::string device = "cpu";
};

/// Thrown where a signal asked the run to end.
struct Interrupted {};

/// A new progress bar for every new step. Throws Interrupted once a signal has come.
class StepProgress {
  public:
    StepProgress(bool quiet, const findings::Steps& steps)
        : quiet_(quiet), steps_(steps), start_(std::chrono::steady_clock::now()) {}

    void operator()(const std::string& step, double done) {
        if (Interruption::has_come()) {
            throw Interrupted();
        }
        if (step != step_) {
            bar_.reset();
            step_ = step;
            bar_ = std::make_unique<ProgressBar>(step, quiet_);
        }
        const double all = steps_.all_seconds();
        if (!(all > 0.0)) {
            bar_->update(done);
            return;
        }
        // As much faster or slower than expected as it was so far, once that tells.
        const double finished = steps_.finished_seconds();
        const double elapsed = seconds_since(start_);
        constexpr double kTells = 2.0;  // s
        const double pace = finished > kTells ? elapsed / finished : 1.0;
        const double left = finished > kTells ? pace * (all - finished) : std::max(0.0, all - elapsed);
        bar_->update(done, left, fmt::format("{:.0f} % of all", 100.0 * finished / all));
    }

  private:
    bool quiet_;
    const findings::Steps& steps_;
    std::chrono::steady_clock::time_point start_;
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
        print("  {:13} {:44} {:.4g} ± {:.2g} {} (wanted {})\n", findings::verdict_name(check.verdict()), check.label,
              check.value, check.sigma, check.unit, findings::bound_text(check));
    }
}

/// Writes profiles, pictures, report.json and report.html.
void write_report(const std::filesystem::path& folder, const findings::Findings& found, const Json& report,
                  const std::map<std::string, std::string>& pictures) {
    for (const calibration::Profile& profile : found.profiles) {
        calibration::write_profile(profile, folder / "profiles" / (profile.name + ".json"));
    }
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

/// What a run would do, in place of doing it.
int tell_plan(const RunOptions& options, const runner::Experiment& experiment, const findings::RunSettings& settings) {
    const std::vector<AwaitedStudy> studies = awaited_studies(experiment, settings);
    if (prints_text(options.common)) {
        show(plan_text(studies, options.is_dry));
    }
    write_json_result(options.common, plan_json(studies));
    return kDone;
}

void say_failures(const std::vector<findings::Failure>& failures) {
    for (const findings::Failure& failure : failures) {
        print_message("lensproof: {}: {}\n", failure.study, failure.message);
    }
}

/// The gravest that befell: `status`, a failure of the machine, of the input.
int exit_status(int status, const std::vector<findings::Failure>& failures) {
    for (const findings::Failure& failure : failures) {
        status = std::max(status, static_cast<int>(failure.is_of_input ? kUnusableInput : kInternalFailure));
    }
    return status;
}

/// Thrown where a signal came, by way of what was being done.
std::runtime_error ended_early(const findings::Steps& steps, const std::filesystem::path& kept) {
    return std::runtime_error(fmt::format("ended early, with {} steps finished; the same command goes on from {}",
                                          steps.kept() + steps.made(), kept.string()));
}

/// Does a part of the steps, for a run that finds them kept, and writes no report.
int run_shard(const RunOptions& options, const runner::Experiment& experiment, const findings::RunSettings& settings,
              const std::filesystem::path& kept) {
    const Shard shard = read_shard(options.shard);
    check_output_name(kept / "step");
    check_json_name(options.common);
    runner::StepShard done;
    try {
        const Interruption interruption;
        StepProgress progress(options.common.quiet, settings.steps);
        done = runner::carry_out_shard(experiment, shard.index, shard.count, settings, std::ref(progress));
    } catch (const Interrupted&) {
        throw ended_early(settings.steps, kept);
    }
    say_failures(done.failures);
    if (prints_text(options.common)) {
        print("share {} of the steps: {} done, {} kept before, in {}\n", options.shard, settings.steps.made(),
              settings.steps.kept(), kept.string());
    }
    if (!done.left.empty() && !options.common.quiet) {
        show_message(
            fmt::format("lensproof: left to the run that writes the report, which finds their steps as it goes: {}\n",
                        fmt::join(done.left, ", ")));
    }
    Json failures = Json::list();
    for (const findings::Failure& failure : done.failures) {
        failures.push_back({{"step", failure.study}, {"message", failure.message}});
    }
    write_json_result(options.common, {{"share", options.shard},
                                       {"steps", done.steps},
                                       {"made", settings.steps.made()},
                                       {"failures", std::move(failures)},
                                       {"left", done.left}});
    return exit_status(kDone, done.failures);
}

/// The page of the reports that lie beside this one: of the usual folder, or where there is one already.
void refresh_index(const RunOptions& options, const std::filesystem::path& folder) {
    const std::filesystem::path around =
        folder.has_filename() ? folder.parent_path() : folder.parent_path().parent_path();
    const bool is_ours = runner::has_index(around);
    if (is_ours || (options.output.empty() && !std::filesystem::exists(around / "index.html"))) {
        write_file(around / "index.html", runner::index_html(around));
    }
}

int run(const RunOptions& options) {
    const runner::Experiment experiment = runner::with_only(runner::read_experiment(options.experiment), options.only);
    const std::filesystem::path folder =
        options.output.empty() ? std::filesystem::path("output") / std::filesystem::path(options.experiment).stem()
                               : std::filesystem::path(options.output);
    const std::filesystem::path kept = folder / "steps";
    const findings::RunSettings settings{
        .seed = options.common.seed,
        .quality = options.quality == "draft" ? findings::Quality::draft : findings::Quality::full,
        .threads = options.common.threads,
        .cache = Cache::standard(),
        .device = shared_device(options.device, OnRefusal::go_on),
        .steps = runner::steps_kept_in(kept, options.fresh)};
    if (options.lists || options.is_dry) {
        return tell_plan(options, experiment, settings);
    }
    if (!options.shard.empty()) {
        return run_shard(options, experiment, settings, kept);
    }
    const std::optional<runner::EarlierReport> earlier =
        options.against.empty() ? std::nullopt : std::optional(runner::read_earlier_report(options.against));
    if (!options.junit.empty()) {
        check_output_name(options.junit);
    }
    // A folder that cannot be made is better known before the long part than after it.
    check_output_name(folder / "report.html");
    check_output_name(folder / "report.json");
    check_json_name(options.common);
    findings::Findings found;
    try {
        const Interruption interruption;
        runner::expect_steps(experiment, settings);
        StepProgress progress(options.common.quiet, settings.steps);
        found = runner::run_experiment(experiment, settings, std::ref(progress));
    } catch (const Interrupted&) {
        throw ended_early(settings.steps, kept);
    }
    say_what_was_kept(options, settings.steps, kept);
    Json report = runner::report_json(experiment, found, settings);
    const std::map<std::string, std::string> pictures = runner::report_pictures(found);
    if (earlier) {
        report["against"] = runner::compared_with(*earlier, report, pictures);
    }
    const Delivery delivery = write_somewhere(
        {folder}, [&](const std::filesystem::path& place) { write_report(place, found, report, pictures); });
    if (!options.junit.empty()) {
        write_file(options.junit, runner::junit_xml(experiment.title, found));
    }
    refresh_index(options, folder);
    say_failures(found.failures);
    if (prints_text(options.common)) {
        print_checks(found.checks);
        show(earlier ? runner::against_text(report["against"]) : "");
        print("{}: {}\n", findings::verdict_name(findings::overall(found)), (delivery.place / "report.html").string());
    }
    write_json_result(options.common, report);
    check_place(delivery);
    const bool holds = findings::overall(found.checks) == findings::Verdict::pass;
    return exit_status(holds ? kDone : kCheckFailed, found.failures);
}

}  // namespace

int run_experiment_file(const std::string& experiment, const std::string& folder, const CommonOptions& common) {
    RunOptions options;
    options.common = common;
    options.experiment = experiment;
    options.output = folder;
    return run(options);
}

void add_run_command(Program& program) {
    const auto options = std::make_shared<RunOptions>();
    Command command = program.add_command("run", "Run an experiment end to end and write its report");
    command.footer("Example: lensproof run experiments/first_light.toml -o output/first_light");
    command.add_option("EXPERIMENT", options->experiment, "An experiment file").required();
    command.add_option("-o,--output", options->output, "Folder to write (default: output/EXPERIMENT)").type_name("DIR");
    command.add_flag("--fresh", options->fresh, "Do every step again, also those that an earlier run has finished");
    command.add_flag("--list", options->lists, "Name its studies and their steps, and do nothing");
    command.add_flag("--dry-run", options->is_dry,
                     "Say which steps are kept, which would be done and how long they take, and do nothing");
    command.add_option("--only", options->only, "Studies to carry out, by name (default: all)").type_name("NAME…");
    command
        .add_option(
            "--quality", options->quality,
            "draft: pictures of scenes have half the width and height, and a sixteenth of the samples of a pixel")
        .check(one_of({"draft", "full"}))
        .shows_default();
    Option against = command.add_option(
        "--against", options->against,
        "An earlier report (its folder, or report.json): what changed since, verdict by verdict, number by number and "
        "picture by picture");
    against.type_name("OLD");
    Option junit = command.add_option("--junit", options->junit, "Write the checks as JUnit's XML too");
    junit.type_name("FILE");
    command
        .add_option("--shard", options->shard,
                    "Do the i-th of n parts of the steps, for a run that finds them in the folder, and write no report")
        .type_name("i/n")
        .excludes(against)
        .excludes(junit);
    add_device_option(command, options->device);
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
