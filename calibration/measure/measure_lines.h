// calibration/measure/measure_lines.h — from straight lines of a scene to a profile's distortion.
#pragma once
#include "calibration/measure/observe.h"

namespace lensproof::calibration {

/// Adds the lines, the terms and the curves, and in `warnings` what such a measurement rests on. Returns the optical
/// centre, px. Throws InputError where the lines do not tell (calibration/lines/line_distortion.h).
Vec2d measure_lines(Profile& profile, const Observations& seen);

}  // namespace lensproof::calibration
