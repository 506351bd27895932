// calibration/measure/find_directions.h — the lights of known directions in a picture.
#pragma once
#include <string>
#include <vector>

#include "calibration/detection/star_place.h"
#include "calibration/measure/known_directions.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

struct SeenDirection {
    Vec3d direction;
    StarPlace place;
};

struct SeenDirections {
    std::vector<SeenDirection> seen;
    int placed = 0;  // those with a place
    int dark = 0;    // of them, without light there
    int unseen = 0;  // without a place, and should be in the picture
};

/// Those with a place are looked for there. By four of them and more a fisheye's model is fitted, the others are looked
/// for where it images them and is sure of that to a few pixels, from those nearby outwards, and the model is fitted
/// again, as long as there are more.
SeenDirections find_directions(const formats::Image& image, int channel, const std::vector<KnownDirection>& known);

/// What is missing of them, in words; empty where nothing is.
std::string in_words(const SeenDirections& directions);

}  // namespace lensproof::calibration
