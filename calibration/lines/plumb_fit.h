// calibration/lines/plumb_fit.h — the lens that leaves lines straight, and how sure that is.
#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibration/lines/plumb_line.h"
#include "calibration/lines/scene_line.h"

namespace lensproof::calibration {

/// A line's points from the picture's middle in half diagonals, y downwards, and what one of them is known to.
struct PlumbLine {
    std::vector<Vec2d> points;
    double sigma = 0.0;  // half diagonals
};

struct PlumbModel {
    PlumbKind kind = PlumbKind::perspective;
    int terms = 1;  // of the shape that are not held at 0
    std::array<double, kShapeTerms> shape{};
    Vec2d centre;
};

/// What a line's points are off the straight line that fits them best under a model.
struct Straightness {
    std::vector<double> residual;  // half diagonals, positive to the left of the way from the first point to the last
    double rms = 0.0;              // two unknowns counted
    double bow = 0.0;              // root mean square of the part that is a bend or an S
};
Straightness straightened(const PlumbModel& model, const PlumbLine& line);

/// A fit of some lines. Parameters are the shape's terms and the centre's x and y.
struct PlumbFit {
    PlumbModel model;
    Eigen::MatrixXd covariance;
    /// Of each line that was used: mean square of its residuals over its sigma² with the others' parameters.
    std::vector<double> held_out;
    /// What the covariance's degrees of freedom follow from.
    std::vector<Eigen::MatrixXd> influence;  // by line, (1 − S M)⁻¹ S (1 − M S)⁻¹
    std::vector<Eigen::MatrixXd> reach;      // by line, S (1 − M S)⁻¹ M
    Eigen::MatrixXd inverse;                 // M
};

/// Least squares (Ceres; every line's own two unknowns are eliminated) from `start`.
///
/// A line's points share its faults (a board that is not straight, an edge whose sides differ, a rounding of pixels
/// that repeats), so that the line is the unit: the covariance is M (Σ u uᵀ + Λ) M, M the inverse of the normal matrix
/// with the prior's Λ, u = (1 − S M)⁻¹ Aᵀ e of each line (A its rows without what its own unknowns explain, S = Aᵀ A):
/// the jackknife over lines (MacKinnon & White 1985's HC3 for clusters). None where the lines do not determine it.
std::optional<PlumbFit> fit_plumb_lines(const std::vector<PlumbLine>& lines, const PlumbModel& start);

/// Degrees of freedom of gᵀ covariance g: of the chi-squared whose mean and variance it has, were all points by
/// themselves (Bell & McCaffrey 2002), the prior having infinitely many.
double freedom_of(const PlumbFit& fit, const Eigen::VectorXd& gradient);

}  // namespace lensproof::calibration
