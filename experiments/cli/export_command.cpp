// experiments/cli/export_command.cpp — `lensproof export PROFILE --to FORMAT -o FILE`: a profile for other programs.
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "calibration/export/lensfun.h"
#include "calibration/export/opencv_yaml.h"
#include "calibration/export/robot_camera.h"
#include "calibration/export/st_map.h"
#include "calibration/profile/profile.h"
#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/full_frame.h"
#include "experiments/cli/command.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

namespace fs = std::filesystem;

struct ExportOptions {
    CommonOptions common;
    std::string profile;
    std::string format;
    std::string output;
    double crop_factor = 0.0;  // 0: not given, here and below
    double focal_length_mm = 0.0;
    double f_number = 0.0;
    double focus_distance_m = 1000.0;
    std::string maker;
    std::string lens;
    std::string mount = "Generic";
    std::string lens_type;
    std::string undistorted = "rectilinear";
    double most_overscan_percent = 50.0;
};

/// What was written, and what is to be said of it.
struct Written {
    std::vector<std::string> files;
    std::vector<std::string> notes;
    double largest_difference_px = 0.0;
};

double crop_factor(const ExportOptions& options, const calibration::Profile& profile) {
    if (options.crop_factor > 0.0) {
        return options.crop_factor;
    }
    const auto& notes = profile.source.notes;
    if (notes && !notes->pixel_pitch_um && notes->crop_factor()) {
        return *notes->crop_factor();
    }
    if (profile.pixel_pitch_um) {
        return formats::kFullFrameDiagonal_mm /
               (2.0 * calibration::half_diagonal_px(profile) * *profile.pixel_pitch_um * 1e-3);
    }
    throw InputError(fmt::format(
        "{}: the profile knows no pixel pitch, so the camera's crop factor is unknown: expected --crop-factor",
        options.profile));
}

double focal_length_mm(const ExportOptions& options, const calibration::Profile& profile) {
    if (options.focal_length_mm > 0.0) {
        return options.focal_length_mm;
    }
    if (profile.source.notes && profile.source.notes->focal_length_mm) {
        return *profile.source.notes->focal_length_mm;
    }
    if (profile.pixel_pitch_um && profile.geometry) {
        return calibration::focal_length_px(profile.geometry->model) * *profile.pixel_pitch_um * 1e-3;
    }
    throw InputError(fmt::format(
        "{}: the profile knows no pixel pitch, so the focal length in mm is unknown: expected --focal-length-mm",
        options.profile));
}

Written write_lensfun(const ExportOptions& options, const calibration::Profile& profile) {
    calibration::LensfunOptions lens;
    lens.crop_factor = crop_factor(options, profile);
    lens.focal_length_mm = focal_length_mm(options, profile);
    if (options.f_number > 0.0) {
        lens.f_number = options.f_number;
    } else if (profile.source.notes) {
        lens.f_number = profile.source.notes->f_number;
    }
    lens.focus_distance_m = options.focus_distance_m;
    lens.mount = options.mount;
    const std::string camera_maker = profile.source.notes ? profile.source.notes->make : "";
    lens.maker = !options.maker.empty() ? options.maker : camera_maker.empty() ? "unknown" : camera_maker;
    lens.model = !options.lens.empty() ? options.lens : profile.source.lens.empty() ? "unknown" : profile.source.lens;
    if (!options.lens_type.empty()) {
        lens.type = calibration::ideal_projection(options.lens_type);
    }
    const calibration::LensfunExport result = calibration::lensfun_export(profile, lens);
    write_file(options.output, result.xml);
    return {.files = {options.output}, .notes = result.notes, .largest_difference_px = result.largest_difference_px};
}

Written write_opencv(const ExportOptions& options, const calibration::Profile& profile) {
    const calibration::OpencvExport result = calibration::opencv_export(profile);
    write_file(options.output, result.yaml);
    return {.files = {options.output}, .notes = result.notes, .largest_difference_px = result.largest_difference_px};
}

Written write_robot_camera(const ExportOptions& options, const calibration::Profile& profile) {
    using calibration::RobotProgram;
    const RobotProgram program = options.format == "mrcal" ? RobotProgram::mrcal
                                 : options.format == "ros" ? RobotProgram::ros
                                                           : RobotProgram::kalibr;
    const calibration::RobotCameraExport result = calibration::robot_camera_export(profile, program);
    write_file(options.output, result.text);
    Written written{
        .files = {options.output}, .notes = result.notes, .largest_difference_px = result.largest_difference_px};
    written.notes.insert(written.notes.begin(), result.model);
    return written;
}

/// maps.exr → maps_undistort.exr
fs::path with_suffix(const fs::path& file, const std::string& suffix) {
    return file.parent_path() / (file.stem().string() + suffix + file.extension().string());
}

Written write_st_maps(const ExportOptions& options, const calibration::Profile& profile) {
    if (fs::path(options.output).extension() != ".exr") {
        throw InputError(
            fmt::format("-o {}: ST-maps are EXR files, expected a name that ends in .exr", options.output));
    }
    const calibration::StMaps maps =
        calibration::st_maps(profile, {.undistorted = *calibration::ideal_projection(options.undistorted),
                                       .most_overscan = options.most_overscan_percent / 100.0,
                                       .threads = options.common.threads});
    Written written{.files = {}, .notes = maps.notes};
    for (const auto& [suffix, map] : {std::pair("_undistort", &maps.undistort), std::pair("_distort", &maps.distort)}) {
        const fs::path file = with_suffix(options.output, suffix);
        formats::write_exr(map->image, file, map->placement);
        written.files.push_back(file.string());
    }
    return written;
}

Written write_as(const ExportOptions& options, const calibration::Profile& profile) {
    if (options.format == "lensfun") {
        return write_lensfun(options, profile);
    }
    if (options.format == "opencv") {
        return write_opencv(options, profile);
    }
    return options.format == "stmap" ? write_st_maps(options, profile) : write_robot_camera(options, profile);
}

/// The same; what cannot be exported is said of the profile's file, whose name inside may be a photo's.
Written written_as(const ExportOptions& options, const calibration::Profile& profile) {
    try {
        return write_as(options, profile);
    } catch (const InputError& error) {
        const std::string said = error.what();
        const bool names_what = said.starts_with(options.profile) || said.starts_with("-o ");
        throw InputError(names_what ? said : fmt::format("{}: {}", options.profile, said));
    }
}

int run_export(const ExportOptions& options) {
    check_output_name(options.output);
    check_json_name(options.common);
    const calibration::Profile profile = calibration::read_profile(options.profile);
    const Written written = written_as(options, profile);
    write_json_result(options.common, {{"profile", options.profile},
                                       {"to", options.format},
                                       {"files", written.files},
                                       {"largest_difference_px", written.largest_difference_px},
                                       {"notes", written.notes}});
    if (prints_text(options.common)) {
        for (const std::string& file : written.files) {
            print("{}\n", file);
        }
        for (const std::string& note : written.notes) {
            print("{}\n", note);
        }
    }
    return kDone;
}

}  // namespace

void add_export_command(Program& program) {
    const auto options = std::make_shared<ExportOptions>();
    Command command = program.add_command(
        "export", "Write a measured profile for lensfun, OpenCV, mrcal, ROS, Kalibr or compositing");
    command.footer(
        "Example: lensproof export profile.json --to lensfun --crop-factor 1.53 --focal-length-mm 18 -o lens.xml\n"
        "lensfun: XML for its database. opencv: YAML as cv::FileStorage reads it. stmap: two EXR maps,\n"
        "FILE_undistort.exr and FILE_distort.exr (u and v from 0 to 1, origin at the lower left).\n"
        "mrcal: a .cameramodel. ros: the YAML of a camera_info. kalibr: a camchain.yaml of one camera.");
    command.add_option("PROFILE", options->profile, "A profile that measure wrote").required();
    command.add_option("--to", options->format, "lensfun, opencv, stmap, mrcal, ros or kalibr")
        .required()
        .check(one_of({"lensfun", "opencv", "stmap", "mrcal", "ros", "kalibr"}));
    command.add_option("-o,--output", options->output, "The file to write").required().type_name("FILE");
    command.add_option("--crop-factor", options->crop_factor, "lensfun: the camera's (default: the profile's)")
        .check(kPositiveOption);
    command
        .add_option("--focal-length-mm", options->focal_length_mm,
                    "lensfun: the focal length that the camera notes in its pictures (default: the profile's)")
        .check(kPositiveOption);
    command.add_option("--f-number", options->f_number, "lensfun: the aperture, without which vignetting is left out")
        .check(kPositiveOption);
    command.add_option("--focus-distance-m", options->focus_distance_m, "lensfun: for vignetting")
        .check(kPositiveOption)
        .shows_default();
    command.add_option("--lens-maker", options->maker, "lensfun: who made the lens");
    command.add_option("--lens-model", options->lens, "lensfun: the lens's name (default: the profile's)");
    command.add_option("--mount", options->mount, "lensfun: the mount's name").shows_default();
    const OptionCheck projections = one_of(calibration::ideal_projection_names());
    command
        .add_option("--lens-type", options->lens_type,
                    "lensfun: the projection (default: rectilinear up to 52° from the axis, else the nearest)")
        .check(projections);
    command.add_option("--undistorted", options->undistorted, "stmap: the projection without distortion")
        .check(projections)
        .shows_default();
    command
        .add_option("--overscan-percent", options->most_overscan_percent,
                    "stmap: how far the undistorted picture may reach beyond its frame on each side")
        .check(in_range(0.0, 500.0))
        .shows_default();
    add_common_options(command, options->common);
    command.runs([options] { return run_export(*options); });
}

}  // namespace lensproof::cli
