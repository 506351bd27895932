// calibration/detection/refine.h — the exact positions of a chart's points in one channel, in linear light.
#pragma once
#include <optional>
#include <vector>

#include "engine/base/vec.h"
#include "engine/formats/image/image.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// Where a picture shows `feature_points(chart)`, in that order. Where `found[i]` is false the point could not be
/// measured (too near the frame, no contrast, the search ran away) and `image_px[i]` is only the starting value.
struct ChartPoints {
    std::vector<Vec2d> image_px;
    std::vector<bool> found;
    /// Of those that `refine` found, along x and along y: what the picture's noise
    /// (calibration/detection/pixel_noise.h) does to the point, through its fit. What the fit's model does not know is
    /// not in it: of pictures without noise some thousandths of a pixel. None where the window was too small for a fit.
    /// Empty of points not refined.
    std::vector<std::optional<Vec2d>> standard_error_px = {};
};

/// Refines those of `approximate` (from `detect`, or another channel's points) that were found, in one channel.
///
/// Corners: fitted with a model of the two edges (calibration/detection/corner_fit.h), which leaves a ChArUco board's
/// markers out. The window is a part of the distance to the nearest neighbour, so that neither a fisheye's squeezed rim
/// nor a large picture's noise spoils it; one of less than 7 × 7 pixels is too small for the fit and gets
/// cv::cornerSubPix from two starts that must agree. Crossings of lines: the same, with lines for edges. Discs, dots
/// and squares: their centroids (calibration/detection/spot_centroid.h). That is the
/// centroid of the disc's image, not the image of its centre; `fit_geometry` models the difference
/// (`disc_diameter_mm`).
///
/// Tests hold points of synthetic pictures with 1 % noise to 0.02 px rms
/// (tests/calibration/detection/corner_accuracy_test.cpp and calibration_lattice.cpp). `approximate` must have one
/// point per feature.
ChartPoints refine(const formats::Image& image, int channel, const ChartPoints& approximate, const scene::Chart& chart);

/// The diameter of the discs whose images' centroids `refine` measures, mm; of squares, the discs with their second
/// moments; 0 for points.
double disc_diameter_mm(const scene::Chart& chart);

/// How many points were found.
int count_found(const ChartPoints& points);

}  // namespace lensproof::calibration
