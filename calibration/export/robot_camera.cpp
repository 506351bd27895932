#include "calibration/export/robot_camera.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "calibration/export/covered_frame.h"
#include "calibration/export/opencv_camera.h"
#include "engine/base/json.h"

namespace lensproof::calibration {
namespace {

/// A comment a line; a profile's name may hold anything.
std::string comments(const Profile& profile, const std::vector<std::string>& notes) {
    std::string text = fmt::format("# lensproof export of {}\n", Json(profile.name).dump());
    for (const std::string& note : notes) {
        text += "# " + note + "\n";
    }
    return text;
}

std::string list(const std::vector<double>& values) {
    return fmt::format("[{}]", fmt::join(values, ", "));
}

std::string mrcal_file(const Profile& profile, const RobotCameraExport& result, const std::vector<double>& intrinsics) {
    return fmt::format(
        "{}{{\n    'lensmodel': '{}',\n\n    # fx, fy, cx, cy and the distortion\n    'intrinsics': {},\n\n"
        "    # it stands at the reference\n    'extrinsics': [0, 0, 0, 0, 0, 0],\n\n    'imagersize': [{}, {}],\n}}\n",
        comments(profile, result.notes), result.model, list(intrinsics), profile.width_px, profile.height_px);
}

std::string ros_matrix(const std::string& key, int rows, const std::vector<double>& values) {
    return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: {}\n", key, rows,
                       values.size() / static_cast<std::size_t>(rows), list(values));
}

std::string ros_file(const Profile& profile, const RobotCameraExport& result, const OpencvCamera& camera) {
    const double fx = camera.focal_px;
    const double fy = camera.focal_y_px();
    const auto& [cx, cy] = camera.centre_px;
    return comments(profile, result.notes) +
           fmt::format("image_width: {}\nimage_height: {}\ncamera_name: camera\n", profile.width_px,
                       profile.height_px) +
           ros_matrix("camera_matrix", 3, {fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0}) +
           fmt::format("distortion_model: {}\n", result.model) +
           ros_matrix("distortion_coefficients", 1, camera.distortion) +
           ros_matrix("rectification_matrix", 3, {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) +
           ros_matrix("projection_matrix", 3, {fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0});
}

std::string kalibr_file(const Profile& profile, const RobotCameraExport& result, const OpencvCamera& camera) {
    return comments(profile, result.notes) +
           fmt::format(
               "cam0:\n  camera_model: pinhole\n  intrinsics: {}\n  distortion_model: {}\n  distortion_coeffs: {}\n"
               "  resolution: [{}, {}]\n  rostopic: /cam0/image_raw\n",
               list({camera.focal_px, camera.focal_y_px(), camera.centre_px.x, camera.centre_px.y}),
               camera.fisheye ? "equidistant" : "radtan", list(camera.distortion), profile.width_px, profile.height_px);
}

/// fx, fy, cx, cy of a stereographic profile without distortion; mrcal's focal length is the profile's.
std::optional<std::vector<double>> stereographic(const CameraModel& model) {
    const std::vector<double> p = parameters(model);
    if (kind_name(model) != Stereographic::kind || p[3] != 0.0 || p[4] != 0.0) {
        return std::nullopt;
    }
    return std::vector<double>{p[0], p[0] * (1.0 + stretch_y(model)), p[1], p[2]};
}

OpencvChoices choices_of(RobotProgram program) {
    switch (program) {
        case RobotProgram::mrcal:
            return {.pinhole_coefficients = {4, 5, 8}, .fisheye = false};
        case RobotProgram::ros:
            return {.pinhole_coefficients = {5, 8}, .fisheye = true};
        case RobotProgram::kalibr:
            break;
    }
    return {.pinhole_coefficients = {4}, .fisheye = true};
}

}  // namespace

RobotCameraExport robot_camera_export(const Profile& profile, RobotProgram program) {
    RobotCameraExport result;
    if (program == RobotProgram::mrcal) {
        if (const auto intrinsics = stereographic(exported_geometry(profile).model)) {
            result.model = "LENSMODEL_STEREOGRAPHIC";
            result.notes = {"stereographic, as the profile is"};
            result.text = mrcal_file(profile, result, *intrinsics);
            return result;
        }
    }
    const OpencvCamera camera = opencv_camera(profile, choices_of(program));
    result.largest_difference_px = camera.largest_difference_px;
    result.notes = camera.notes;
    const bool is_rational = camera.distortion.size() > 5;
    switch (program) {
        case RobotProgram::mrcal: {
            result.model = fmt::format("LENSMODEL_OPENCV{}", camera.distortion.size());
            std::vector<double> intrinsics{camera.focal_px, camera.focal_y_px(), camera.centre_px.x,
                                           camera.centre_px.y};
            intrinsics.insert(intrinsics.end(), camera.distortion.begin(), camera.distortion.end());
            result.text = mrcal_file(profile, result, intrinsics);
            break;
        }
        case RobotProgram::ros:
            result.model = camera.fisheye ? "equidistant" : is_rational ? "rational_polynomial" : "plumb_bob";
            result.text = ros_file(profile, result, camera);
            break;
        case RobotProgram::kalibr:
            result.model = camera.fisheye ? "pinhole-equi" : "pinhole-radtan";
            result.text = kalibr_file(profile, result, camera);
            break;
    }
    return result;
}

}  // namespace lensproof::calibration
