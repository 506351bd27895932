// engine/scene/chart_file.h — charts and their places as files state them.
#pragma once
#include <filesystem>

#include "engine/base/toml.h"
#include "engine/scene/chart.h"
#include "engine/scene/pose.h"

namespace lensproof::scene {

/// Reads a chart's table:
///     kind = "checkerboard"   squares = [10, 7]   square_mm = 30.0
///     kind = "disc-grid"      discs = [9, 6]      pitch_mm = 30.0   diameter_mm = 15.0
///     kind = "flat-field"
///     kind = "charuco"        squares = [9, 6]    square_mm = 30.0  marker_mm = 22.0    dictionary = "DICT_5X5_50"
///     kind = "siemens-star"   sectors = 144       radius_mm = 100.0
///     kind = "slanted-edges"  squares = [7, 5]    pitch_mm = 60.0   square_mm = 36.0    angle_deg = 5.0 (optional)
///     kind = "point-grid"     points = [21, 15]   pitch_mm = 20.0   dot_mm = 0.2
///     kind = "astigmatism-crosses"  crosses = [11, 7]  pitch_mm = 40.0  length_mm = 24.0  line_mm = 0.5
///     kind = "colour-checker" patch_mm = 40.0     gap_mm = 4.0
///     kind = "straight-lines" lines = [13, 9]     pitch_mm = 20.0   line_mm = 0.5
///     white_reflectance = 0.9   black_reflectance = 0.04     (optional)
/// squares, discs, points, crosses and lines count columns and rows; `chart.h` says what the rest means. Throws
/// InputError naming file, line and key, also where discs, markers, squares, dots or lines do not fit into their pitch.
Chart read_chart(TomlTable& table);

/// The [chart] table of a TOML file: a chart's own, a photo set's manifest and a scene file all serve.
Chart read_chart_file(const std::filesystem::path& file);

/// Reads where a chart stands:
///     distance_mm = 5000.0   towards_deg = [right, down]   tilt_deg = [about x, about y, about z]
Placement read_placement(TomlTable& table);

}  // namespace lensproof::scene
