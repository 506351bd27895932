// calibration/export/opencv_camera.h — a profile's camera model as one of OpenCV's, which robots' programs have too.
#pragma once
#include <string>
#include <vector>

#include "calibration/profile/profile.h"

namespace lensproof::calibration {

/// A camera of cv::projectPoints or cv::fisheye. The centre of the top-left pixel is (0, 0).
struct OpencvCamera {
    bool fisheye = false;
    double focal_px = 0.0;
    double stretch_y = 0.0;  // the vertical focal length over the horizontal one, less 1
    Vec2d centre_px;
    std::vector<double> distortion;      // k1 k2 p1 p2 [k3 [k4 k5 k6]], or k1 k2 k3 k4 of a fisheye
    double largest_difference_px = 0.0;  // from the profile's model, over the covered frame
    std::vector<std::string> notes;      // that in words, and what part of the frame it is not of

    [[nodiscard]] double focal_y_px() const { return focal_px * (1.0 + stretch_y); }
};

/// Which of them a program knows: pinholes with so many coefficients (rising), and the fisheye.
struct OpencvChoices {
    std::vector<std::size_t> pinhole_coefficients;
    bool fisheye = false;
};

/// A Brown-Conrady or Kannala-Brandt profile as it is, where the choices have its model. Any other is fitted by all of
/// them over the covered frame (linear least squares in px; the rational one by iterated reweighting after Sanathanan &
/// Koerner 1963), and the closest is taken. Throws InputError for a profile without geometry, and where none follows
/// it.
OpencvCamera opencv_camera(const Profile& profile, const OpencvChoices& choices);

}  // namespace lensproof::calibration
