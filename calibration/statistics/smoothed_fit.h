// calibration/statistics/smoothed_fit.h — weighted linear least squares with a part that is smooth, how smooth being
// told by the data.
#pragma once
#include <Eigen/Core>
#include <optional>

#include "calibration/statistics/linear_fit.h"

namespace lensproof::calibration {

struct SmoothedFit {
    Eigen::VectorXd parameters;
    Eigen::MatrixXd covariance;         // of the smoothed parameters, which are the first
    Eigen::VectorXd residuals;          // y − A p
    double effective_parameters = 0.0;  // trace of the map from data to fitted values: what the fit costs in freedom
    double chi_squared = 0.0;           // Σ (residual / row_sigma)²
};

/// Minimises χ² + λ |D p|², D the `differences` of the first D.cols() parameters (Eilers & Marx 1996, "Flexible
/// smoothing with B-splines and penalties"). λ is not chosen: fits over fourteen decades of it are averaged by their
/// restricted likelihoods (Wood 2011, J. R. Stat. Soc. B 73, 3, eq. 4, the scale profiled), so that no choice hides in
/// the errors. The covariance is the scatter of this average over repeated data, with what the weights of the average
/// scatter (the delta method: Efron 2015, J. R. Stat. Soc. B 77, 617, theorem 1); the scale is the residuals' own.
/// D's rows must be independent. Roughness that the data do not show is smoothed away, and that bias is not in the
/// covariance.
///
/// None when the rows are fewer than the parameters or do not determine those that are not smoothed.
std::optional<SmoothedFit> fit_smoothed(const LinearProblem& problem, const Eigen::MatrixXd& differences);

}  // namespace lensproof::calibration
