// experiments/studies/measurement_floor/floor_point.h — trials of one setting as a point of a sweep.
#pragma once
#include <string>
#include <vector>

#include "experiments/studies/measurement_floor/measure_floor.h"

namespace lensproof::studies {

/// Root mean square of the errors that are numbers, its standard error from their scatter, and how many were numbers:
/// a trial that failed (NaN) is counted, not dropped.
FloorPoint rms_point(double value, const std::vector<double>& errors);

/// "" where all trials gave a number, else " 2 of 6 failed." — to be said wherever the number is.
std::string failed_in_words(const FloorPoint& point);

}  // namespace lensproof::studies
