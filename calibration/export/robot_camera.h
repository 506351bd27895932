// calibration/export/robot_camera.h — a profile's camera model in the files of mrcal, ROS and Kalibr.
#pragma once
#include <string>
#include <vector>

#include "calibration/profile/profile.h"

namespace lensproof::calibration {

enum class RobotProgram { mrcal, ros, kalibr };

struct RobotCameraExport {
    std::string text;
    std::string model;                   // as the program names it
    double largest_difference_px = 0.0;  // from the profile's own model, over the covered frame
    std::vector<std::string> notes;
};

/// - mrcal: a .cameramodel (version 2.2; later ones read it): LENSMODEL_OPENCV4, 5 or 8, or LENSMODEL_STEREOGRAPHIC for
///   a stereographic profile without distortion. It has no other fisheye with a formula.
/// - ROS: what camera_calibration_parsers reads (sensor_msgs/CameraInfo): plumb_bob, rational_polynomial or
/// equidistant;
///   no rectification, and the camera matrix for the projection's.
/// - Kalibr: a camchain with one camera, pinhole-radtan (four coefficients) or pinhole-equi.
///
/// A model that the program has is written as it is; another is fitted (`opencv_camera`), with the difference in the
/// file. All count pixels from the centre of the top-left one, as the profile does. Throws InputError as
/// `opencv_camera` does.
RobotCameraExport robot_camera_export(const Profile& profile, RobotProgram program);

}  // namespace lensproof::calibration
