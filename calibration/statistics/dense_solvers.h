// calibration/statistics/dense_solvers.h — Eigen's decompositions for matrices of any size, compiled once: each takes
// a compiler seconds wherever it is named. Inner loops over small matrices of a fixed size name Eigen's own.
#pragma once
#include <Eigen/Core>

namespace lensproof::calibration {

/// Of a symmetric matrix, of which the lower half is read. NaN where the iteration did not end, as of a matrix with
/// NaN.
struct SymmetricEigen {
    Eigen::VectorXd values;   // ascending
    Eigen::MatrixXd vectors;  // the columns; orthonormal
};

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);

/// X of M X = B for a symmetric M, by L D Lᵀ.
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// X of least norm among those that make A X − B least: of dependent columns, too. B = 1: the pseudo-inverse.
Eigen::MatrixXd least_norm_solution(const Eigen::MatrixXd& design, const Eigen::MatrixXd& right);

}  // namespace lensproof::calibration
