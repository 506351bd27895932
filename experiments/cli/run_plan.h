// experiments/cli/run_plan.h — what a run would do, before it does it.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/base/json.h"
#include "experiments/runner/experiment.h"

namespace lensproof::cli {

/// A step and whether an earlier run has finished it.
struct AwaitedStep {
    std::string label;
    bool is_kept = false;
    double seconds = 0.0;  // that it is expected to take; 0 where it is kept
};

struct AwaitedStudy {
    std::string name;
    std::string table;  // "[[stray_light]]"
    /// None: it finds its steps as it goes.
    std::optional<std::vector<AwaitedStep>> steps{};
};

std::vector<AwaitedStudy> awaited_studies(const runner::Experiment& experiment, const findings::RunSettings& settings);

/// Names alone; or what is kept, what is to be done, and the time that it is expected to take.
std::string plan_text(const std::vector<AwaitedStudy>& studies, bool has_times);

/// {"studies": [{"name", "table", "steps": [{"step", "kept", "seconds"}] or null}], "steps", "kept", "seconds"}
Json plan_json(const std::vector<AwaitedStudy>& studies);

}  // namespace lensproof::cli
