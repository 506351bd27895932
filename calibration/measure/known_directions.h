// calibration/measure/known_directions.h — what is seen where in a picture, in directions that are known: stars.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/vec.h"

namespace lensproof::calibration {

/// Something infinitely far away.
struct KnownDirection {
    std::optional<Vec2d> near_px;  // about where its light is in the picture; none: by the others
    Vec3d direction;               // unit vector, in a right-handed frame that all of the picture's share
};

/// How far its light may be from `near_px`, px.
inline constexpr double kDirectionReach_px = 8.0;
inline constexpr std::size_t kMostDirections = 100000;  // in all pictures together

/// By picture.
using KnownDirections = std::map<std::string, std::vector<KnownDirection>>;

/// Reads a CSV table with a row for each direction in each picture: x_px, y_px, and one of
///     right_ascension_deg, declination_deg   (of the sky: longitude to the east, latitude to the north)
///     azimuth_deg, altitude_deg              (from north by east, upwards; as a compass and surveyors have it)
///     dx, dy, dz                             (of any length but 0, in any right-handed frame)
/// and `picture`, the file's name without folders, which a single picture does not need; a column `name` is not looked
/// at. x_px and y_px may both be empty, and so may `picture` then: a catalogue's, for every picture. `pictures`: the
/// names that there are. Throws InputError naming file, line and column, also for a picture that is not among them.
KnownDirections read_known_directions(const std::filesystem::path& file, const std::vector<std::string>& pictures);

}  // namespace lensproof::calibration
