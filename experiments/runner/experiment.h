// experiments/runner/experiment.h — an experiment: studies of any kind, as a file states them, and what they find.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/findings/study.h"

namespace lensproof::runner {

struct Experiment {
    std::filesystem::path file;
    std::string title;
    std::string summary;
    std::vector<findings::Study> studies;  // in the order of the list in experiment.cpp
};

/// Reads an experiment file (described in experiments/README.md). Throws InputError naming file, line and key.
Experiment read_experiment(const std::filesystem::path& file);

/// Carries the studies out, one after the other.
findings::Findings run_experiment(const Experiment& experiment, const findings::RunSettings& settings,
                                  const findings::RunProgress& progress);

}  // namespace lensproof::runner
