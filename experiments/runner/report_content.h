// experiments/runner/report_content.h — an experiment's findings as the report's JSON, in the schema of
// experiments/draw/report/report.h, and as its pictures.
#pragma once
#include <map>
#include <string>

#include "engine/base/json.h"
#include "experiments/runner/experiment.h"

namespace lensproof::runner {

/// What a report says beside its findings.
struct ReportHead {
    std::string title;
    std::string summary;
    Json settings;          // of its provenance
    std::string reproduce;  // the command
};

/// With program, version, commit, settings, and the inputs with their hashes. A study's tables stand under keys of
/// their own.
Json report_json(const ReportHead& head, const findings::Findings& found);
Json report_json(const Experiment& experiment, const findings::Findings& found, const findings::RunSettings& settings);

/// The pictures' bytes by the names that the JSON uses. Maps of one quantity have one range of colours.
std::map<std::string, std::string> report_pictures(const findings::Findings& found);

}  // namespace lensproof::runner
