// calibration/geometry/geometry_curves.h — field angle and distortion over the image height.
#pragma once
#include "calibration/geometry/fit_geometry.h"
#include "calibration/statistics/curve.h"

namespace lensproof::calibration {

/// θ(r), degrees.
Curve field_angle_curve(const GeometryFit& fit, double half_diagonal_px);

/// 100 (r / (f tan θ) − 1), percent: against a lens that keeps straight lines straight. Ends before θ = 89°.
Curve rectilinear_distortion_curve(const GeometryFit& fit, double half_diagonal_px);

/// 100 (r / (f θ) − 1), percent: against an equidistant fisheye.
Curve equidistant_distortion_curve(const GeometryFit& fit, double half_diagonal_px);

// Each is sampled at the standard image heights as far as the model reaches. Bands carry the intrinsics' whole
// covariance to first order; the tangential terms, which have no part in r(θ), are left out.

}  // namespace lensproof::calibration
