// experiments/runner/report_content.h — an experiment's result as the report's JSON, in the schema of
// experiments/draw/report/report.h.
#pragma once
#include <map>
#include <string>

#include "engine/base/json.h"
#include "experiments/runner/run_experiment.h"

namespace lensproof::runner {

Json check_json(const Check& check);

/// Program, version, commit, settings, and the inputs with their hashes.
Json provenance_json(std::vector<std::filesystem::path> inputs, const RunSettings& settings);

Json report_json(const Experiment& experiment, const ExperimentResult& result, const RunSettings& settings);

/// The pictures' bytes by the names that the JSON uses.
std::map<std::string, std::string> report_pictures(const ExperimentResult& result);

}  // namespace lensproof::runner
