// experiments/cli/compare_command.cpp — `lensproof compare A B`: two profiles, two images, a lens with a profile or
// with photographs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "calibration/explain/explanation.h"
#include "calibration/profile/curve_difference.h"
#include "calibration/profile/profile.h"
#include "engine/base/cache.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/json.h"
#include "engine/formats/prescription/load_lens.h"
#include "experiments/cli/command.h"
#include "experiments/cli/compare_measured.h"
#include "experiments/cli/compare_pictures.h"
#include "experiments/cli/compare_report.h"
#include "experiments/studies/cameras/lens_profile.h"

namespace lensproof::cli {

namespace {

struct CompareOptions {
    CommonOptions common;
    std::string a;
    std::string b;
    double distortion_limit_percent = 0.0;  // 0: no limit, here and below
    double position_limit_px = 0.0;
    double vignetting_limit_ev = 0.0;
    double chromatic_limit_px = 0.0;
    double points_limit_um = 0.0;
    double f_number = 8.0;
    double focus_mm = kInfinity;
    std::string response = "camera";
    double pixel_pitch_um = 0.0;
    MeasuredOptions measured;
    PictureOptions pictures;
};

bool has_extension(const std::string& name, const char* extension) {
    return std::filesystem::path(name).extension() == extension;
}

bool is_lens(const std::string& name) {
    return name.find('.') == std::string::npos || has_extension(name, ".toml") || has_extension(name, ".csv");
}

/// A profile's file; where the pixel pitch was not known when it was measured, with that of the command.
calibration::Profile read_profile(const std::string& file, const CompareOptions& options) {
    calibration::Profile profile = calibration::read_profile(file);
    if (options.pixel_pitch_um > 0.0) {
        if (profile.pixel_pitch_um && *profile.pixel_pitch_um != options.pixel_pitch_um) {
            throw InputError(fmt::format("--pixel-pitch {}: {} was measured with a pixel pitch of {} um",
                                         options.pixel_pitch_um, file, *profile.pixel_pitch_um));
        }
        profile.pixel_pitch_um = options.pixel_pitch_um;
    }
    return profile;
}

/// The lens seen by the camera that `like` was taken with, and what is to be known of the lens.
std::pair<calibration::Profile, std::vector<optics::Finding>> profile_of_lens(const std::string& lens,
                                                                              const calibration::Profile& like,
                                                                              const CompareOptions& options) {
    if (!like.pixel_pitch_um) {
        throw InputError(
            fmt::format("{} has no pixel_pitch_um, which {} needs to be compared with it: expected --pixel-pitch",
                        lens == options.a ? options.b : options.a, lens));
    }
    render::CameraSettings camera = studies::camera_like(like, lens);
    camera.f_number = options.f_number;
    camera.focus_distance_mm = options.focus_mm;
    camera.response = options.response;
    const render::Camera seen(camera, {}, {}, Cache::standard());
    print_findings(options.common, *seen.lens());
    return {studies::lens_profile(seen), seen.lens()->findings};
}

ComparedRow make_row(const std::string& label, const calibration::Unit& unit,
                     const std::optional<calibration::CurveDifference>& difference, double limit) {
    ComparedRow row;
    row.limited = limit > 0.0;
    row.check.id = label;
    row.check.label = label;
    row.check.unit = unit.symbol;
    row.key_suffix = unit.suffix;
    row.check.limit = limit;
    row.check.value = difference ? difference->rms : std::nan("");
    row.check.sigma = difference ? difference->rms_sigma : 0.0;
    return row;
}

int report(const std::vector<ComparedRow>& rows, const Json& curves, const std::vector<optics::Finding>& findings,
           const CompareOptions& options) {
    Json json{{"a", options.a}, {"b", options.b}, {"findings", findings_json(findings)}};
    const int status = report_rows(rows, options.a, options.b, options.common, json);
    if (!curves.is_null()) {
        json["curves"] = curves;
    }
    write_json_result(options.common, json);
    return status;
}

/// How far the profile's points are from where the lens images them, beyond what measuring them leaves.
std::optional<ComparedRow> points_row(const std::string& lens, const std::string& file,
                                      const calibration::Profile& profile, const CompareOptions& options) {
    const bool has_points =
        profile.geometry && profile.pixel_pitch_um && std::ranges::any_of(profile.views, calibration::has_posed_chart);
    const auto found = has_points
                           ? calibration::prescribed_residual(
                                 formats::load_lens(lens), {file, profile},
                                 std::isfinite(options.focus_mm) ? std::optional(options.focus_mm) : std::nullopt)
                           : std::nullopt;
    if (!found) {
        return std::nullopt;
    }
    const double square = found->rms_um * found->rms_um;
    const double square_sigma = square / std::sqrt(found->points);  // of two coordinates each
    const double beyond = std::sqrt(std::max(0.0, square - found->noise_um * found->noise_um));
    ComparedRow row;
    row.limited = options.points_limit_um > 0.0;
    row.check.id = row.check.label = "points";
    row.check.unit = "µm";
    row.key_suffix = "_um";
    row.check.limit = options.points_limit_um;
    row.check.value = beyond;
    row.check.sigma = std::min(square_sigma / (2.0 * beyond), std::sqrt(square_sigma));
    return row;
}

int compare_profiles(const calibration::Profile& a, const calibration::Profile& b,
                     const std::vector<optics::Finding>& findings, const CompareOptions& options,
                     const std::optional<ComparedRow>& points = std::nullopt) {
    std::vector<ComparedRow> rows;
    if (points) {
        rows.push_back(*points);
    } else if (options.points_limit_um > 0.0) {
        throw InputError(fmt::format("{} and {}: no points that the lens images, to hold against --points-limit",
                                     options.a, options.b));
    }
    Json curves;
    const auto add = [&](const std::string& name, const calibration::Unit& unit,
                         const std::optional<calibration::CurveDifference>& found, double limit) {
        rows.push_back(make_row(name, unit, found, limit));
        if (found) {
            curves[name] = {{"image_height", found->curve.image_height},
                            {"difference", found->curve.value},
                            {"lower_95", found->curve.lower_95},
                            {"upper_95", found->curve.upper_95}};
        }
        if (!found && limit > 0.0) {
            throw InputError(
                fmt::format("{} and {}: no common {} to hold against its limit", options.a, options.b, name));
        }
    };
    const bool same_camera =
        a.width_px == b.width_px && a.height_px == b.height_px && a.pixel_pitch_um == b.pixel_pitch_um;
    using calibration::kQuantities;
    add(kQuantities.image_position.title(), kQuantities.image_position.unit,
        same_camera ? calibration::radial_difference_px(a, b) : std::nullopt, options.position_limit_px);
    const std::string distortion = kQuantities.distortion.key();
    add(distortion, kQuantities.distortion.unit, calibration::difference(a, b, distortion),
        options.distortion_limit_percent);
    // A channel that one of the two lacks is no failure, as long as another can be held against the limit.
    const auto add_channels = [&](const calibration::Quantity& quantity, double limit) {
        bool any_found = false;
        for (const char channel : quantity.channels) {
            const std::string name = quantity.key({&channel, 1});
            const auto found = calibration::difference(a, b, name);
            add(name, quantity.unit, found, found ? limit : 0.0);
            any_found = any_found || found;
        }
        if (!any_found && limit > 0.0) {
            throw InputError(fmt::format("{} and {}: no common {} to hold against its limit", options.a, options.b,
                                         quantity.key("…")));
        }
    };
    add_channels(kQuantities.vignetting_ev, options.vignetting_limit_ev);
    add_channels(kQuantities.chromatic_shift, options.chromatic_limit_px);
    if (std::ranges::none_of(rows, [](const ComparedRow& row) { return std::isfinite(row.check.value); })) {
        throw InputError(
            fmt::format("{} and {}: they have no curve in common, expected profiles of pictures in which "
                        "a chart was found",
                        options.a, options.b));
    }
    return report(rows, curves, findings, options);
}

/// A limit that nothing is held against would look like one that held.
void check_limits(bool profiles, const CompareOptions& options) {
    if (profiles && options.pictures.is_shown()) {
        throw InputError(fmt::format("--maps and --report show pictures; {} and {} are not", options.a, options.b));
    }
    if (!profiles && options.pixel_pitch_um > 0.0) {
        throw InputError(fmt::format("--pixel-pitch is that of profiles; {} and {} are not", options.a, options.b));
    }
    const std::vector<std::pair<const char*, double>> of_profiles = {
        {"--position-limit", options.position_limit_px},
        {"--distortion-limit", options.distortion_limit_percent},
        {"--vignetting-limit", options.vignetting_limit_ev},
        {"--chromatic-limit", options.chromatic_limit_px},
        {"--points-limit", options.points_limit_um}};
    for (const auto& [name, limit] : profiles ? options.pictures.limits() : of_profiles) {
        if (limit > 0.0) {
            throw InputError(fmt::format("{} is given, which is a limit of {}; {} and {} are {}", name,
                                         profiles ? "pictures" : "profiles", options.a, options.b,
                                         profiles ? "not" : "not profiles"));
        }
    }
}

int run_compare(const CompareOptions& options) {
    check_json_name(options.common);
    if (!options.measured.measured.empty()) {
        return compare_measured(options.a, options.measured, options.common);
    }
    if (options.b.empty()) {
        throw InputError(
            fmt::format("{} is given alone, expected what to compare it with: B, or --measured", options.a));
    }
    const bool a_is_profile = has_extension(options.a, ".json");
    const bool b_is_profile = has_extension(options.b, ".json");
    const bool profiles =
        (a_is_profile && (b_is_profile || is_lens(options.b))) || (b_is_profile && is_lens(options.a));
    check_limits(profiles, options);
    if (!profiles) {
        for (const std::string& name : {options.a, options.b}) {
            if (is_lens(name) || has_extension(name, ".json")) {
                throw InputError(fmt::format("{} and {}: expected two profiles, two pictures, or a lens and a profile",
                                             options.a, options.b));
            }
        }
    }
    if (a_is_profile && b_is_profile) {
        return compare_profiles(read_profile(options.a, options), read_profile(options.b, options), {}, options);
    }
    if (a_is_profile && is_lens(options.b)) {
        const calibration::Profile a = read_profile(options.a, options);
        const auto [lens, findings] = profile_of_lens(options.b, a, options);
        return compare_profiles(a, lens, findings, options, points_row(options.b, options.a, a, options));
    }
    if (b_is_profile && is_lens(options.a)) {
        const calibration::Profile b = read_profile(options.b, options);
        const auto [lens, findings] = profile_of_lens(options.a, b, options);
        return compare_profiles(lens, b, findings, options, points_row(options.a, options.b, b, options));
    }
    return compare_pictures(options.a, options.b, options.pictures, options.common);
}

}  // namespace

void add_compare_command(Program& program) {
    const auto options = std::make_shared<CompareOptions>();
    Command command = program.add_command(
        "compare", "Compare two profiles, two images, or a lens with a profile or with photographs");
    command.footer(
        "Example: lensproof compare tessar profile.json --f-number 8 --position-limit 0.5\n"
        "         lensproof compare canon-fd-24 --measured \"lensfun:Canon FDn 24mm 1:2.8\"");
    command.add_option("A", options->a, "A profile (.json), an image, or a lens").required();
    command.add_option("B", options->b, "Likewise").excludes(add_measured_options(command, options->measured));
    command.add_option("--position-limit", options->position_limit_px, "Limit of image position, rms, px")
        .check(kPositiveOption);
    command.add_option("--distortion-limit", options->distortion_limit_percent, "Limit of distortion, rms, %")
        .check(kPositiveOption);
    command.add_option("--vignetting-limit", options->vignetting_limit_ev, "Limit of vignetting, rms, EV")
        .check(kPositiveOption);
    command.add_option("--chromatic-limit", options->chromatic_limit_px, "Limit of chromatic shift, rms, px")
        .check(kPositiveOption);
    command
        .add_option("--points-limit", options->points_limit_um,
                    "Limit of how far a lens images a profile's points from where they are, beyond their noise, um")
        .check(kPositiveOption)
        .type_name("UM");
    add_picture_options(command, options->pictures);
    command.add_option("--f-number", options->f_number, "f-number of a lens").check(kPositiveOption).shows_default();
    command.add_option("--focus", options->focus_mm, "Focus distance of a lens, mm, or inf")
        .check(either(kPositiveOption, one_of({"inf"})))
        .shows_default();
    command.add_option("--response", options->response, "Sensor response behind a lens").shows_default();
    command
        .add_option("--pixel-pitch", options->pixel_pitch_um,
                    "Pixel pitch of a profile that was measured without one, um")
        .check(kPositiveOption)
        .type_name("UM");
    add_common_options(command, options->common);
    command.runs([options] { return run_compare(*options); });
}

}  // namespace lensproof::cli
