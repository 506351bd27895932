#include "calibration/statistics/smoothed_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calibration/statistics/linear_fit.h"

namespace lensproof::calibration {
namespace {

// λ in units that make D'D as large as A'A: from no smoothing that matters to nothing but D's null space.
constexpr int kLeastExponent = -16;  // half decades
constexpr int kMostExponent = 12;
constexpr double kPerfect = 1e-12;  // a mean square this small, in squared sigmas, is rounding
constexpr double kNoWeight = 1e-8;  // of an average

struct Data {
    Eigen::MatrixXd a;  // rows in units of their sigma
    Eigen::VectorXd y;
    Eigen::MatrixXd normal;
    Eigen::MatrixXd penalty;  // D'D, scaled
    Eigen::Index smoothed = 0;
    double free_rows = 0.0;  // rows less the parameters that no penalty touches
    double penalty_rank = 0.0;
};

// The fit for one λ.
struct Single {
    double log_likelihood = 0.0;
    Eigen::VectorXd parameters;
    Eigen::MatrixXd inverse;  // columns of the smoothed parameters
    double effective = 0.0;
    double criterion = 0.0;  // χ² + λ |D p|²
};

Data data_of(const LinearProblem& problem, const Eigen::MatrixXd& differences) {
    const Eigen::VectorXd inverse_sigma = problem.row_sigma.cwiseInverse();
    Data data{.a = inverse_sigma.asDiagonal() * problem.a,
              .y = inverse_sigma.cwiseProduct(problem.y),
              .normal = {},
              .penalty = differences.transpose() * differences,
              .smoothed = differences.cols()};
    data.normal = data.a.transpose() * data.a;
    data.penalty *= data.normal.topLeftCorner(data.smoothed, data.smoothed).trace() / data.penalty.trace();
    data.penalty_rank = static_cast<double>(differences.rows());
    data.free_rows = static_cast<double>(data.a.rows() - data.a.cols() + differences.rows());
    return data;
}

std::optional<Single> fit_with(const Data& data, double lambda) {
    const Eigen::Index count = data.a.cols();
    Eigen::MatrixXd normal = data.normal;
    normal.topLeftCorner(data.smoothed, data.smoothed) += lambda * data.penalty;
    const Eigen::LLT<Eigen::MatrixXd> factor(normal);
    const Eigen::VectorXd pivots = factor.matrixLLT().diagonal();
    const Eigen::VectorXd relative = pivots.cwiseQuotient(normal.diagonal().cwiseSqrt());
    if (factor.info() != Eigen::Success || !(relative.minCoeff() > kRankThreshold)) {
        return std::nullopt;
    }
    Single fit;
    fit.parameters = factor.solve(data.a.transpose() * data.y);
    fit.inverse = factor.solve(Eigen::MatrixXd::Identity(count, data.smoothed));
    const Eigen::MatrixXd shrunk = lambda * fit.inverse.topRows(data.smoothed) * data.penalty;
    fit.effective = static_cast<double>(count) - shrunk.trace();
    const Eigen::VectorXd head = fit.parameters.head(data.smoothed);
    fit.criterion = (data.y - data.a * fit.parameters).squaredNorm() + lambda * head.dot(data.penalty * head) +
                    kPerfect * static_cast<double>(data.a.rows());
    fit.log_likelihood = 0.5 * data.penalty_rank * std::log(lambda) - pivots.array().log().sum() -
                         0.5 * data.free_rows * std::log(fit.criterion);
    return fit;
}

}  // namespace

std::optional<SmoothedFit> fit_smoothed(const LinearProblem& problem, const Eigen::MatrixXd& differences) {
    if (problem.a.rows() <= problem.a.cols() || !problem.a.allFinite() || !problem.y.allFinite()) {
        return std::nullopt;
    }
    const Data data = data_of(problem, differences);
    std::vector<Single> singles;
    for (int exponent = kLeastExponent; exponent <= kMostExponent; ++exponent) {
        if (auto single = fit_with(data, std::pow(10.0, 0.5 * exponent))) {
            singles.push_back(std::move(*single));
        }
    }
    if (singles.empty()) {
        return std::nullopt;
    }
    const double best = std::max_element(singles.begin(), singles.end(), [](const Single& a, const Single& b) {
                            return a.log_likelihood < b.log_likelihood;
                        })->log_likelihood;
    std::vector<double> weight;
    double total = 0.0;
    for (const Single& single : singles) {
        weight.push_back(std::exp(single.log_likelihood - best));
        total += weight.back();
    }
    SmoothedFit fit{.parameters = Eigen::VectorXd::Zero(data.a.cols()), .covariance = {}, .residuals = {}};
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(data.a.cols(), data.smoothed);
    for (std::size_t i = 0; i < singles.size(); ++i) {
        weight[i] /= total;
        fit.parameters += weight[i] * singles[i].parameters;
        inverse += weight[i] * singles[i].inverse;
        fit.effective_parameters += weight[i] * singles[i].effective;
    }
    // How the average moves with each row's y: each fit's own answer, and the weights'.
    Eigen::MatrixXd influence = inverse.transpose() * data.a.transpose();
    for (std::size_t i = 0; i < singles.size(); ++i) {
        if (weight[i] > kNoWeight) {
            const Single& single = singles[i];
            const Eigen::VectorXd apart = (single.parameters - fit.parameters).head(data.smoothed);
            const Eigen::VectorXd own_residuals = data.y - data.a * single.parameters;
            influence -= (weight[i] * data.free_rows / single.criterion * apart) * own_residuals.transpose();
        }
    }
    fit.residuals = problem.y - problem.a * fit.parameters;
    fit.chi_squared = fit.residuals.cwiseQuotient(problem.row_sigma).squaredNorm();
    const double freedom = static_cast<double>(data.a.rows()) - fit.effective_parameters;
    fit.covariance = fit.chi_squared / std::max(freedom, 1.0) * (influence * influence.transpose());
    return fit;
}

}  // namespace lensproof::calibration
