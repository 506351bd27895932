// calibration/explain/causes.h — a single thing that may be wrong with a lens, and whether it is.
#pragma once
#include <string>
#include <vector>

#include "calibration/explain/lens_fit.h"

namespace lensproof::calibration {

/// One thing far outside its tolerance, all else within: a belief under which it may be.
struct Cause {
    std::string what;          // "the glass behind surface 3"
    std::vector<int> changes;  // those that it is about
    Belief belief;
};

/// A cause with the fit under its belief.
struct FittedCause {
    Cause cause;
    LensFit fit;
};

/// The causes under which the data are more likely than under tolerances alone, the likeliest first: each focus, gap,
/// group's decentre or tilt, the sensor's tilt, each glass, tried to first order about `usual`; and, where that is
/// strained, two gaps of air exchanged. The best are fitted.
std::vector<FittedCause> likely_causes(const ExplainedLens& lens, const SeenPoints& seen, const LensFit& usual);

}  // namespace lensproof::calibration
