// calibration/geometry/plane_distortion.h — the distortion of pictures of a flat chart, whatever camera took them.
#pragma once
#include <vector>

#include "calibration/geometry/fit_geometry.h"
#include "calibration/statistics/curve.h"

namespace lensproof::calibration {

/// A lens without distortion images a plane by a homography, so what departs from one is distortion, also where the
/// views tell neither focal length nor distance: a chart that faces the camera.
///
///     p = m + h q (1 + k1 |q|² + k2 |q|⁴ + …),   q = the homography of the point on the chart,
///
/// m being the picture's middle and h half its diagonal, px. The homography's scale is that of the picture's middle, so
/// q h is f tan θ of the lens there.
struct PlaneDistortion {
    std::vector<double> coefficients;                   // k1, k2, …
    std::vector<double> covariance;                     // row by row
    std::vector<std::vector<PointResidual>> residuals;  // by view
    double rms_px = 0.0;                                // root of the mean of dx² + dy² over the points used
    int points_used = 0;
    double covered_radius_px = 0.0;  // of the farthest point used, from the picture's middle
};

/// Least squares over the homographies and one to three coefficients, as many as have the least AICc. Points beyond six
/// robust standard deviations are left out. The optical centre is taken to be the picture's middle.
///
/// Throws InputError where the points do not determine it.
PlaneDistortion fit_plane_distortion(const std::vector<ChartView>& views, int width_px, int height_px);

/// 100 (r / (f tan θ) − 1), percent, over the image height r.
Curve distortion_curve(const PlaneDistortion& distortion, double half_diagonal_px);

}  // namespace lensproof::calibration
