// calibration/comparison/radial_difference.h — two pictures' brightness and colour over the image height.
#pragma once
#include <map>
#include <string>

#include "calibration/comparison/overlap.h"
#include "calibration/statistics/curve.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// Curves over the distance from the frame's middle in half-diagonals, in twenty rings: of the second picture against
/// the first, in linear light,
///
/// - `brightness_ev`: lg2 of the ratio of their mean luminances;
/// - `red_over_green_ev`, `blue_over_green_ev`: lg2 of the ratio of that colour's mean over green's, where there are
///   colours;
/// - `ciede2000`: the mean of `colour_difference`.
///
/// The 95 % bands are of the jackknife over 16 sectors of each ring, so that a scene whose one side differs says so.
/// Rings with light in fewer than four sectors have no sample.
std::map<std::string, Curve> radial_differences(const formats::Image& a, const formats::Image& b,
                                                const formats::Image& colour_difference, const Overlap& overlap);

}  // namespace lensproof::calibration
