// calibration/profile/profile_line.h — how straight a chart's line is once the model has undistorted it.
#pragma once
#include <vector>

#include "calibration/detection/line_points.h"
#include "calibration/geometry/camera_model.h"
#include "engine/base/json_archive.h"

namespace lensproof::calibration {

/// One line in one picture. A straight line in the scene and the camera lie in a plane, whatever the projection; what
/// the directions of the line's points are off the plane that fits them best, the model does not explain (Devernay &
/// Faugeras 2001, "Straight lines have to be straight"). Points between the chart's crossings were not used to fit the
/// model.
struct ProfileLine {
    bool is_column = false;
    int index = 0;  // of the chart's columns or rows, from 0
    int points = 0;
    double rms_px = 0.0;  // of the distances from the plane's image, across the line, two unknowns counted
    double rms_standard_error_px = 0.0;
    double noise_px = 0.0;  // what the points' own standard errors make that
};

/// Of lines with at least eight points whose directions the model knows; others are left out.
std::vector<ProfileLine> straightness(const std::vector<LinePoints>& lines, const CameraModel& model);

/// `along`: "column" or "row"; the rest as above.
void fields(JsonArchive& json, ProfileLine& line);

}  // namespace lensproof::calibration
