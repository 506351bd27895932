// experiments/cli/raw_files.h — the raw file that stands beside a rendered film.
#pragma once
#include <filesystem>
#include <optional>

#include "engine/base/json.h"
#include "engine/render/film/film_exr.h"
#include "experiments/cli/command.h"

namespace lensproof::cli {

/// The note of a film that says what sensor is behind it (`raw_sensor_text`), and that of one that is a part of a
/// render.
inline constexpr const char* kSensorNote = "lensproof:sensor";
inline constexpr const char* kShardNote = "lensproof:shard";

/// NAME.raw.png, the sensor's values, and NAME.demosaiced.png, its picture; beside NAME.exr. Throws InputError where
/// one cannot be written.
struct RawFiles {
    std::filesystem::path raw;
    std::filesystem::path demosaiced;
    double noise_ratio = 0.0;  // the film's own noise at most, over the sensor's: root mean square over all values
};
RawFiles raw_files(const std::filesystem::path& exr);

/// Writes both for the film whose file is `exr`, with noise by the render's seed, and says where; nothing where its
/// notes name no sensor, or where it is a shard, whose noise says nothing of the whole's.
std::optional<RawFiles> write_raw_files(const render::Picture& film, const render::FilmNotes& notes,
                                        const std::filesystem::path& exr, int threads);

/// Says what was written: keys of a machine-readable result, and where a person reads it.
void report_raw_files(const RawFiles& files, Json& json, const CommonOptions& common);

}  // namespace lensproof::cli
