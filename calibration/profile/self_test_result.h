// calibration/profile/self_test_result.h — what a profile says of its own floor, as a value and as JSON.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "engine/base/json_archive.h"

namespace lensproof::calibration {

/// How far a measurement of simulated pictures is from what they were made with, over the covered image heights.
struct CurveFloor {
    double rms = 0.0;         // over the picture's area
    double largest = 0.0;     // of the absolute difference, and
    double largest_at = 0.0;  // the image height where it stands
};

/// The profile's own camera, its views, its blur and its noise, made into pictures and measured again by the same
/// method. A difference between a profile and something else that is not larger than this may be the method's. It holds
/// what detector, refinement and fits do, and a draw of the noise; JPEG's compression where the files tell its quality
/// (engine/formats/image/jpeg.h); the board's shape where one was fitted; and light that changes evenly over the chart,
/// as much as it was measured to. It does not hold what the model cannot say, a board whose shape was not asked for, or
/// shadows.
struct SelfTest {
    double point_rms_px = 0.0;   // of one coordinate of a found point
    double point_bias_px = 0.0;  // length of the mean error
    int points = 0;
    int pictures = 0;
    /// The simulated measurement's own reprojection error (as ProfileGeometry's), and how far its focal length is off.
    std::optional<double> reprojection_rms_px = std::nullopt;
    std::optional<double> focal_length_px = std::nullopt;
    /// By the curve's key (calibration/profile/quantity.h), the image position among them. None of sharpness: the
    /// simulated blur is one Gaussian and not the lens's.
    std::map<std::string, CurveFloor> curves;
};

/// The floor of that curve, which lives as long as the test; null where there is none.
const CurveFloor* floor_of(const SelfTest& test, const std::string& curve);

/// One line for people: "points 0.012 px, image position 0.004 px rms, vignetting 0.05 %, chromatic shift 0.006 px",
/// the last two the largest of any channel.
std::string describe_floor(const SelfTest& test);

void fields(JsonArchive& json, CurveFloor& floor);
void fields(JsonArchive& json, SelfTest& test);

}  // namespace lensproof::calibration
