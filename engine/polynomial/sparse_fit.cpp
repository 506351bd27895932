#include "engine/polynomial/sparse_fit.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace lensproof::polynomial {

namespace {

/// A column of which less than this is left, of its square, is a combination of those chosen.
constexpr double kDependent = 1e-9;

double rms_of(double squares, Eigen::Index rows, std::size_t terms) {
    return std::sqrt(std::max(squares, 0.0) /
                     static_cast<double>(std::max<Eigen::Index>(1, rows - static_cast<Eigen::Index>(terms))));
}

/// The columns in the order of their choice.
std::vector<Eigen::Index> chosen_columns(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, double wanted,
                                         int most_terms) {
    Eigen::MatrixXd left = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
    left.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
    left.triangularView<Eigen::StrictlyUpper>() = left.transpose();
    Eigen::VectorXd along = columns.transpose() * target;  // of the target's rest
    const Eigen::VectorXd whole = left.diagonal();
    double squares = target.squaredNorm();
    std::vector<Eigen::Index> chosen;
    std::vector<bool> is_chosen(static_cast<std::size_t>(columns.cols()), false);
    while (static_cast<int>(chosen.size()) < most_terms && rms_of(squares, columns.rows(), chosen.size()) > wanted) {
        Eigen::Index best = -1;
        double most = 0.0;
        for (Eigen::Index i = 0; i < columns.cols(); ++i) {
            const double gain = along[i] * along[i] / left(i, i);
            if (!is_chosen[static_cast<std::size_t>(i)] && left(i, i) > kDependent * whole[i] && gain > most) {
                best = i;
                most = gain;
            }
        }
        if (best < 0) {
            break;
        }
        chosen.push_back(best);
        is_chosen[static_cast<std::size_t>(best)] = true;
        const Eigen::VectorXd direction = left.col(best) / std::sqrt(left(best, best));
        const double part = along[best] / std::sqrt(left(best, best));
        along -= part * direction;
        left -= direction * direction.transpose();
        squares -= part * part;
    }
    return chosen;
}

}  // namespace

SparseFit sparse_fit(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, double wanted, int most_terms) {
    SparseFit fit{.terms = chosen_columns(columns, target, wanted, most_terms)};
    Eigen::MatrixXd matrix(columns.rows(), static_cast<Eigen::Index>(fit.terms.size()));
    for (std::size_t i = 0; i < fit.terms.size(); ++i) {
        matrix.col(static_cast<Eigen::Index>(i)) = columns.col(fit.terms[i]);
    }
    if (fit.terms.empty()) {
        fit.rms = rms_of(target.squaredNorm(), target.size(), 0);
        return fit;
    }
    fit.coefficients = matrix.householderQr().solve(target);
    fit.rms = rms_of((target - matrix * fit.coefficients).squaredNorm(), target.size(), fit.terms.size());
    return fit;
}

}  // namespace lensproof::polynomial
