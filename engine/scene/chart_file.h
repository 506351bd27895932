// engine/scene/chart_file.h — charts and their places as files state them.
#pragma once
#include <filesystem>

#include "engine/io/toml.h"
#include "engine/scene/chart.h"
#include "engine/scene/pose.h"

namespace lensproof {

/// Reads a chart's table:
///     kind = "checkerboard"   squares = [10, 7]   square_mm = 30.0
///     kind = "disc-grid"      discs = [9, 6]      pitch_mm = 30.0   diameter_mm = 15.0
///     kind = "flat-field"
///     white_reflectance = 0.9   black_reflectance = 0.04     (optional)
/// Throws InputError naming file, line and key.
Chart read_chart(TomlTable& table);

/// The [chart] table of a TOML file: a chart's own, a photo set's manifest and a scene file all serve.
Chart read_chart_file(const std::filesystem::path& file);

/// Reads where a chart stands:
///     distance_mm = 5000.0   towards_deg = [right, down]   tilt_deg = [about x, about y, about z]
Placement read_placement(TomlTable& table);

}  // namespace lensproof
