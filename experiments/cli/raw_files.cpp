#include "experiments/cli/raw_files.h"

#include <charconv>
#include <cstdint>
#include <string>

#include "engine/io/file.h"
#include "engine/render/film_image.h"
#include "engine/render/raw_sensor.h"

namespace lensproof {

namespace {

/// The render's seed; 0 where the film does not say.
std::uint64_t seed_of(const FilmNotes& notes) {
    std::uint64_t seed = 0;
    for (const auto& [name, value] : notes.identity) {
        if (name == "seed") {
            std::from_chars(value.data(), value.data() + value.size(), seed);
        }
    }
    return seed;
}

}  // namespace

RawFiles raw_files(const std::filesystem::path& exr) {
    RawFiles files{.raw = std::filesystem::path(exr).replace_extension(".raw.png"),
                   .demosaiced = std::filesystem::path(exr).replace_extension(".demosaiced.png")};
    check_output_name(files.raw);
    check_output_name(files.demosaiced);
    return files;
}

std::optional<RawFiles> write_raw_files(const Film& film, const FilmNotes& notes, const std::filesystem::path& exr,
                                        int threads) {
    const auto sensor = notes.metadata.find(kSensorNote);
    if (sensor == notes.metadata.end() || notes.metadata.contains(kShardNote)) {
        return std::nullopt;
    }
    Image picture = film_rgb(film);
    picture.metadata = notes.metadata;
    const RawImage raw = expose(parse_raw_sensor(sensor->second, exr), picture, seed_of(notes), threads);
    RawFiles files = raw_files(exr);
    write_raw(raw, files.raw);
    write_png_16(develop(raw), files.demosaiced);
    return files;
}

}  // namespace lensproof
