#include "calibration/statistics/dense_solvers.h"

#include <Eigen/Dense>
#include <limits>

namespace lensproof::calibration {

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
    if (solver.info() != Eigen::Success) {
        constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
        return {Eigen::VectorXd::Constant(matrix.rows(), kNan),
                Eigen::MatrixXd::Constant(matrix.rows(), matrix.cols(), kNan)};
    }
    return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
    return matrix.ldlt().solve(right);
}

Eigen::MatrixXd least_norm_solution(const Eigen::MatrixXd& design, const Eigen::MatrixXd& right) {
    return design.completeOrthogonalDecomposition().solve(right);
}

}  // namespace lensproof::calibration
