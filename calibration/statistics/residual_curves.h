// calibration/statistics/residual_curves.h — what residuals of points do over the frame, and whether they look like
// noise.
#pragma once
#include <vector>

#include "calibration/statistics/curve.h"
#include "engine/base/vec.h"

namespace lensproof::calibration {

/// A point's residual (measured − expected) where it lies, px.
struct PlacedResidual {
    Vec2d at_px;
    Vec2d by_px;
};

/// Means over the points of a bin, with the 95 % bounds that their scatter gives as if each were by itself. Radial is
/// away from the centre, tangential a quarter turn clockwise from it (from right to down). Bins of fewer than
/// kLeastResiduals points are left out; places are the mean of the points'.
struct ResidualCurves {
    double rms_px = 0.0;    // of a coordinate
    double beyond_3 = 0.0;  // fraction of the coordinates beyond three times that; of a Gaussian 0.0027
    Curve density;          // of a coordinate over rms_px, in bins of a quarter from −5 to 5
    Curve radial;           // px, over the image height
    Curve tangential;
    Curve radial_azimuth;  // px, over the azimuth, ° from right to down
    Curve tangential_azimuth;
};

inline constexpr int kLeastResiduals = 8;

/// There is at least one residual, not all of them 0.
ResidualCurves residual_curves(const std::vector<PlacedResidual>& residuals, const Vec2d& centre_px,
                               double half_diagonal_px);

/// The density of a Gaussian of standard deviation 1 where `density` has samples.
Curve gaussian_density(const Curve& density);

/// Root mean square of a coordinate about each of `columns` × `rows` places that stand evenly over the frame from edge
/// to edge, row by row: neighbours count by a Gaussian of three quarters of the places' distance. NaN where they count
/// as fewer than four.
std::vector<double> local_rms_px(const std::vector<PlacedResidual>& residuals, int width_px, int height_px, int columns,
                                 int rows);

}  // namespace lensproof::calibration
