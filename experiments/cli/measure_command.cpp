// experiments/cli/measure_command.cpp — `lensproof measure IMAGE… --chart CHART`: from pictures to a profile.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "calibration/detection/detect.h"
#include "calibration/measure/measure.h"
#include "calibration/photos/photo_survey.h"
#include "calibration/self_test/self_test.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "engine/scene/chart/chart_file.h"
#include "experiments/cli/measure_parts.h"
#include "experiments/cli/pixel_rectangles.h"
#include "experiments/cli/progress.h"

namespace lensproof::cli {

namespace {

/// What the pictures but the flat fields are to show, and where the focus stood in them.
void set_roles(calibration::MeasureInput& input, const MeasureOptions& options) {
    input.edges = parse_edges(options.edges);
    std::vector<std::string> names;
    for (calibration::Picture& picture : input.pictures) {
        if (picture.role == calibration::PictureRole::chart) {
            picture.role = options.lines                 ? calibration::PictureRole::lines
                           : !options.directions.empty() ? calibration::PictureRole::directions
                           : options.edges.empty()       ? calibration::PictureRole::chart
                                                         : calibration::PictureRole::edges;
            names.push_back(picture.name);
        }
    }
    const std::vector<double>& positions = options.focus_positions_mm;
    if (!positions.empty() && positions.size() != names.size()) {
        throw InputError(fmt::format("--focus-positions: {} positions for {} pictures, expected one for each",
                                     positions.size(), names.size()));
    }
    for (std::size_t i = 0; i < positions.size(); ++i) {
        input.focus_position_mm[names[i]] = positions[i];
    }
}

void write_and_print(const MeasureOptions& options, const calibration::Profile& profile) {
    if (prints_text(options.common)) {
        print_profile(profile);
    }
    Delivery delivery;
    if (!options.output.empty()) {
        delivery = write_somewhere(
            {options.output}, [&](const std::filesystem::path& file) { calibration::write_profile(profile, file); });
    }
    write_json_result(options.common, lensproof::to_json(profile));
    check_place(delivery);
}

const OptionCheck kTransferOption{
    [](const std::string& text) {
        return formats::parse_transfer_curve(text)
                   ? std::string()
                   : fmt::format("'{}' is no curve: expected srgb, rec709, linear or gamma:2.2", text);
    },
    "CURVE"};

/// Lines know no camera that could be held or freed; directions know one, and no chart.
void check_without_chart(const MeasureOptions& options) {
    struct Option {
        const char* name;
        bool is_given;
        bool is_of_cameras;
    };
    const Option of_charts[] = {{"--chart", !options.chart.empty(), false},
                                {"--edge", !options.edges.empty(), false},
                                {"--lines", options.lines && !options.directions.empty(), false},
                                {"--each", options.each && !options.directions.empty(), false},
                                {"--model", options.model != "auto", true},
                                {"--aspect", options.aspect != "square", true},
                                {"--board-shape", options.fit_board_shape, false},
                                {"--focal-length", options.focal_length_mm > 0.0, true},
                                {"--fix-centre", options.fix_centre, true},
                                {"--focus-positions", !options.focus_positions_mm.empty(), false}};
    for (const auto& [name, is_given, is_of_cameras] : of_charts) {
        if (is_given && (options.directions.empty() || !is_of_cameras)) {
            throw InputError(fmt::format("{}: given with {}, which looks for no chart: expected one of them", name,
                                         options.directions.empty() ? "--lines" : "--directions"));
        }
    }
}

/// The table's, by the pictures' names here.
calibration::KnownDirections directions_of(const std::string& file, const std::vector<calibration::Picture>& pictures) {
    std::map<std::string, std::string> names;  // by the file's
    std::vector<std::string> files;
    for (const calibration::Picture& picture : pictures) {
        if (picture.role == calibration::PictureRole::directions) {
            files.push_back(std::filesystem::path(picture.name).filename().string());
            if (!names.emplace(files.back(), picture.name).second) {
                throw InputError(fmt::format("{}: there are two pictures of this name, which {} cannot tell apart",
                                             files.back(), file));
            }
        }
    }
    calibration::KnownDirections directions;
    for (auto& [name, own] : calibration::read_known_directions(file, files)) {
        directions[names.at(name)] = std::move(own);
    }
    return directions;
}

/// Edges tell what edges tell, lines what lines do, and who brings an even surface asks for vignetting.
void check_only(const MeasureOptions& options) {
    if (options.only.empty()) {
        return;
    }
    if (options.lines || !options.edges.empty()) {
        throw InputError("--only: says what a chart or directions are asked, expected neither --edge nor --lines");
    }
    if (!options.flat_fields.empty() && !calibration::parts_named(options.only).vignetting) {
        throw InputError("--only: has no vignetting, which the pictures of --flat-field are for, expected both");
    }
}

int run_measure(const MeasureOptions& options) {
    if (!options.output.empty() && !options.each) {
        check_output_name(options.output);
    }
    if (!options.plots_folder.empty()) {
        check_output_name(std::filesystem::path(options.plots_folder) / "edges.csv");
    }
    check_json_name(options.common);
    const calibration::ProfileSource source{
        .kind = options.kind, .images = {}, .camera = options.camera, .lens = options.lens};
    if (options.bands.empty() == options.images.empty()) {
        throw InputError("measure: expected pictures, or --bands NM=FILE,… instead of them");
    }
    if (!options.bands.empty()) {
        write_and_print(options, run_bands(options, source));
        return kDone;
    }
    if (options.lines || !options.directions.empty()) {
        check_without_chart(options);
    } else if (options.chart.empty() == options.edges.empty()) {
        throw InputError(
            "measure: expected --chart FILE, or of pictures without a chart --edge for sharpness, --lines for "
            "distortion or --directions FILE for a camera");
    }
    const scene::Chart chart = options.chart.empty() ? scene::Chart{} : chart_to_find(options.chart);
    check_only(options);
    const std::vector<std::filesystem::path> pictures = pictures_named(options.images);
    if (options.each) {
        return measure_each(options, source, chart, pictures);
    }
    const calibration::MeasureInput input = measure_input(options, source, chart, options.images.front(), pictures);
    const calibration::Profile profile = measure_pictures(options, input);
    write_and_print(options, profile);
    if (!options.plots_folder.empty()) {
        write_measure_plots(options.plots_folder, profile, input);
    }
    return kDone;
}

}  // namespace

std::vector<std::filesystem::path> pictures_named(const std::vector<std::string>& names) {
    std::vector<std::filesystem::path> files;
    for (const std::string& name : names) {
        if (!is_folder(name)) {
            check_readable(name);
        }
        const std::vector<std::filesystem::path> found = calibration::picture_files(name);
        files.insert(files.end(), found.begin(), found.end());
    }
    return files;
}

calibration::MeasureInput measure_input(const MeasureOptions& options, const calibration::ProfileSource& source,
                                        const scene::Chart& chart, const std::string& name,
                                        const std::vector<std::filesystem::path>& pictures) {
    calibration::MeasureInput input;
    input.name = name;
    input.chart = chart;
    input.model = calibration::model_kind(options.model);  // none for "auto"
    input.source = source;
    input.threads = options.common.threads;
    if (!options.only.empty()) {
        input.parts = calibration::parts_named(options.only);
    }
    input.geometry.fit_board_shape = options.fit_board_shape;
    input.geometry.fit_stretch = options.aspect == "free";
    input.geometry.fix_centre = options.fix_centre;
    if (options.pixel_pitch_um > 0.0) {
        input.pixel_pitch_um = options.pixel_pitch_um;
    }
    const calibration::PhotoSurvey survey = calibration::survey_photos(pictures, pictures_named(options.flat_fields),
                                                                       formats::parse_transfer_curve(options.transfer));
    calibration::take_survey(input, survey);
    if (options.focal_length_mm > 0.0) {
        if (!input.pixel_pitch_um) {
            throw InputError("--focal-length: the pixel pitch is not known: expected --pixel-pitch beside it");
        }
        input.geometry.known_focal_px = options.focal_length_mm * 1e3 / *input.pixel_pitch_um;
    }
    set_roles(input, options);
    if (!options.directions.empty()) {
        input.directions = directions_of(options.directions, input.pictures);
    }
    return input;
}

calibration::Profile measure_pictures(const MeasureOptions& options, calibration::MeasureInput input) {
    // The fit between the pictures and the self-test's takes its part, and tells nothing of how far it is.
    constexpr double kLooking = 0.35;
    constexpr double kMeasured = 0.5;
    ProgressBar progress("measuring", options.common.quiet || options.each);
    const double all = options.no_self_test ? kMeasured : 1.0;
    input.progress = [&](double done) { progress.update(kLooking * done / all); };
    calibration::Profile profile = calibration::measure_surveyed(input);
    if (!options.no_self_test) {
        input.progress = [&](double done) { progress.update(kMeasured + (1.0 - kMeasured) * done); };
        calibration::add_self_test(profile, input);
    }
    return profile;
}

scene::Chart chart_to_find(const std::string& file) {
    scene::Chart chart = scene::read_chart_file(file);
    if (std::holds_alternative<scene::FlatField>(chart.pattern)) {
        throw InputError(
            fmt::format("{}: the chart is a flat field, expected one of {}; pictures of an even surface "
                        "are given with --flat-field",
                        file, calibration::detectable_kinds()));
    }
    if (!calibration::can_detect(chart) && !std::holds_alternative<scene::SiemensStar>(chart.pattern)) {
        throw InputError(
            fmt::format("{}: the chart is of kind {}, which is not measured: expected one of {}, siemens-star", file,
                        scene::kind_name(chart), calibration::detectable_kinds()));
    }
    return chart;
}

void add_measure_command(Program& program) {
    const auto options = std::make_shared<MeasureOptions>();
    Command command = program.add_command(
        "measure", "Find a chart in pictures; estimate distortion, vignetting, chromatic shift and sharpness");
    command.footer(
        "Example: lensproof measure photos/*.jpg --chart photos/manifest.toml -o profile.json\n"
        "CHART is any TOML file with a [chart] table: a chart's own, a photo set's manifest, a scene.");
    command.add_option("IMAGE", options->images,
                       "Pictures of the chart (JPEG, PNG, TIFF, EXR, RAW, …), or folders of them");
    command.add_option("--chart", options->chart, "TOML file with a [chart] table").type_name("FILE");
    command
        .add_option(
            "--edge", options->edges,
            "Instead of a chart: a rectangle x,y,width,height (px) that holds one slanted edge; whole; or auto for "
            "all edges that are found")
        .takes_one_argument()
        .type_name("RECTANGLE");
    command.add_flag("--lines", options->lines,
                     "Instead of a chart: distortion from what is straight in the scene (buildings, frames, shelves)");
    command
        .add_option("--directions", options->directions,
                    "Instead of a chart: CSV table of stars, or other small lights far away: x_px, y_px (of some) and "
                    "right_ascension_deg, declination_deg (or azimuth_deg, altitude_deg; or dx, dy, dz), for several "
                    "pictures also picture")
        .type_name("FILE");
    command
        .add_option("--focus-positions", options->focus_positions_mm,
                    "Where the focus stood in each IMAGE, mm, for field curvature")
        .separated_by(',');
    command
        .add_option(
            "--plots", options->plots_folder,
            "Folder for edges.csv, maps of the sharpness over the frame and pictures with their edges or lines marked")
        .type_name("DIR");
    command.add_flag("--each", options->each,
                     "Measure each picture by itself; -o and --plots are then folders, with a summary.csv in -o");
    command
        .add_option("--only", options->only,
                    fmt::format("What a chart or directions are asked: {}. The rest is not looked at (default: all)",
                                fmt::join(calibration::known_parts(), ", ")))
        .check(one_of(calibration::known_parts()))
        .separated_by(',')
        .takes_one_argument();
    command.add_option("--flat-field", options->flat_fields, "Pictures of an even surface, for vignetting")
        .type_name("FILE");
    std::vector<std::string> models = calibration::model_kind_names();
    models.emplace_back("auto");
    command
        .add_option("--model", options->model,
                    "The lens model; auto chooses by held-out error and uncertainty, and says why")
        .check(one_of(models))
        .shows_default();
    command.add_option("--aspect", options->aspect, "Of the pixels: square, or free to fit a vertical focal length too")
        .check(one_of({"square", "free"}))
        .shows_default();
    command.add_flag("--board-shape", options->fit_board_shape, "Fit how far the chart is from flat, with the lens");
    command.add_option("--pixel-pitch", options->pixel_pitch_um, "Pixel pitch in µm, for lengths in mm")
        .check(kPositiveOption);
    command
        .add_option("--focal-length", options->focal_length_mm,
                    "Hold the focal length at this many mm, which a chart that faces the camera cannot tell")
        .check(kPositiveOption);
    command.add_flag("--fix-centre", options->fix_centre, "Hold the optical centre at the picture's middle");
    command.add_option("--lens", options->lens, "The lens's name, noted in the profile").shows_default();
    command.add_option("--camera", options->camera, "The camera's name, noted in the profile").shows_default();
    command.add_option("--kind", options->kind, "photo or render, noted in the profile")
        .check(one_of({"photo", "render"}))
        .shows_default();
    command.add_flag("--no-self-test", options->no_self_test,
                     "Do not simulate and measure the pictures again to find the method's own error");
    command
        .add_option("--transfer", options->transfer,
                    "The curve of pictures that state none: srgb, rec709, linear or gamma:2.2 (default: srgb)")
        .check(kTransferOption);
    command.add_option("-o,--output", options->output, "Profile JSON to write").type_name("FILE");
    command
        .add_option("--bands", options->bands,
                    "Instead of pictures: one scene in narrow bands, for the chromatic shift per wavelength (nm)")
        .separated_by(',')
        .type_name("NM=FILE");
    command.add_option("--reference-band", options->reference_band_nm, "The band that shifts are counted from, nm")
        .shows_default();
    command.add_option("--mosaic", options->mosaic, "The bands are raw Bayer mosaics: their top left 2 x 2 colours")
        .check(one_of({"rggb", "bggr", "grbg", "gbrg"}));
    command
        .add_option("--image-centre", options->image_centre_px,
                    "Of the bands' pictures: the optical centre x,y, px (default: their middle)")
        .separated_by(',')
        .takes(2);
    add_common_options(command, options->common);
    command.runs([options] { return run_measure(*options); });
}

}  // namespace lensproof::cli
