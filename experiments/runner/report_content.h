// experiments/runner/report_content.h — an experiment's result as the report's JSON, in the schema of
// experiments/draw/report/report.h.
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "experiments/runner/run_experiment.h"

namespace lensproof::runner {

nlohmann::ordered_json check_json(const Check& check);

/// Program, version, commit, settings, and the inputs with their hashes.
nlohmann::ordered_json provenance_json(std::vector<std::filesystem::path> inputs, const RunSettings& settings);

nlohmann::ordered_json report_json(const Experiment& experiment, const ExperimentResult& result,
                                   const RunSettings& settings);

/// The pictures' bytes by the names that the JSON uses.
std::map<std::string, std::string> report_pictures(const ExperimentResult& result);

}  // namespace lensproof::runner
