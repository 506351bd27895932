// experiments/cli/measure_command.cpp — `lensproof measure IMAGE… --chart CHART`: from pictures to a profile.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "calibration/detect.h"
#include "calibration/measure.h"
#include "calibration/photo_survey.h"
#include "engine/io/file.h"
#include "engine/io/input_error.h"
#include "engine/scene/chart_file.h"
#include "experiments/cli/command.h"

namespace lensproof {

namespace {

constexpr const char* kUnknown = "unknown";

struct MeasureOptions {
    CommonOptions common;
    std::vector<std::string> images;
    std::vector<std::string> flat_fields;
    std::string chart;
    std::string model;
    std::string output;
    std::string lens = kUnknown;
    std::string camera = kUnknown;
    std::string kind = "photo";
    std::string transfer;
    double pixel_pitch_um = 0.0;
    bool no_self_test = false;
};

std::optional<ModelKind> model_kind(const std::string& name) {
    if (name.empty()) {
        return std::nullopt;
    }
    return name == "brown-conrady" ? ModelKind::brown_conrady : ModelKind::kannala_brandt;
}

void print_curve(const Profile& profile, const std::string& name, const char* label, const char* unit) {
    const auto found = profile.curves.find(name);
    if (found == profile.curves.end()) {
        return;
    }
    const Curve& curve = found->second;
    const std::optional<Banded> end = sample(curve, curve.covered_image_height);
    if (end) {
        fmt::print("{:22} {:9.4f} ± {:.4f} {} at image height {:.2f}\n", label, end->value,
                   (end->upper_95 - end->lower_95) / (2.0 * k95), unit, curve.covered_image_height);
    }
}

/// A line for each picture: used or left out, and why.
void print_account(const Profile& profile) {
    const auto used = std::ranges::count_if(profile.pictures, [](const PictureAccount& p) { return p.used; });
    fmt::print("{} of {} pictures used\n", used, profile.pictures.size());
    std::size_t widest = 0;
    for (const PictureAccount& picture : profile.pictures) {
        widest = std::max(widest, picture.image.size());
    }
    for (const PictureAccount& picture : profile.pictures) {
        const std::string held = picture.orientation == 1
                                     ? ""
                                     : fmt::format("EXIF orientation {} not applied: the sensor's rows count{}",
                                                   picture.orientation, picture.reason.empty() ? "" : "; ");
        const std::string line = fmt::format("  {:8}  {:{}}  {}{}", picture.used ? "used" : "left out", picture.image,
                                             widest, held, picture.reason);
        fmt::print("{}\n", line.substr(0, line.find_last_not_of(' ') + 1));
    }
    for (const std::string& suspicion : profile.source.suspicions) {
        fmt::print("correction suspected: {}\n", suspicion);
    }
}

void print_profile(const Profile& profile) {
    print_account(profile);
    if (profile.geometry) {
        const ProfileGeometry& geometry = *profile.geometry;
        const std::vector<std::string> names = parameter_names(geometry.model);
        const std::vector<double> values = parameters(geometry.model);
        fmt::print("{}: {} points in {} views, rms {:.4f} px\n", kind_name(geometry.model), geometry.points_used,
                   geometry.views_used, geometry.reprojection_rms_px);
        for (std::size_t i = 0; i < names.size(); ++i) {
            fmt::print("{:22} {:.6g} ± {:.2g}\n", names[i], values[i], geometry.standard_error(i));
        }
    }
    print_curve(profile, "distortion_percent", "distortion", "%");
    for (const char* channel : {"R", "G", "B", "Y"}) {
        print_curve(profile, fmt::format("vignetting_{}_ev", channel), fmt::format("vignetting {}", channel).c_str(),
                    "EV");
    }
    for (const char* channel : {"R", "B"}) {
        print_curve(profile, fmt::format("chromatic_shift_{}_px", channel),
                    fmt::format("chromatic shift {}", channel).c_str(), "px");
    }
    if (profile.self_test) {
        fmt::print("{:22} {}\n", "floor of the method", describe_floor(*profile.self_test));
    }
    for (const auto& [what, why] : profile.not_measured) {
        fmt::print("{} not measured: {}\n", what, why);
    }
}

const CLI::Validator kTransferOption(
    [](const std::string& text) {
        return parse_transfer_curve(text)
                   ? std::string()
                   : fmt::format("'{}' is no curve: expected srgb, rec709, linear or gamma:2.2", text);
    },
    "CURVE");

/// Folders stand for the pictures in them. A name that was given has to be there.
std::vector<std::filesystem::path> expanded(const std::vector<std::string>& names) {
    std::vector<std::filesystem::path> files;
    for (const std::string& name : names) {
        if (!std::filesystem::is_directory(name)) {
            check_readable(name);
        }
        const std::vector<std::filesystem::path> found = picture_files(name);
        files.insert(files.end(), found.begin(), found.end());
    }
    return files;
}

/// What the camera noted, where the command line says nothing else.
void take_notes(MeasureInput& input, const PhotoSurvey& survey) {
    const CameraNotes& notes = survey.notes;
    if (notes != CameraNotes{.transfer = notes.transfer}) {
        input.source.notes = notes;
    }
    input.source.suspicions = survey.suspicions;
    if (input.source.camera == kUnknown && !notes.model.empty()) {
        input.source.camera = notes.make.empty() ? notes.model : notes.make + " " + notes.model;
    }
    if (input.source.lens == kUnknown && !notes.lens.empty()) {
        input.source.lens = notes.lens;
    }
    if (!input.pixel_pitch_um) {
        input.pixel_pitch_um = notes.pixel_pitch_um;
    }
}

int run_measure(const MeasureOptions& options) {
    if (!options.output.empty()) {
        check_output_name(options.output);
    }
    check_json_name(options.common);
    MeasureInput input;
    input.name = options.images.front();
    input.chart = read_chart_file(options.chart);
    if (std::holds_alternative<FlatField>(input.chart.pattern)) {
        throw InputError(
            fmt::format("{}: the chart is a flat field, expected a checkerboard or a disc grid; pictures of an "
                        "even surface are given with --flat-field",
                        options.chart));
    }
    if (!can_detect(input.chart)) {
        throw InputError(
            fmt::format("{}: the chart is of kind {}, which is not measured: expected a checkerboard or a "
                        "disc-grid",
                        options.chart, kind_name(input.chart)));
    }
    input.self_test = !options.no_self_test;
    input.model = model_kind(options.model);
    input.source = {.kind = options.kind, .images = {}, .camera = options.camera, .lens = options.lens};
    if (options.pixel_pitch_um > 0.0) {
        input.pixel_pitch_um = options.pixel_pitch_um;
    }
    const PhotoSurvey survey =
        survey_photos(expanded(options.images), expanded(options.flat_fields), parse_transfer_curve(options.transfer));
    input.pictures = survey.pictures;
    take_notes(input, survey);
    Profile profile = measure(input);
    for (const std::string& sign : suspicions_of(profile)) {
        profile.source.suspicions.push_back(sign);
    }
    if (!options.output.empty()) {
        write_profile(profile, options.output);
    }
    write_json_result(options.common, to_json(profile));
    if (prints_text(options.common)) {
        print_profile(profile);
    }
    return kDone;
}

}  // namespace

void add_measure_command(CLI::App& app, int& status) {
    const auto options = std::make_shared<MeasureOptions>();
    CLI::App* command =
        app.add_subcommand("measure", "Find a chart in pictures; estimate distortion, vignetting and chromatic shift");
    command->footer(
        "Example: lensproof measure photos/*.jpg --chart photos/manifest.toml -o profile.json\n"
        "CHART is any TOML file with a [chart] table: a chart's own, a photo set's manifest, a scene.");
    command
        ->add_option("IMAGE", options->images,
                     "Pictures of the chart (JPEG, PNG, TIFF, EXR, RAW, …), or folders of them")
        ->required();
    command->add_option("--chart", options->chart, "TOML file with a [chart] table")->required()->type_name("FILE");
    command->add_option("--flat-field", options->flat_fields, "Pictures of an even surface, for vignetting")
        ->type_name("FILE");
    command->add_option("--model", options->model, "brown-conrady or kannala-brandt (default: what fits better)")
        ->check(CLI::IsMember({"brown-conrady", "kannala-brandt"}));
    command->add_option("--pixel-pitch", options->pixel_pitch_um, "Pixel pitch in µm, for lengths in mm")
        ->check(kPositiveOption);
    command->add_option("--lens", options->lens, "The lens's name, noted in the profile")->capture_default_str();
    command->add_option("--camera", options->camera, "The camera's name, noted in the profile")->capture_default_str();
    command->add_option("--kind", options->kind, "photo or render, noted in the profile")
        ->check(CLI::IsMember({"photo", "render"}))
        ->capture_default_str();
    command->add_flag("--no-self-test", options->no_self_test,
                      "Do not simulate and measure the pictures again to find the method's own error");
    command
        ->add_option("--transfer", options->transfer,
                     "The curve of pictures that state none: srgb, rec709, linear or gamma:2.2 (default: srgb)")
        ->check(kTransferOption);
    command->add_option("-o,--output", options->output, "Profile JSON to write")->type_name("FILE");
    add_common_options(*command, options->common);
    command->callback([options, &status] { status = run_measure(*options); });
}

}  // namespace lensproof
