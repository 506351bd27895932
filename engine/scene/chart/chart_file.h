// engine/scene/chart/chart_file.h — charts and their places as files state them.
#pragma once
#include <filesystem>

#include "engine/base/toml.h"
#include "engine/scene/chart/chart.h"
#include "engine/scene/chart/pose.h"

namespace lensproof::scene {

/// Reads a chart's table: its `kind`, what keys that has (each kind's `visit_keys`, and engine/scene/README.md), and
/// if need be
///     white_reflectance = 0.9   black_reflectance = 0.04
/// Throws InputError naming file, line and key, also where discs, markers, squares, dots or lines do not fit into their
/// pitch.
Chart read_chart(TomlTable& table);

/// The [chart] table of a TOML file: a chart's own, a photo set's manifest and a scene file all serve.
Chart read_chart_file(const std::filesystem::path& file);

/// Reads where a chart stands:
///     distance_mm = 5000.0   towards_deg = [right, down]   tilt_deg = [about x, about y, about z]
Placement read_placement(TomlTable& table);

}  // namespace lensproof::scene
