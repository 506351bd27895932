// calibration/explain/held_out.h — whether a changed lens predicts points that it was not fitted to.
#pragma once
#include <optional>

#include "calibration/explain/lens_fit.h"

namespace lensproof::calibration {

/// Halves of the data, one fitted, the other predicted: mean squared residual of a coordinate, in its variance.
struct HeldOut {
    double prescribed = 0.0;
    double changed = 0.0;
    double significance = 0.0;  // the mean gain of a point over its standard error
};

/// Every other view of four or more, else every other point, is left out of a fit under `belief` that starts at
/// `start`, and of one of the lens as prescribed; then only the charts' poses are fitted to them. Nothing where there
/// are too few.
std::optional<HeldOut> held_out(const ExplainedLens& lens, const SeenPoints& seen, const LensState& start,
                                const Belief& belief);

}  // namespace lensproof::calibration
