// calibration/light/light_gradient.h — how evenly a chart was lit.
#pragma once
#include <optional>

#include "calibration/light/light_samples.h"
#include "calibration/statistics/curve.h"

namespace lensproof::calibration {

/// Gradient of ln(light) over a chart, per mm along its axes: least squares of ln(value / V) = a + b · chart_mm over
/// one view's white, V being the vignetting of the same channel (`calibration/light/vignetting.h`, a curve over the
/// image height). None for fewer than 6 samples inside the curve, or where they lie on a line.
std::optional<Vec2d> light_gradient_per_mm(const LightGroup& white, const Curve& vignetting, const Vec2d& centre_px,
                                           double half_diagonal_px);

}  // namespace lensproof::calibration
