// experiments/cli/measure_command.cpp — `lensproof measure IMAGE… --chart CHART`: from pictures to a profile.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>

#include "calibration/detect.h"
#include "calibration/measure.h"
#include "calibration/measure_bands.h"
#include "calibration/mosaic.h"
#include "engine/io/file.h"
#include "engine/io/input_error.h"
#include "engine/io/srgb.h"
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
    bool no_self_test = false;
    std::vector<std::string> edges;
    std::vector<double> focus_positions_mm;
    bool fit_board_shape = false;
    std::vector<std::string> bands;
    double reference_band_nm = 550.0;
    std::string mosaic;
    std::vector<double> image_centre_px;
};

void print_curve(const Profile& profile, const std::string& name, const char* label, const char* unit) {
    const auto found = profile.curves.find(name);
    if (found == profile.curves.end()) {
        return;
    }
    const Curve& curve = found->second;
    const double height =  // some curves are extrapolated beyond what was covered, some end before it
        curve.image_height.empty() ? 0.0 : std::min(curve.covered_image_height, curve.image_height.back());
    if (const std::optional<Banded> end = sample(curve, height)) {
        fmt::print("{:22} {:9.4f} ± {:.4f} {} at image height {:.2f}\n", label, end->value,
                   (end->upper_95 - end->lower_95) / (2.0 * k95), unit, height);
    }
}

void print_edge(const std::string& channel, const ProfileEdge& listed) {
    const EdgeMtf& edge = listed.edge;
    if (edge.mtf50) {
        fmt::print("{:22} {:9.4f} ± {:.4f} cycles/px at ({:.1f}, {:.1f}) px, edge normal {:.1f}°\n",
                   fmt::format("MTF50 {}", channel), edge.mtf50->cycles_per_px, edge.mtf50->standard_error,
                   edge.centre_px.x, edge.centre_px.y, edge.normal_deg);
    }
}

void print_sharpness(const Profile& profile) {
    constexpr std::size_t few = 6;  // edges that are listed one by one; more make a curve
    for (const auto& [channel, edges] : profile.sharpness) {
        for (std::size_t i = 0; i < edges.size() && edges.size() < few; ++i) {
            print_edge(channel, edges[i]);
        }
        for (const char* direction : {"tangential", "sagittal"}) {
            print_curve(profile, fmt::format("mtf50_{}_{}", direction, channel),
                        fmt::format("MTF50 {} {}", direction, channel).c_str(), "cycles/px");
            print_curve(profile, fmt::format("best_focus_{}_{}_mm", direction, channel),
                        fmt::format("focus {} {}", direction, channel).c_str(), "mm");
        }
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
    for (const auto& [channel, models] : profile.vignetting_models) {
        if (models.front().values.empty()) {
            fmt::print("{:22} no formula, but a spline (rms {:.3f} %)\n", "vignetting " + channel,
                       100.0 * models.front().relative_rms);
        } else {
            fmt::print("{:22} {} (rms {:.3f} %)\n", "vignetting " + channel, models.front().name,
                       100.0 * models.front().relative_rms);
        }
    }
    for (const auto& [name, terms] : profile.terms) {
        for (std::size_t i = 0; i < terms.names.size() && name.starts_with("chromatic_shift_mean_"); ++i) {
            fmt::print("{:22} {:9.4f} ± {:.4f} px, {} of all points\n",
                       "shift " + name.substr(std::string("chromatic_shift_mean_").size()), terms.values[i],
                       std::sqrt(terms.covariance[i * (terms.names.size() + 1)]), terms.names[i]);
        }
    }
    for (const auto& [name, curve] : profile.curves) {
        if (const std::string kind = "chromatic_shift_"; name.starts_with(kind)) {
            std::string label = name.substr(kind.size(), name.size() - kind.size() - std::string("_px").size());
            std::replace(label.begin(), label.end(), '_', ' ');
            print_curve(profile, name, fmt::format("chromatic shift {}", label).c_str(), "px");
        }
    }
    if (profile.self_test) {
        fmt::print("{:22} {}\n", "floor of the method", describe_floor(*profile.self_test));
    }
    print_sharpness(profile);
    for (const auto& [what, why] : profile.not_measured) {
        fmt::print("{} not measured: {}\n", what, why);
    }
}

// "x,y,width,height" or "whole".
PixelRectangle parse_rectangle(const std::string& text) {
    if (text == "whole") {
        return {};
    }
    std::vector<int> numbers;
    for (const std::string& field : CLI::detail::split(text, ',')) {
        int value = 0;
        const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
        if (error != std::errc() || end != field.data() + field.size()) {
            break;
        }
        numbers.push_back(value);
    }
    const bool is_rectangle = numbers.size() == 4 && std::count(text.begin(), text.end(), ',') == 3 &&
                              numbers[0] >= 0 && numbers[1] >= 0 && numbers[2] > 0 && numbers[3] > 0;
    if (!is_rectangle) {
        throw InputError(fmt::format("--edge: found \"{}\", expected x,y,width,height in pixels, or whole", text));
    }
    return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

void add_sharpness_input(MeasureInput& input, const MeasureOptions& options) {
    for (const std::string& edge : options.edges) {
        input.edges.push_back(parse_rectangle(edge));
    }
    if (options.focus_positions_mm.empty()) {
        return;
    }
    if (options.focus_positions_mm.size() != options.images.size()) {
        throw InputError(fmt::format("--focus-positions: {} positions for {} pictures, expected one for each",
                                     options.focus_positions_mm.size(), options.images.size()));
    }
    for (std::size_t i = 0; i < options.images.size(); ++i) {
        input.focus_position_mm[options.images[i]] = options.focus_positions_mm[i];
    }
}

Chart chart_to_find(const std::string& file) {
    Chart chart = read_chart_file(file);
    if (std::holds_alternative<FlatField>(chart.pattern)) {
        throw InputError(
            fmt::format("{}: the chart is a flat field, expected one of {}; pictures of an even surface "
                        "are given with --flat-field",
                        file, detectable_kinds()));
    }
    if (!can_detect(chart)) {
        throw InputError(fmt::format("{}: the chart is of kind {}, which is not measured: expected one of {}", file,
                                     kind_name(chart), detectable_kinds()));
    }
    return chart;
}

double parse_wavelength(const std::string& text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value > 0.0) || !std::isfinite(value)) {
        throw InputError(fmt::format("--bands: found \"{}\", expected a wavelength in nm", text));
    }
    return value;
}

// A raw mosaic holds the sensor's own, linear values; `read_image` took integers for sRGB.
Image read_mosaic(const std::string& file, MosaicPattern pattern) {
    Image image = read_image(file);
    if (!file.ends_with(".exr")) {
        for (float& value : image.pixels) {
            value = linear_to_srgb(value);
        }
    }
    try {
        return mosaic_plane(image, pattern);
    } catch (const InputError& e) {
        throw InputError(fmt::format("{}: {}", file, e.what()));
    }
}

Profile run_bands(const MeasureOptions& options, const ProfileSource& source) {
    BandInput input{.name = "bands",
                    .bands = {},
                    .reference_wavelength_nm = options.reference_band_nm,
                    .chart = {},
                    .centre_px = {},
                    .source = source,
                    .pixel_pitch_um = {}};
    for (const std::string& band : options.bands) {
        const std::size_t sign = band.find('=');
        if (sign == std::string::npos || sign + 1 == band.size()) {
            throw InputError(fmt::format("--bands: found \"{}\", expected NM=FILE", band));
        }
        const std::string file = band.substr(sign + 1);
        const auto pattern = mosaic_pattern(options.mosaic);
        input.bands.push_back({.wavelength_nm = parse_wavelength(band.substr(0, sign)), .name = file, .load = [=] {
                                   return pattern ? read_mosaic(file, *pattern) : read_image(file);
                               }});
    }
    if (!options.chart.empty()) {
        input.chart = chart_to_find(options.chart);
    }
    if (!options.image_centre_px.empty()) {
        input.centre_px = Vec2d{options.image_centre_px[0], options.image_centre_px[1]};
    }
    if (options.pixel_pitch_um > 0.0) {
        input.pixel_pitch_um = options.pixel_pitch_um;
    }
    return measure_bands(input);
}

void write_and_print(const MeasureOptions& options, const Profile& profile) {
    if (!options.output.empty()) {
        write_profile(profile, options.output);
    }
    write_json_result(options.common, to_json(profile));
    if (prints_text(options.common)) {
        print_profile(profile);
    }
}

int run_measure(const MeasureOptions& options) {
    if (!options.output.empty()) {
        check_output_name(options.output);
    }
    check_json_name(options.common);
    const ProfileSource source{.kind = options.kind, .images = {}, .camera = options.camera, .lens = options.lens};
    if (options.bands.empty() == options.images.empty()) {
        throw InputError("measure: expected pictures, or --bands NM=FILE,… instead of them");
    }
    if (!options.bands.empty()) {
        write_and_print(options, run_bands(options, source));
        return kDone;
    }
    MeasureInput input;
    input.name = options.images.front();
    if (options.chart.empty() == options.edges.empty()) {
        throw InputError("measure: expected --chart FILE, or --edge for pictures of edges without a chart");
    }
    if (options.edges.empty()) {
        input.chart = chart_to_find(options.chart);
    }
    input.self_test = !options.no_self_test;
    add_sharpness_input(input, options);
    input.model = model_kind(options.model);  // none for "auto"
    input.source = source;
    input.geometry.fit_board_shape = options.fit_board_shape;
    if (options.pixel_pitch_um > 0.0) {
        input.pixel_pitch_um = options.pixel_pitch_um;
    }
    const auto add = [&](const std::string& file, PictureRole role) {
        input.pictures.push_back({.name = file, .role = role, .load = [file] { return read_image(file); }});
    };
    for (const std::string& image : options.images) {
        add(image, options.edges.empty() ? PictureRole::chart : PictureRole::edges);
    }
    for (const std::string& image : options.flat_fields) {
        add(image, PictureRole::flat_field);
    }
    write_and_print(options, measure(input));
    return kDone;
}

}  // namespace

void add_measure_command(CLI::App& app, int& status) {
    const auto options = std::make_shared<MeasureOptions>();
    CLI::App* command = app.add_subcommand(
        "measure", "Find a chart in pictures; estimate distortion, vignetting, chromatic shift and sharpness");
    command->footer(
        "Example: lensproof measure photos/*.jpg --chart photos/manifest.toml -o profile.json\n"
        "CHART is any TOML file with a [chart] table: a chart's own, a photo set's manifest, a scene.");
    command->add_option("IMAGE", options->images, "Pictures of the chart (JPEG, PNG, TIFF, EXR, …)");
    command->add_option("--chart", options->chart, "TOML file with a [chart] table")->type_name("FILE");
    command
        ->add_option("--edge", options->edges,
                     "Instead of a chart: a rectangle x,y,width,height (px) that holds one slanted edge; or whole")
        ->allow_extra_args(false)
        ->type_name("RECTANGLE");
    command
        ->add_option("--focus-positions", options->focus_positions_mm,
                     "Where the focus stood in each IMAGE, mm, for field curvature")
        ->delimiter(',');
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
    command->add_flag("--no-self-test", options->no_self_test,
                      "Do not simulate and measure the pictures again to find the method's own error");
    command->add_option("-o,--output", options->output, "Profile JSON to write")->type_name("FILE");
    command
        ->add_option("--bands", options->bands,
                     "Instead of pictures: one scene in narrow bands, for the chromatic shift per wavelength (nm)")
        ->delimiter(',')
        ->type_name("NM=FILE");
    command->add_option("--reference-band", options->reference_band_nm, "The band that shifts are counted from, nm")
        ->capture_default_str();
    command->add_option("--mosaic", options->mosaic, "The bands are raw Bayer mosaics: their top left 2 x 2 colours")
        ->check(CLI::IsMember({"rggb", "bggr", "grbg", "gbrg"}));
    command
        ->add_option("--image-centre", options->image_centre_px,
                     "Of the bands' pictures: the optical centre x,y, px (default: their middle)")
        ->delimiter(',')
        ->expected(2);
    add_common_options(*command, options->common);
    command->callback([options, &status] { status = run_measure(*options); });
}

}  // namespace lensproof
