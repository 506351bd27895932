// calibration/self_test/self_test.h — what a measurement would get wrong by itself: its floor.
#pragma once
#include "calibration/measure/measure.h"

namespace lensproof::calibration {

/// Simulates and measures the pictures that `profile`, measured from `input`, used; of the views of more than six
/// charts every second one, at least six, and of pictures of more than six megapixels fewer, at least three: what fewer
/// views leave open counts as the method's. Its views have to know their traits (calibration/picture/picture_traits.h).
/// Throws InputError where the simulated pictures cannot be measured.
SelfTest self_test(const MeasureInput& input, const Profile& profile);

/// Puts the self-test into the profile that was measured from `input`, which takes at most about as long again; where
/// there can be none, the reason into its `not_measured`.
void add_self_test(Profile& profile, const MeasureInput& input);

}  // namespace lensproof::calibration
