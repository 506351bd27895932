// experiments/cli/measure_command.cpp — `lensproof measure IMAGE… --chart CHART`: from pictures to a profile.
#include <fmt/format.h>

#include <memory>

#include "calibration/detect.h"
#include "calibration/measure.h"
#include "engine/io/file.h"
#include "engine/io/input_error.h"
#include "engine/scene/chart_file.h"
#include "experiments/cli/command.h"

namespace lensproof {

namespace {

struct MeasureOptions {
    CommonOptions common;
    std::vector<std::string> images;
    std::vector<std::string> flat_fields;
    std::string chart;
    std::string model = "auto";
    std::string output;
    std::string lens = "unknown";
    std::string camera = "unknown";
    std::string kind = "photo";
    double pixel_pitch_um = 0.0;
    bool fit_board_shape = false;
};

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

void print_profile(const Profile& profile) {
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
    if (profile.geometry && profile.geometry->board) {
        for (std::size_t i = 0; i < kBoardTerms; ++i) {
            fmt::print("{:22} {:.4f} ± {:.2g}\n", kBoardTermNames[i], profile.geometry->board->height_mm[i],
                       standard_error_mm(*profile.geometry->board, i));
        }
    }
    if (profile.geometry && profile.geometry->choice) {
        fmt::print("chosen because: {}\n", profile.geometry->choice->why);
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
    for (const auto& [what, why] : profile.not_measured) {
        fmt::print("{} not measured: {}\n", what, why);
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
    input.model = model_kind(options.model);  // none for "auto"
    input.source = {.kind = options.kind, .images = {}, .camera = options.camera, .lens = options.lens};
    input.geometry.fit_board_shape = options.fit_board_shape;
    if (options.pixel_pitch_um > 0.0) {
        input.pixel_pitch_um = options.pixel_pitch_um;
    }
    const auto add = [&](const std::string& file, PictureRole role) {
        input.pictures.push_back({.name = file, .role = role, .load = [file] { return read_image(file); }});
    };
    for (const std::string& image : options.images) {
        add(image, PictureRole::chart);
    }
    for (const std::string& image : options.flat_fields) {
        add(image, PictureRole::flat_field);
    }
    const Profile profile = measure(input);
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
    command->add_option("IMAGE", options->images, "Pictures of the chart (JPEG, PNG, TIFF, EXR, …)")->required();
    command->add_option("--chart", options->chart, "TOML file with a [chart] table")->required()->type_name("FILE");
    command->add_option("--flat-field", options->flat_fields, "Pictures of an even surface, for vignetting")
        ->type_name("FILE");
    std::vector<std::string> models = model_kind_names();
    models.emplace_back("auto");
    command
        ->add_option("--model", options->model,
                     "The lens model; auto chooses by held-out error and uncertainty, and says why")
        ->check(CLI::IsMember(models))
        ->capture_default_str();
    command->add_flag("--board-shape", options->fit_board_shape, "Fit how far the chart is from flat, with the lens");
    command->add_option("--pixel-pitch", options->pixel_pitch_um, "Pixel pitch in µm, for lengths in mm")
        ->check(kPositiveOption);
    command->add_option("--lens", options->lens, "The lens's name, noted in the profile")->capture_default_str();
    command->add_option("--camera", options->camera, "The camera's name, noted in the profile")->capture_default_str();
    command->add_option("--kind", options->kind, "photo or render, noted in the profile")
        ->check(CLI::IsMember({"photo", "render"}))
        ->capture_default_str();
    command->add_option("-o,--output", options->output, "Profile JSON to write")->type_name("FILE");
    add_common_options(*command, options->common);
    command->callback([options, &status] { status = run_measure(*options); });
}

}  // namespace lensproof
