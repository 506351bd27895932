// calibration/lines/line_distortion.h — the distortion of pictures in which something is straight, whatever it is.
#pragma once
#include <string>
#include <vector>

#include "calibration/lines/plumb_line.h"
#include "calibration/lines/scene_line.h"
#include "calibration/statistics/curve.h"

namespace lensproof::calibration {

/// What lines tell of the lens: tan θ over r but for a factor, since planes through the camera stay planes where every
/// tan θ grows alike. So the curve is counted from the slope of r on the axis, as the distortion of a chart is, and no
/// angle is told, of a fisheye neither.
struct LineDistortion {
    PlumbKind kind = PlumbKind::perspective;
    std::vector<std::string> names;  // of the terms: k1, …, or phi, b1, …; centre_x_px, centre_y_px
    std::vector<double> values;
    std::vector<double> covariance;  // row by row
    Vec2d centre_px;
    bool centre_is_told = false;  // by the lines; else it is near the middle because lenses' are
    double covered_image_height = 0.0;
    int used = 0;
    int left_out = 0;
    double rms_px = 0.0;  // of all points used, two unknowns a line counted
    Curve distortion;     // 100 (r / (f tan θ) − 1), percent
};

/// Fewer say nothing of how sure they are.
inline constexpr int kFewestLines = 6;

/// Finds the lens under which most of the lines' length is straight, leaves out the lines that it does not straighten
/// (in `lines`: `used`, `rms_px`, `bow_px`, `residual_px`), and takes as many terms, two or three, as predict the
/// bend of lines that were not fitted best (calibration/lines/plumb_fit.h). A fisheye's law is taken where it leaves
/// more of the lines straight than a perspective one.
///
/// Bounds are 95 %: those of the fit by Student's t, and beside them what one more term would change. The curve is
/// measured as far out as three lines reach, and a fisheye's to 90° at most.
///
/// Throws InputError, saying what is missing, where fewer than six lines are left, no lens straightens half of the
/// length, the lines lie in one part of the frame, bend about a centre far from its middle, or do not bend with
/// distortion (all run through the middle).
LineDistortion fit_line_distortion(std::vector<SceneLine>& lines, int width_px, int height_px);

}  // namespace lensproof::calibration
