// calibration/lines/line_consensus.h — which lines agree on one lens.
#pragma once
#include <optional>
#include <vector>

#include "calibration/lines/plumb_fit.h"

namespace lensproof::calibration {

/// The lines of one lens, and the fit of them.
struct LineConsensus {
    PlumbFit fit;
    std::vector<bool> used;
    double straight_length = 0.0;  // half diagonals; a line counts the less, the farther it is from straight
};

/// Starts from the one-term lens that leaves most of the length straight within `tolerance` (half diagonals), whatever
/// the rest does; then fits with `terms` terms, leaving out lines whose rms is beyond three times the median's, or
/// whose bow is beyond five times the median's and four times what its points' noise makes, until none comes or goes.
/// None where fewer than `fewest` lines are left.
std::optional<LineConsensus> line_consensus(const std::vector<PlumbLine>& lines, PlumbKind kind, int terms,
                                            double tolerance, int fewest);

/// Those lines of which `used` is true.
std::vector<PlumbLine> those_used(const std::vector<PlumbLine>& lines, const std::vector<bool>& used);

/// The length that is straight under a model, as above.
double straight_length(const std::vector<PlumbLine>& lines, const PlumbModel& model, double tolerance);

}  // namespace lensproof::calibration
