#include "experiments/studies/cameras/photo_set.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/scene/chart/chart_file.h"

namespace lensproof::studies {

namespace fs = std::filesystem;

namespace {

/// The first folder that holds every file.
fs::path find_folder(const TomlTable& manifest, const std::vector<std::string>& folders,
                     const std::vector<std::string>& files, const std::string& source) {
    std::vector<std::string> missing;
    for (const std::string& folder : folders) {
        fs::path path = referred_file(manifest.file(), folder);
        const auto absent = std::ranges::find_if(files, [&](const std::string& file) {
            std::error_code error;  // a name that is too long is a file that is not there
            return !fs::exists(path / file, error);
        });
        if (absent == files.end()) {
            return path;
        }
        missing.push_back((path / *absent).string());
    }
    manifest.fail("photos", fmt::format("not found: {}. They come from: {}", fmt::join(missing, ", "), source));
}

}  // namespace

PhotoSet read_photo_set(const fs::path& manifest) {
    TomlTable top = TomlTable::read(manifest);
    PhotoSet set;
    set.name = top.text("name");
    set.camera = top.text_or("camera", "unknown");
    set.lens = top.text_or("lens", "unknown");
    set.licence = top.text("licence");
    set.source = top.text("source");
    set.pixel_pitch_um = top.optional_number("pixel_pitch_um", kPositive);
    if (top.is_text("chart")) {
        set.chart = scene::read_chart_file(referred_file(manifest, top.text("chart")));
    } else {
        TomlTable chart = top.table("chart");
        set.chart = scene::read_chart(chart);
    }
    const std::vector<std::string> photos = top.texts("photos");
    const std::vector<std::string> flat_fields =
        top.has("flat_fields") ? top.texts("flat_fields") : std::vector<std::string>{};
    const std::vector<std::string> folders = top.has("folders") ? top.texts("folders") : std::vector<std::string>{"."};
    if (top.has("focus_positions_mm")) {
        set.focus_positions_mm = top.numbers("focus_positions_mm", photos.size());
    }
    top.finish();
    if (photos.empty()) {
        top.fail("photos", "names no photo");
    }
    if (folders.empty()) {
        top.fail("folders", "names no folder");
    }
    std::vector<std::string> all = photos;
    all.insert(all.end(), flat_fields.begin(), flat_fields.end());
    const fs::path folder = find_folder(top, folders, all, set.source);
    for (const std::string& photo : photos) {
        set.photos.push_back(folder / photo);
    }
    for (const std::string& flat_field : flat_fields) {
        set.flat_fields.push_back(folder / flat_field);
    }
    return set;
}

}  // namespace lensproof::studies
