// experiments/cli/compare_maps.h — where two pictures differ, as pictures.
#pragma once
#include <string>
#include <vector>

#include "calibration/comparison/picture_comparison.h"
#include "engine/base/json.h"

namespace lensproof::cli {

/// Throws InputError where the folder cannot be written to.
void check_maps_folder(const std::string& folder);

/// In colours, with the values at their ends.
struct DrawnMap {
    std::string quantity;
    double lowest = 0.0;
    double highest = 1.0;
    formats::Image picture;
};

/// "difference" (luminance of B less A's, its noise taken out; blue: less, red: more), "flip" and "ciede2000", as far
/// as there are maps, pixel for pixel.
std::vector<DrawnMap> drawn_maps(const calibration::PictureComparison& found);

/// Writes each as QUANTITY.png, and returns of each its `file`, `quantity`, `lowest` and `highest`.
Json write_maps(const std::vector<DrawnMap>& maps, const std::string& folder);

}  // namespace lensproof::cli
