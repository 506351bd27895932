// calibration/export/opencv_yaml.h — a profile's camera model as OpenCV's own calibration file.
#pragma once
#include <string>
#include <vector>

#include "calibration/profile/profile.h"

namespace lensproof::calibration {

struct OpencvExport {
    std::string yaml;
    /// "pinhole" with 5 or 8 distortion coefficients (cv::projectPoints), or "fisheye" with 4 (cv::fisheye).
    std::string model;
    std::vector<double> distortion;
    double largest_difference_px = 0.0;  // over the covered frame, as OpenCV itself projects
    std::vector<std::string> notes;
};

/// A cv::FileStorage YAML with image_width, image_height, model, fisheye_model (1 or 0, as OpenCV's samples have it),
/// camera_matrix (3 × 3, doubles), distortion_coefficients (a row of k1 k2 p1 p2 k3 [k4 k5 k6], or of cv::fisheye's
/// k1 k2 k3 k4), avg_reprojection_error and largest_difference_px. OpenCV's pixels are the profile's: the centre of the
/// top-left pixel is (0, 0).
///
/// A Brown-Conrady or Kannala-Brandt profile is written as it is. Any other is fitted by all three models, and the
/// closest is written (`opencv_camera`, which says how, and what it throws).
OpencvExport opencv_export(const Profile& profile);

}  // namespace lensproof::calibration
