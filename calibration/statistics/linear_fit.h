// calibration/statistics/linear_fit.h — weighted linear least squares with outliers, and the covariance of what it
// finds.
#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

namespace lensproof::calibration {

inline constexpr double kRankThreshold = 1e-9;  // of the largest pivot, columns scaled to unit length

/// y ≈ A p. Each row's residual has standard deviation `row_sigma` up to a common factor, which the residuals tell.
struct LinearProblem {
    Eigen::MatrixXd a;
    Eigen::VectorXd y;
    Eigen::VectorXd row_sigma;  // positive
    /// Rows of one group (a point's x and y) are dropped together; empty: every row is its own group.
    std::vector<int> group;
};

struct LinearFit {
    Eigen::VectorXd parameters;
    Eigen::MatrixXd covariance;
    Eigen::VectorXd residuals;  // y − A p, every row
    std::vector<bool> used;
    int rows_used = 0;
    double scale = 0.0;        // the common factor
    double chi_squared = 0.0;  // Σ (residual / row_sigma)² over the rows used
};

/// Least squares by QR. With `outlier_sigmas` > 0, rows are first weighted by Cauchy's function until the scale
/// (median absolute residual) settles; rows beyond that many robust standard deviations are then left out, and the
/// rest is fitted plainly, so that the covariance is the textbook's. The robust scale is taken to be at least
/// `smallest_scale` (in units of row_sigma), so that a fit that is nearly perfect does not call its rest outliers. None
/// when the columns are not independent or the rows not more than the columns.
std::optional<LinearFit> fit_linear(const LinearProblem& problem, double outlier_sigmas, double smallest_scale = 0.0);

/// Akaike's criterion with its small-sample correction (Hurvich & Tsai 1989) of a fit with `parameters` parameters and
/// a scale: n ln(χ²/n) + 2 k n / (n − k − 1), k = parameters + 1. The smallest wins; infinite when there are too few
/// rows to say, finite for a perfect fit.
double aicc(double chi_squared, double rows, double parameters);

}  // namespace lensproof::calibration
