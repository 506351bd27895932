#include <ceres/cost_function.h>

#include <Eigen/Dense>
#include <algorithm>

#include "calibration/geometry/bundle.h"

namespace lensproof {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

constexpr double kLeastEigenvalue = 1e-13;  // of a matrix with a unit diagonal: rounding

// One view's part of the normal matrix.
struct ViewNormal {
    Eigen::MatrixXd shared;
    Eigen::MatrixXd mixed;  // shared × pose
    Matrix6 pose = Matrix6::Zero();
};

ViewNormal view_normal(const PointBundle& bundle, const BundleState& state, const std::vector<double>& intrinsics,
                       std::size_t view) {
    const int n = static_cast<int>(intrinsics.size());
    ViewNormal normal{.shared = Eigen::MatrixXd::Zero(n + kBoardTerms, n + kBoardTerms),
                      .mixed = Eigen::MatrixXd::Zero(n + kBoardTerms, 6)};
    const ChartView& points = bundle.views[view];
    RowMajor by_intrinsics(2, n);
    Eigen::Matrix<double, 2, 6, Eigen::RowMajor> by_pose;
    Eigen::Matrix<double, 2, kBoardTerms, Eigen::RowMajor> by_heights;
    RowMajor by_shared(2, n + kBoardTerms);
    for (std::size_t i = 0; i < points.image_px.size(); ++i) {
        if (!bundle.used[view][i]) {
            continue;
        }
        const auto cost = reprojection_cost(
            kind(state.model), {points.chart_mm[i], points.image_px[i], bundle.disc_diameter_mm}, bundle.frame);
        const double* blocks[3] = {intrinsics.data(), state.poses[view].data(), state.heights.data()};
        double* jacobians[3] = {by_intrinsics.data(), by_pose.data(), by_heights.data()};
        double values[2];
        if (!cost->Evaluate(blocks, values, jacobians)) {
            continue;
        }
        by_shared << by_intrinsics, by_heights;
        normal.shared += by_shared.transpose() * by_shared;
        normal.mixed += by_shared.transpose() * by_pose;
        normal.pose += by_pose.transpose() * by_pose;
    }
    return normal;
}

std::vector<int> free_parameters(const Held& held, int intrinsics) {
    std::vector<int> indices;
    for (int i = 0; i < intrinsics + (held.heights ? 0 : kBoardTerms); ++i) {
        if (i >= intrinsics || !std::binary_search(held.intrinsics.begin(), held.intrinsics.end(), i)) {
            indices.push_back(i);
        }
    }
    return indices;
}

}  // namespace

// The inverse of the shared parameters' normal matrix after the poses have been eliminated view by view (Schur
// complement), columns scaled to unit length so that ranks mean something.
std::optional<BundleInformation> information(const PointBundle& bundle, const BundleState& state, const Held& held) {
    const std::vector<double> intrinsics = parameters(state.model);
    const int count = static_cast<int>(intrinsics.size()) + kBoardTerms;
    const std::vector<int> free = free_parameters(held, static_cast<int>(intrinsics.size()));
    const int n = static_cast<int>(free.size());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    Eigen::MatrixXd reduced = Eigen::MatrixXd::Zero(n, n);
    BundleInformation result;
    result.shared = count;
    for (std::size_t v = 0; v < bundle.views.size(); ++v) {
        const ViewNormal own = view_normal(bundle, state, intrinsics, v);
        const Eigen::Matrix<double, 6, 1> size = own.pose.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
        const Matrix6 scaled = size.asDiagonal() * own.pose * size.asDiagonal();
        const Matrix6 inverse =
            size.asDiagonal() * Matrix6(scaled.completeOrthogonalDecomposition().pseudoInverse()) * size.asDiagonal();
        const Eigen::MatrixXd own_mixed = own.mixed(free, Eigen::all);
        const Eigen::MatrixXd own_shared = own.shared(free, free);
        normal += own_shared;
        reduced += own_shared - own_mixed * inverse * own_mixed.transpose();
        BundleInformation::View view;
        Eigen::Map<Matrix6>(view.pose_covariance.data()) = inverse;
        view.pose_follows.resize(static_cast<std::size_t>(6) * count);
        Eigen::Map<RowMajor>(view.pose_follows.data(), 6, count) = -inverse * own.mixed.transpose();
        result.views.push_back(std::move(view));
    }
    result.shared_covariance.assign(static_cast<std::size_t>(count) * count, 0.0);
    if (n == 0) {
        return result;
    }
    Eigen::Map<RowMajor> covariance(result.shared_covariance.data(), count, count);
    const Eigen::VectorXd size = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = size.asDiagonal() * reduced * size.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
    if (eigen.info() != Eigen::Success) {
        return std::nullopt;
    }
    // A combination of terms that the points say nothing about gets an error that is huge rather than infinite.
    const Eigen::VectorXd eigenvalues = eigen.eigenvalues().cwiseMax(kLeastEigenvalue);
    const Eigen::MatrixXd inverse = size.asDiagonal() * eigen.eigenvectors() * eigenvalues.cwiseInverse().asDiagonal() *
                                    eigen.eigenvectors().transpose() * size.asDiagonal();
    covariance(free, free) = inverse;
    return result;
}

}  // namespace lensproof
