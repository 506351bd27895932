// experiments/runner/experiment.h — an experiment: studies of any kind, as a file states them, and what they find.
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "experiments/findings/study.h"

namespace lensproof::runner {

/// A chapter of the report: what some of the studies find, with what is to be said of it.
struct StatedChapter {
    std::string title;
    std::string text;
    std::vector<std::string> holds;  // studies' names, in their order there
};

struct Experiment {
    std::filesystem::path file;
    std::string title;
    std::string summary;
    /// In the order of the list in experiment.cpp, each with what its table is called in the file: "[[stray_light]]".
    std::vector<std::pair<std::string, findings::Study>> studies;
    std::vector<StatedChapter> chapters{};
    std::vector<std::string> only{};  // the names that were asked for; empty: all
};

/// Reads an experiment file (described in experiments/README.md). Throws InputError naming file, line and key.
Experiment read_experiment(const std::filesystem::path& file);

/// The experiment with those of its studies that `names` names alone; no name: with all. Throws InputError for a name
/// that none has.
Experiment with_only(Experiment experiment, const std::vector<std::string>& names);

/// Tells the settings' steps what is to come, as far as the studies know it, for the time left.
void expect_steps(const Experiment& experiment, const findings::RunSettings& settings);

/// Carries the studies out, one after the other. One that throws is a failure among the findings, and the others go on;
/// where all of them do, the first one's exception is thrown. What is thrown from `progress` and is no std::exception
/// ends the run.
findings::Findings run_experiment(const Experiment& experiment, const findings::RunSettings& settings,
                                  const findings::RunProgress& progress);

}  // namespace lensproof::runner
