#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "calibration/geometry/bundle.h"
#include "calibration/statistics/dense_solvers.h"

namespace lensproof::calibration {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

constexpr std::size_t kFewestViews = 5;
constexpr double kLeastEigenvalue = 1e-13;  // of a matrix with a unit diagonal: rounding

// One view's part of the normal matrix.
struct ViewNormal {
    Eigen::MatrixXd shared;
    Eigen::MatrixXd mixed;  // shared × pose
    Matrix6 pose = Matrix6::Zero();
    Eigen::VectorXd shared_gradient;
    Eigen::Matrix<double, 6, 1> pose_gradient = Eigen::Matrix<double, 6, 1>::Zero();
};

// What a view adds to the normal equations of the shared parameters that are free, its pose eliminated.
struct ViewPart {
    Eigen::MatrixXd normal;
    Eigen::VectorXd gradient;
};

ViewNormal view_normal(const PointBundle& bundle, const BundleState& state, const std::vector<double>& intrinsics,
                       std::size_t view) {
    const int n = static_cast<int>(intrinsics.size());
    ViewNormal normal{.shared = Eigen::MatrixXd::Zero(n + kBoardTerms, n + kBoardTerms),
                      .mixed = Eigen::MatrixXd::Zero(n + kBoardTerms, 6),
                      .shared_gradient = Eigen::VectorXd::Zero(n + kBoardTerms)};
    const ChartView& points = bundle.views[view];
    RowMajor by_intrinsics(2, n);
    Eigen::Matrix<double, 2, 6, Eigen::RowMajor> by_pose;
    Eigen::Matrix<double, 2, kBoardTerms, Eigen::RowMajor> by_heights;
    RowMajor by_shared(2, n + kBoardTerms);
    for (std::size_t i = 0; i < points.image_px.size(); ++i) {
        if (!bundle.used[view][i]) {
            continue;
        }
        const auto cost = reprojection_cost(kind(state.model), feature(bundle, view, i), bundle.frame);
        const double* blocks[3] = {intrinsics.data(), state.poses[view].data(), state.heights.data()};
        double* jacobians[3] = {by_intrinsics.data(), by_pose.data(), by_heights.data()};
        double values[2];
        if (!cost->Evaluate(blocks, values, jacobians)) {
            continue;
        }
        const double root_weight = std::sqrt(points.weight);
        by_shared << by_intrinsics, by_heights;
        by_shared *= root_weight;
        by_pose *= root_weight;
        normal.shared += by_shared.transpose() * by_shared;
        normal.mixed += by_shared.transpose() * by_pose;
        normal.pose += by_pose.transpose() * by_pose;
        const Eigen::Vector2d residual = root_weight * Eigen::Map<const Eigen::Vector2d>(values);
        normal.shared_gradient += by_shared.transpose() * residual;
        normal.pose_gradient += by_pose.transpose() * residual;
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

// Columns scaled to unit length by `size`, so that ranks mean something: a combination of terms that the points say
// nothing about gets an error that is huge rather than infinite. None for numbers that are not finite.
std::optional<Eigen::MatrixXd> inverse_of(const Eigen::MatrixXd& normal, const Eigen::VectorXd& size) {
    const auto [values, vectors] = symmetric_eigen(size.asDiagonal() * normal * size.asDiagonal());
    if (!values.allFinite()) {
        return std::nullopt;
    }
    const Eigen::VectorXd eigenvalues = values.cwiseMax(kLeastEigenvalue);
    return size.asDiagonal() * vectors * eigenvalues.cwiseInverse().asDiagonal() * vectors.transpose() *
           size.asDiagonal();
}

// How far the solution moves when each view is left out: δ = (N − N_v)⁻¹ g_v, the least squares' own step.
std::optional<Eigen::MatrixXd> jackknife(const std::vector<ViewPart>& views, const Eigen::MatrixXd& reduced,
                                         const Eigen::VectorXd& size) {
    Eigen::MatrixXd steps(reduced.rows(), static_cast<Eigen::Index>(views.size()));
    for (std::size_t v = 0; v < views.size(); ++v) {
        const auto inverse = inverse_of(reduced - views[v].normal, size);
        if (!inverse) {
            return std::nullopt;
        }
        steps.col(static_cast<Eigen::Index>(v)) = *inverse * views[v].gradient;
    }
    const Eigen::VectorXd mean = steps.rowwise().mean();
    steps.colwise() -= mean;
    const auto count = static_cast<double>(views.size());
    return (count - 1.0) / count * steps * steps.transpose();
}

}  // namespace

// The inverse of the shared parameters' normal matrix after the poses have been eliminated view by view (Schur
// complement).
std::optional<BundleInformation> information(const PointBundle& bundle, const BundleState& state, const Held& held) {
    const std::vector<double> intrinsics = parameters(state.model);
    const int count = static_cast<int>(intrinsics.size()) + kBoardTerms;
    const std::vector<int> free = free_parameters(held, static_cast<int>(intrinsics.size()));
    const int n = static_cast<int>(free.size());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    Eigen::MatrixXd reduced = Eigen::MatrixXd::Zero(n, n);
    BundleInformation result;
    result.shared = count;
    std::vector<ViewPart> parts;
    for (std::size_t v = 0; v < bundle.views.size(); ++v) {
        const ViewNormal own = view_normal(bundle, state, intrinsics, v);
        // Of what the view says nothing about, a translation of directions, 0.
        const Eigen::Matrix<double, 6, 1> size =
            own.pose.diagonal().unaryExpr([](double square) { return square > 0.0 ? 1.0 / std::sqrt(square) : 0.0; });
        const Matrix6 scaled = size.asDiagonal() * own.pose * size.asDiagonal();
        const Matrix6 inverse =
            size.asDiagonal() * Matrix6(least_norm_solution(scaled, Matrix6::Identity())) * size.asDiagonal();
        const Eigen::MatrixXd own_mixed = own.mixed(free, Eigen::all);
        const Eigen::MatrixXd own_shared = own.shared(free, free);
        normal += own_shared;
        parts.push_back({own_shared - own_mixed * inverse * own_mixed.transpose(),
                         own.shared_gradient(free) - own_mixed * inverse * own.pose_gradient});
        reduced += parts.back().normal;
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
    const auto inverse = inverse_of(reduced, size);
    if (!inverse) {
        return std::nullopt;
    }
    covariance(free, free) = *inverse;
    if (const auto scatter = parts.size() >= kFewestViews ? jackknife(parts, reduced, size) : std::nullopt) {
        result.view_covariance.assign(result.shared_covariance.size(), 0.0);
        Eigen::Map<RowMajor>(result.view_covariance.data(), count, count)(free, free) = *scatter;
    }
    return result;
}

}  // namespace lensproof::calibration
