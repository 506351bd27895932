// experiments/cli/compare_maps.h — where two pictures differ, as pictures.
#pragma once
#include <string>

#include "calibration/comparison/picture_comparison.h"
#include "engine/base/json.h"

namespace lensproof::cli {

/// Throws InputError where the folder cannot be written to.
void check_maps_folder(const std::string& folder);

/// Writes difference.png (luminance of B less A's, its noise taken out; blue: less, red: more), flip.png and
/// ciede2000.png, pixel for pixel, and returns of each its `file`, `quantity`, and the values at the ends of its
/// colours, `lowest` and `highest`.
Json write_maps(const calibration::PictureComparison& found, const std::string& folder);

}  // namespace lensproof::cli
