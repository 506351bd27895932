// experiments/cli/run_parts.h — what other commands use of `run`.
#pragma once
#include <string>

#include "experiments/cli/command.h"

namespace lensproof::cli {

/// Runs the experiment of a file and writes its report into the folder; returns the exit status.
int run_experiment_file(const std::string& experiment, const std::string& folder, const CommonOptions& common);

}  // namespace lensproof::cli
