// calibration/geometry/handedness.h — directions that were counted the other way round.
#pragma once
#include <vector>

#include "calibration/geometry/bundle.h"

namespace lensproof::calibration {

/// Throws InputError where the views would agree much better with their directions' mirror images: angles that were
/// counted the other way round.
void check_handedness(const std::vector<ChartView>& views, int width_px, int height_px);

}  // namespace lensproof::calibration
