// experiments/studies/stability/stability_study.h — [stability]: the tracer's number types at the extremes, as
// findings.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "experiments/findings/study.h"
#include "experiments/studies/stability/measure_stability.h"

namespace lensproof::studies {

/// `extremes`: ids of those wanted; all, where the key is missing. `name` where a file has several such tables. They
/// run one after the other on one thread each.
std::vector<findings::Study> read_stability(findings::ExperimentFile& file);

/// One check for each extreme: a double's error as a fraction of its bound. Then those on all rays together: the right
/// status, finite numbers, packets that have the scalar's bits.
std::vector<findings::Check> stability_checks(const std::vector<StabilitySweep>& sweeps);

/// The chart of a sweep: error against the extreme's number, a curve a number type, and the conditioning. SVG.
std::string stability_chart(const StabilitySweep& sweep);

/// Where a number type's errors are larger than `limit_mm`: the values at the ends of that part of the sweep.
struct Onset {
    double limit_mm = 0.0;
    double from = 0.0;
    double to = 0.0;
    double largest_mm = 0.0;
    bool is_conditioning = false;  // of a double: no error was over ten times what rounding the input does
};

/// Nothing where every error stays below the type's limit: 1e-9 mm for double and long double, 1e-3 mm, a tenth of a
/// pixel's order, for floats.
std::optional<Onset> onset_of_trouble(const StabilitySweep& sweep, std::size_t type);

/// Each extreme a subject, with a table "extremes":
///     [{"id", "title", "setting", "parameter", "unit",
///       "onset": {type: null or {"limit_mm", "from", "to", "largest_mm"}},
///       "points": [{"value", "rays", "statuses": {name: count}, "at_a_change", "conditioning_mm", "excess",
///                   "types": {type: {"error_mm", "other_statuses", "close_calls", "not_finite"}}}
///                  or {"value", "refusal"}]}]
/// A value that is infinite is the text "inf" or "-inf".
findings::Findings stability_findings(const std::vector<StabilitySweep>& sweeps);

}  // namespace lensproof::studies
