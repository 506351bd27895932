// experiments/studies/sweeps/sweep_study.h — [[sweeps]]: named quantities of lenses over any of their settings, as
// findings.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/findings/study.h"
#include "experiments/studies/sweeps/measure_sweep.h"

namespace lensproof::studies {

/// What all values of a quantity are held to, or those where axes have some values.
struct SweepCheck {
    std::string quantity;
    findings::Bound bound;
    std::map<std::string, std::vector<std::size_t>> where;  // places in axes, by their keys
    std::string where_text;
};

/// One of the tables [[sweeps]] (experiments/README.md).
struct Sweep {
    std::string name;
    std::string title;
    std::vector<findings::Axis> axes;
    std::vector<std::string> quantities;
    std::string over;    // the axis that curves run along
    std::string curves;  // the axis that has a curve of each value; empty: none
    std::vector<SweepCheck> checks;
};

/// Throws InputError naming file, line and key.
Sweep read_sweep(TomlTable& table, findings::ExperimentFile& file);

std::vector<findings::Study> read_sweeps(findings::ExperimentFile& file);

/// Each value by itself, in the order of the axes' combinations, on several threads. Throws InputError where no lens
/// can be set as the sweep asks.
std::vector<SweepValue> measure_sweep(const Sweep& sweep, const findings::RunSettings& settings,
                                      const findings::RunProgress& progress);

/// Each check's worst value: the largest that is to be at most so much, the smallest that is to be at least, the
/// farthest from the middle between two. A value that does not exist leaves it undecided.
std::vector<findings::Check> sweep_checks(const Sweep& sweep, const std::vector<SweepValue>& values);

/// A subject with small multiples of each family of quantities, and the table "swept":
///     [{"name", "over", "curves", "axes": [{"axis", "values"}], "quantities": [...],
///       "values": [{AXIS: value, …, QUANTITY: number or null, …}]}]
findings::Findings sweep_findings(const Sweep& sweep, const std::vector<SweepValue>& values);

}  // namespace lensproof::studies
