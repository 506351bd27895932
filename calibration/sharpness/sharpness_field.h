// calibration/sharpness/sharpness_field.h — sharpness over the picture: tangential, sagittal, and in focus.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "calibration/sharpness/slanted_edge.h"
#include "calibration/statistics/curve.h"

namespace lensproof::calibration {

// An edge shows the blur along its normal only. With φ the angle between normal and radius, the variance of a blur
// along the normal is that along the radius times cos² φ plus that at right angles to it times sin² φ, whatever the
// blur's shape; and 1/MTF50² measures a variance. So edges of every direction take part:
//     1 / MTF50² = a + Σ_j r^2j (t_j cos² φ + s_j sin² φ),   r: image height.
// "Tangential" is along the radius (the meridional plane; lines at right angles to the radius), "sagittal" across it.
// On the axis the two are one, as there the radius has no direction.

/// MTF50 of one channel over the image height.
struct SharpnessField {
    Curve tangential_cycles_per_px;
    Curve sagittal_cycles_per_px;
    Curve tangential_over_sagittal;  // 1: no astigmatism in this focus
    std::vector<std::string> names;  // of the coefficients: "a", "t1", "s1", "t2", …, px²
    std::vector<double> coefficients;
    std::vector<double> covariance;  // row by row
    int edges_used = 0;
    double relative_rms = 0.0;  // of MTF50 about the fit
};

/// Weighted linear least squares without outliers (5 robust standard deviations); the number of terms, 0 to 4 pairs, is
/// the one with the least AICc. Errors scale with the scatter of the edges about the curve, so views in which the chart
/// stood more or less in focus widen the bands.
/// Throws InputError for fewer than six edges with an MTF50.
SharpnessField fit_sharpness_field(const std::vector<EdgeMtf>& edges, const Vec2d& centre_px, double half_diagonal_px);

/// The edges seen with the focus at one position.
struct FocusedEdges {
    double position_mm = 0.0;  // of the lens or the chart, along the axis; any origin and sign
    std::vector<EdgeMtf> edges;
};

/// Field curvature: the position of best focus over the image height, minus that on the axis.
struct BestFocus {
    double axis_position_mm = 0.0;
    double axis_standard_error_mm = 0.0;
    Curve tangential_mm;
    Curve sagittal_mm;
    int edges_used = 0;
};

/// Defocus adds to the blur's variance in proportion to its square, so 1/MTF50² is a parabola of the position z: the
/// coefficients a, t_j, s_j of the field above become quadratic polynomials in z, and best focus is the vertex
/// −c1/(2 c2), its error by the delta method. Edges whose MTF50 is less than a third of the sharpest near the same
/// height say nothing about the vertex and are left out.
/// Throws InputError for fewer than three positions, too few edges, or no focus among the positions.
BestFocus fit_best_focus(const std::vector<FocusedEdges>& series, const Vec2d& centre_px, double half_diagonal_px);

}  // namespace lensproof::calibration
