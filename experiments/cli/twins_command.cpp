// experiments/cli/twins_command.cpp — `lensproof twins PHOTOS… --chart CHART --lens LENS`: photos of a chart beside
// what the lens makes of it, without an experiment's file: it writes one, and runs it.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>

#include "calibration/explain/lens_change.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/toml_text.h"
#include "engine/base/write_file.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/spectral/sensor_response.h"
#include "experiments/cli/measure_parts.h"
#include "experiments/cli/run_parts.h"

namespace lensproof::cli {

namespace {

namespace fs = std::filesystem;

struct TwinsOptions {
    CommonOptions common;
    std::vector<std::string> photos;
    std::string chart;
    std::string lens;
    std::string camera = calibration::kUnknown;
    double pixel_pitch_um = 0.0;
    double f_number = 0.0;
    double focus_distance_mm = 0.0;
    std::vector<std::string> fit;
    std::string response = "camera";
    double limit_px = 0.0;
    std::string output = "output/twins";
};

/// The file as one in the folder names it.
std::string seen_from(const fs::path& folder, const fs::path& file) {
    return fs::proximate(fs::absolute(file), fs::absolute(folder)).generic_string();
}

std::string manifest_text(const TwinsOptions& options, const fs::path& folder, const std::vector<fs::path>& photos) {
    std::vector<std::string> names;
    std::ranges::transform(photos, std::back_inserter(names),
                           [&](const fs::path& photo) { return seen_from(folder, photo); });
    std::string text = fmt::format(
        "name = \"Photos\"\ncamera = {}\nlicence = \"not stated\"\nsource = \"given to the command twins\"\nchart = "
        "{}\n"
        "photos = {}\n",
        toml_string(options.camera), toml_string(seen_from(folder, options.chart)), toml_strings(names));
    if (options.pixel_pitch_um > 0.0) {
        text += fmt::format("pixel_pitch_um = {}\n", options.pixel_pitch_um);
    }
    return text;
}

std::string experiment_text(const TwinsOptions& options, const fs::path& folder) {
    // A name of one that ships, or a file.
    const std::string lens = is_there(options.lens) ? seen_from(folder, options.lens) : options.lens;
    std::string text = fmt::format(
        "title = \"Photos and their twins\"\n"
        "summary = \"Each photo of a chart is rendered again through a prescription, from the place where the camera "
        "stood. What remains between the two is lens, chart, sensor or noise.\"\n\n"
        "[[photos]]\nname = \"photos\"\nmanifest = \"photos.toml\"\n\n"
        "[[twins]]\nname = \"twins\"\nphotos = \"photos\"\nlens = {}\nresponse = {}\n",
        toml_string(lens), toml_string(options.response));
    const auto add = [&](const char* key, double value) {
        if (value > 0.0) {
            text += fmt::format("{} = {}\n", key, value);
        }
    };
    add("f_number", options.f_number);
    add("focus_distance_mm", options.focus_distance_mm);
    add("limit_px", options.limit_px);
    if (!options.fit.empty()) {
        text += fmt::format("fit = {}\n", toml_strings(options.fit));
    }
    return text;
}

int run_twins(const TwinsOptions& options) {
    const fs::path folder = options.output;
    const std::vector<fs::path> photos = pictures_named(options.photos);
    if (photos.empty()) {
        throw InputError(fmt::format("{}: holds no pictures", options.photos.front()));
    }
    chart_to_find(options.chart);  // before anything is written
    formats::load_lens(options.lens);
    check_output_name(folder / "twins.toml");
    write_file(folder / "photos.toml", manifest_text(options, folder, photos));
    write_file(folder / "twins.toml", experiment_text(options, folder));
    return run_experiment_file((folder / "twins.toml").string(), options.output, options.common);
}

}  // namespace

void add_twins_command(Program& program) {
    const auto options = std::make_shared<TwinsOptions>();
    Command command = program.add_command("twins", "Set photos of a chart beside what a lens makes of it");
    command.footer("Example: lensproof twins photos/ --chart chart.toml --lens nikkor-50 -o output/twins");
    command.add_option("PHOTO", options->photos, "Photos of the chart, or folders of them").required();
    command.add_option("--chart", options->chart, "The chart in them").required().type_name("FILE");
    command.add_option("--lens", options->lens, "The prescription: a name, or a file").required();
    command.add_option("--camera", options->camera, "Which camera took them").shows_default();
    command.add_option("--pixel-pitch", options->pixel_pitch_um, "Of the sensor, where the photos do not say it")
        .type_name("UM")
        .check(kPositiveOption);
    command.add_option("--f-number", options->f_number, "Where the photos do not say it").check(kPositiveOption);
    command.add_option("--focus-distance", options->focus_distance_mm, "From the first vertex (default: the charts')")
        .type_name("MM")
        .check(kPositiveOption);
    command.add_option("--fit", options->fit, "What may be otherwise in the lens, as `fit --free`")
        .type_name("KIND…")
        .check(one_of({calibration::kFreeKinds.begin(), calibration::kFreeKinds.end()}));
    command.add_option("--response", options->response, "Of the sensor")
        .check(one_of(spectral::known_sensors()))
        .shows_default();
    command.add_option("--limit", options->limit_px, "Of the lens's share (default: 0.1 % of the half-diagonal)")
        .type_name("PX")
        .check(kPositiveOption);
    command
        .add_option("-o,--output", options->output,
                    "Folder to write: the report, and the experiment that made it (photos.toml, twins.toml)")
        .type_name("DIR")
        .shows_default();
    add_common_options(command, options->common);
    command.runs([options] { return run_twins(*options); });
}

}  // namespace lensproof::cli
