// experiments/studies/cameras/photo_set.h — a set of photos as its manifest describes it.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/chart/chart.h"

namespace lensproof::studies {

struct PhotoSet {
    std::string name;
    std::string camera;
    std::string lens;
    std::string licence;
    std::string source;
    std::optional<double> pixel_pitch_um;
    scene::Chart chart;
    std::vector<std::filesystem::path> photos;
    std::vector<std::filesystem::path> flat_fields;
    std::vector<double> focus_positions_mm;  // where the focus stood in each photo; empty: all at one place
};

/// Reads a manifest (described in reference_photos/README.md). Photos are looked for in the first of its folders that
/// holds them all; folders are relative to the manifest. Throws InputError naming what is missing, and where from it
/// can be had.
PhotoSet read_photo_set(const std::filesystem::path& manifest);

}  // namespace lensproof::studies
