#include "calibration/statistics/linear_fit.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "engine/base/order_statistics.h"

namespace lensproof::calibration {
namespace {

constexpr int kReweightings = 20;
constexpr double kSettled = 1e-4;       // of the scale
constexpr double kCauchyWidth = 2.385;  // in sigmas: 95 % efficient for normal residuals (Holland & Welsch 1977)

struct Solution {
    Eigen::VectorXd parameters;
    Eigen::MatrixXd unit_covariance;
};

std::optional<Solution> solve(const LinearProblem& problem, const Eigen::VectorXd& weight) {
    const Eigen::VectorXd row = weight.cwiseSqrt().cwiseQuotient(problem.row_sigma);
    const Eigen::MatrixXd weighted = row.asDiagonal() * problem.a;
    const Eigen::VectorXd size = weighted.colwise().norm();
    if (!(size.minCoeff() > 0.0) || !size.allFinite()) {
        return std::nullopt;
    }
    const Eigen::VectorXd inverse_size = size.cwiseInverse();
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(weighted * inverse_size.asDiagonal());
    qr.setThreshold(kRankThreshold);
    const Eigen::Index n = problem.a.cols();
    if (qr.rank() < n) {
        return std::nullopt;
    }
    const Eigen::VectorXd scaled = qr.solve(row.cwiseProduct(problem.y));
    const Eigen::MatrixXd r_inverse =
        qr.matrixR().topLeftCorner(n, n).triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n));
    const Eigen::MatrixXd spread = qr.colsPermutation() * r_inverse;
    return Solution{inverse_size.cwiseProduct(scaled),
                    inverse_size.asDiagonal() * (spread * spread.transpose()) * inverse_size.asDiagonal()};
}

Eigen::VectorXd normalized_residuals(const LinearProblem& problem, const Eigen::VectorXd& parameters) {
    return (problem.y - problem.a * parameters).cwiseQuotient(problem.row_sigma);
}

double robust_scale(const Eigen::VectorXd& residuals) {
    std::vector<double> magnitudes(static_cast<std::size_t>(residuals.size()));
    std::transform(residuals.begin(), residuals.end(), magnitudes.begin(), [](double r) { return std::abs(r); });
    return kSigmaPerMedian * median(magnitudes);
}

// 1 for rows that belong to the bulk, 0 for outliers and the rows of their group.
std::optional<Eigen::VectorXd> inliers(const LinearProblem& problem, double outlier_sigmas, double smallest_scale) {
    const Eigen::Index rows = problem.a.rows();
    Eigen::VectorXd weight = Eigen::VectorXd::Ones(rows);
    Eigen::VectorXd residuals;
    double scale = 0.0;
    for (int i = 0; i < kReweightings; ++i) {
        const auto solution = solve(problem, weight);
        if (!solution) {
            return std::nullopt;
        }
        residuals = normalized_residuals(problem, solution->parameters);
        const double last = scale;
        scale = std::max(robust_scale(residuals), smallest_scale);
        if (!(scale > 0.0)) {
            return Eigen::VectorXd(Eigen::VectorXd::Ones(rows));
        }
        weight = (1.0 + (residuals / (kCauchyWidth * scale)).array().square()).inverse().matrix();
        if (std::abs(scale - last) < kSettled * scale) {
            break;
        }
    }
    std::map<int, bool> outlying;
    for (Eigen::Index i = 0; i < rows; ++i) {
        const int group = problem.group.empty() ? static_cast<int>(i) : problem.group[static_cast<std::size_t>(i)];
        outlying[group] = outlying[group] || !(std::abs(residuals(i)) <= outlier_sigmas * scale);
    }
    for (Eigen::Index i = 0; i < rows; ++i) {
        weight(i) = outlying[problem.group.empty() ? static_cast<int>(i) : problem.group[static_cast<std::size_t>(i)]]
                        ? 0.0
                        : 1.0;
    }
    return weight;
}

}  // namespace

std::optional<LinearFit> fit_linear(const LinearProblem& problem, double outlier_sigmas, double smallest_scale) {
    if (problem.a.rows() <= problem.a.cols() || problem.a.cols() == 0 || !problem.a.allFinite() ||
        !problem.y.allFinite()) {
        return std::nullopt;
    }
    Eigen::VectorXd weight = Eigen::VectorXd::Ones(problem.a.rows());
    if (outlier_sigmas > 0.0) {
        const auto bulk = inliers(problem, outlier_sigmas, smallest_scale);
        if (!bulk) {
            return std::nullopt;
        }
        weight = *bulk;
    }
    const auto solution = solve(problem, weight);
    const double rows_used = weight.sum();
    const double freedom = rows_used - static_cast<double>(problem.a.cols());
    if (!solution || freedom < 1.0) {
        return std::nullopt;
    }
    LinearFit fit;
    fit.parameters = solution->parameters;
    fit.residuals = problem.y - problem.a * fit.parameters;
    fit.chi_squared = weight.dot(normalized_residuals(problem, fit.parameters).cwiseAbs2());
    fit.scale = std::sqrt(fit.chi_squared / freedom);
    fit.covariance = fit.scale * fit.scale * solution->unit_covariance;
    fit.rows_used = static_cast<int>(std::lround(rows_used));
    for (const double w : weight) {
        fit.used.push_back(w > 0.0);
    }
    return fit;
}

double aicc(double chi_squared, double rows, double parameters) {
    const double k = parameters + 1.0;
    if (rows <= k + 1.0) {
        return std::numeric_limits<double>::infinity();
    }
    return rows * std::log(std::max(chi_squared / rows, 1e-20)) + 2.0 * k * rows / (rows - k - 1.0);
}

}  // namespace lensproof::calibration
