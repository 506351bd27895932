#include "experiments/cli/raw_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>

#include "engine/base/json.h"
#include "engine/base/write_file.h"
#include "engine/render/film/film_image.h"
#include "engine/render/raw/raw_sensor.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

constexpr double kNoticeable = 0.3;  // adds 5 % to the noise

/// The render's seed; 0 where the film does not say.
std::uint64_t seed_of(const render::FilmNotes& notes) {
    std::uint64_t seed = 0;
    for (const auto& [name, value] : notes.identity) {
        if (name == "seed") {
            std::from_chars(value.data(), value.data() + value.size(), seed);
        }
    }
    return seed;
}

/// What the film is wrong by, in electrons, over what the sensor adds: their variances' ratio, the mean over all
/// values.
double noise_ratio(const render::Picture& film, const render::RawSensor& sensor) {
    const double electrons = render::electrons_at_saturation(sensor);
    double sum = 0.0;
    for (int y = 0; y < film.height(); ++y) {
        for (int x = 0; x < film.width(); ++x) {
            const auto [rgb, variance] = film.estimate(x, y);
            const auto add = [&](int channel, double value, double of_film, double neutral) {
                const double scale = neutral * electrons;
                // A pixel without light, dark or read noise has nothing to compare with.
                sum += scale * scale * of_film / std::max(1.0, render::read_electrons(sensor, value, channel).variance);
            };
            add(0, rgb.x, variance.x, sensor.neutral.x);
            add(1, rgb.y, variance.y, sensor.neutral.y);
            add(2, rgb.z, variance.z, sensor.neutral.z);
        }
    }
    return std::sqrt(sum / (static_cast<double>(film.width()) * film.height() * sensor.channels));
}

}  // namespace

RawFiles raw_files(const std::filesystem::path& exr) {
    RawFiles files{.raw = std::filesystem::path(exr).replace_extension(".raw.png"),
                   .demosaiced = std::filesystem::path(exr).replace_extension(".demosaiced.png")};
    check_output_name(files.raw);
    check_output_name(files.demosaiced);
    return files;
}

std::optional<RawFiles> write_raw_files(const render::Picture& film, const render::FilmNotes& notes,
                                        const std::filesystem::path& exr, int threads) {
    const auto sensor = notes.metadata.find(kSensorNote);
    if (sensor == notes.metadata.end() || notes.metadata.contains(kShardNote)) {
        return std::nullopt;
    }
    formats::Image picture = render::film_rgb(film);
    picture.metadata = notes.metadata;
    const render::RawSensor behind = render::parse_raw_sensor(sensor->second, exr);
    const render::RawImage raw = render::expose(behind, picture, seed_of(notes), threads);
    RawFiles files = raw_files(exr);
    render::write_raw(raw, files.raw);
    formats::write_png_16(render::develop(raw), files.demosaiced);
    files.noise_ratio = noise_ratio(film, behind);
    return files;
}

void report_raw_files(const RawFiles& files, Json& json, const CommonOptions& common) {
    json["raw"] = files.raw.string();
    json["demosaiced"] = files.demosaiced.string();
    json["film_noise_over_sensor_noise"] = files.noise_ratio;
    if (prints_text(common)) {
        print("{}\n{}\n", files.raw.string(), files.demosaiced.string());
    }
    if (files.noise_ratio > kNoticeable) {
        print_message(
            "lensproof: the render's own noise is up to {:.2f} times the sensor's: more samples bring it down\n",
            files.noise_ratio);
    }
}

}  // namespace lensproof::cli
