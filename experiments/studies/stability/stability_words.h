// experiments/studies/stability/stability_words.h — what a sweep found, in words and in a chart, for a reader.
#pragma once
#include <string>
#include <vector>

#include "experiments/findings/findings.h"
#include "experiments/studies/stability/measure_stability.h"

namespace lensproof::studies {

inline constexpr int kStabilityChartWidth = 760;
inline constexpr int kStabilityChartHeight = 430;

/// "1e-9 mm", "∞", "90°".
std::string value_text(double value, const std::string& unit);

/// "up to 3.2e-14 mm", and where the error is over `limit_mm`, the part of the sweep.
std::string trouble_text(const StabilitySweep& sweep, std::size_t type, double limit_mm);

/// What the double tracer does along the sweep: a fact for each run of values with the same statuses or the same
/// refusal.
std::vector<findings::Fact> what_happens(const StabilitySweep& sweep);

}  // namespace lensproof::studies
