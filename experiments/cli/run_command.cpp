// experiments/cli/run_command.cpp — `lensproof run EXPERIMENT`: end to end, to a report.
#include <fmt/format.h>

#include <memory>

#include "engine/base/cache.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "experiments/cli/command.h"
#include "experiments/cli/progress.h"
#include "experiments/draw/report/report.h"
#include "experiments/runner/report_content.h"
#include "experiments/studies/measurement_floor/floor_report.h"
#include "experiments/studies/pupil_passage/passage_report.h"
#include "experiments/studies/stability/stability_report.h"

namespace lensproof::cli {

namespace {

struct RunOptions {
    CommonOptions common;
    std::string experiment;
    std::string output;
};

/// A new progress bar for every new step.
class StepProgress {
  public:
    explicit StepProgress(bool quiet) : quiet_(quiet) {}

    void operator()(const std::string& step, double done) {
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

void print_checks(const std::vector<runner::Check>& checks) {
    std::string group;
    for (const runner::Check& check : checks) {
        if (check.group != group) {
            group = check.group;
            fmt::print("{}\n", group);
        }
        const std::string bound =
            check.expectation == runner::Expectation::within    ? fmt::format("{:g} ± {:g}", check.target, check.limit)
            : check.expectation == runner::Expectation::differs ? fmt::format("> {:g}", check.limit)
                                                                : fmt::format("≤ {:g}", check.limit);
        fmt::print("  {:13} {:44} {:.4g} ± {:.2g} {} (wanted {})\n", runner::verdict_name(check.verdict()), check.label,
                   check.value, check.sigma, check.unit, bound);
    }
}

/// Writes report.json and report.html, prints the checks, and says how it went.
int finish_report(const RunOptions& options, const std::filesystem::path& folder,
                  const std::vector<runner::Check>& checks, const Json& report,
                  const std::map<std::string, std::string>& pictures) {
    for (const auto& [name, bytes] : pictures) {
        write_file(folder / "images" / name, bytes);
    }
    write_file(folder / "report.json", report.dump(2) + "\n");
    write_file(folder / "report.html", draw::report_html(report, pictures));

    write_json_result(options.common, report);
    if (prints_text(options.common)) {
        print_checks(checks);
        fmt::print("{}: {}\n", runner::verdict_name(runner::overall(checks)), (folder / "report.html").string());
    }
    return runner::overall(checks) == runner::Verdict::pass ? kDone : kCheckFailed;
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
    const runner::RunSettings settings{
        .seed = options.common.seed, .threads = options.common.threads, .cache = Cache::standard()};
    const auto progress = std::make_shared<StepProgress>(options.common.quiet);
    const runner::RunProgress report_progress = [progress](const std::string& step, double done) {
        (*progress)(step, done);
    };
    if (experiment.stability) {
        const std::vector<studies::StabilitySweep> sweeps =
            studies::run_stability(experiment, settings, report_progress);
        return finish_report(options, folder, studies::stability_checks(sweeps),
                             studies::stability_report_json(experiment, sweeps, settings),
                             studies::stability_charts(sweeps));
    }
    if (!experiment.pupil_passage.empty()) {
        const std::vector<studies::Passage> passages =
            studies::run_pupil_passage(experiment, settings, report_progress);
        return finish_report(options, folder, studies::passage_checks(passages),
                             studies::passage_report_json(experiment, passages, settings),
                             studies::passage_drawings(passages));
    }
    if (experiment.measurement_floor) {
        const studies::MeasurementFloor floor = studies::run_measurement_floor(experiment, settings, report_progress);
        return finish_report(options, folder, floor.checks, studies::floor_report_json(experiment, floor, settings),
                             studies::floor_charts(floor));
    }
    const runner::ExperimentResult result = runner::run_experiment(experiment, settings, report_progress);
    for (const runner::Subject& subject : result.subjects) {
        calibration::write_profile(subject.profile, folder / "profiles" / (subject.name + ".json"));
    }
    return finish_report(options, folder, result.checks, runner::report_json(experiment, result, settings),
                         runner::report_pictures(result));
}

}  // namespace

void add_run_command(Program& program) {
    const auto options = std::make_shared<RunOptions>();
    Command command = program.add_command("run", "Run an experiment end to end and write its report");
    command.footer("Example: lensproof run experiments/first_light.toml -o output/first_light");
    command.add_option("EXPERIMENT", options->experiment, "An experiment file").required();
    command.add_option("-o,--output", options->output, "Folder to write (default: output/EXPERIMENT)").type_name("DIR");
    add_common_options(command, options->common);
    command.runs([options] { return run(*options); });
}

}  // namespace lensproof::cli
