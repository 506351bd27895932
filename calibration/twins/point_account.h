// calibration/twins/point_account.h — why points lie elsewhere in photos than in the twins rendered of them: the lens,
// the chart, or the measurement.
#pragma once
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "calibration/statistics/curve.h"
#include "engine/base/json_archive.h"
#include "engine/base/vec.h"

namespace lensproof::calibration {

/// A point of the chart in a photo and in its twin, measured in both by the same detector.
struct TwinPoint {
    int view = 0;
    int feature = 0;  // which of the chart's points
    Vec2d photo_px;
    Vec2d twin_px;
    /// Of their difference along x and y, from the pictures' noise; none where it is not known.
    std::optional<Vec2d> standard_error_px;
    /// Where the twin's picture of it goes by a millimetre along the chart's x and y, px.
    Vec2d by_chart_x_px;
    Vec2d by_chart_y_px;
};

/// A part of all displacements: root mean square of a coordinate, px, what noise adds taken out.
struct TwinDisplacement {
    double rms_px = std::nan("");
    double standard_error_px = 0.0;
    double significance = 0.0;  // its mean square a degree of freedom over that of what remains (F)
};

/// What the displacements (photo − twin) are made of. What eight terms a view can express (that the chart stands
/// elsewhere, calibration/comparison/warp.h) belongs to no one. Of what is left,
///
///   lens   is the same at the same place of the frame in every photo: a polynomial of the place of fifth degree,
///          third for fewer than 200 points;
///   chart  is the same at the same point of the chart, wherever the frame shows it (misprinted, not flat);
///   rest   repeats in neither way: noise, and what changed between the photos.
///
/// By least squares, one after the other in that order, each with its degrees of freedom.
struct PointAccount {
    int points = 0;
    int views = 0;
    double displaced_px = 0.0;  // rms of a coordinate, as measured
    TwinDisplacement lens;
    TwinDisplacement chart;      // NaN for fewer than three views: it cannot be told from the lens
    double rest_px = 0.0;        // standard deviation of a coordinate
    double expected_px = 0.0;    // rms of the points' standard errors where they are known; NaN: of none
    Curve radial_px{};           // what the lens does along the radius, over the image height
    std::vector<Vec2d> lens_px;  // the lens's part at each point
};

/// `width_px`, `height_px`: of the frame. At least ten points, and of every view four.
PointAccount account_of_points(const std::vector<TwinPoint>& points, int width_px, int height_px);

/// Where a picture goes by a millimetre along the chart's x, and along its y, px: of the plane through the nine points
/// nearest to `at_mm` of those that are imaged at `image_px`.
std::array<Vec2d, 2> steps_on_chart(const std::vector<Vec2d>& chart_mm, const std::vector<Vec2d>& image_px,
                                    const Vec2d& at_mm);

void fields(JsonArchive& json, TwinPoint& point);

}  // namespace lensproof::calibration
