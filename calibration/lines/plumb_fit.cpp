#include "calibration/lines/plumb_fit.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/jet.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace lensproof::calibration {
namespace {

using Eigen::Index;

constexpr int kLineSteps = 3;  // from the directions' plane, which is nearly it

// A plane near another: its normal is n + a u + b v.
struct PlaneFrame {
    Eigen::Vector3d n;
    Eigen::Vector3d u;
    Eigen::Vector3d v;
};

PlaneFrame frame_about(const Eigen::Vector3d& normal) {
    const Eigen::Vector3d n = normal.normalized();
    const Eigen::Vector3d other = std::abs(n.z()) < 0.7 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
    const Eigen::Vector3d u = n.cross(other).normalized();
    return {n, u, n.cross(u)};
}

template <class T>
T residual_of(PlumbKind kind, const T* shape, const T* centre, const PlaneFrame& frame, const T* own, const Vec2d& p) {
    T normal[3];
    for (int i = 0; i < 3; ++i) {
        normal[i] = T(frame.n[i]) + own[0] * frame.u[i] + own[1] * frame.v[i];
    }
    return plumb_residual(kind, shape, centre, normal, p);
}

struct PlumbCost {
    PlumbKind kind;
    PlaneFrame frame;
    Vec2d point;
    double sigma;

    template <class T>
    bool operator()(const T* shape, const T* centre, const T* own, T* residual) const {
        residual[0] = residual_of(kind, shape, centre, frame, own, point) / T(sigma);
        return true;
    }
};

struct CentreCost {
    template <class T>
    bool operator()(const T* centre, T* residual) const {
        residual[0] = centre[0] / T(kCentrePrior);
        residual[1] = centre[1] / T(kCentrePrior);
        return true;
    }
};

// The plane through the camera that the line's directions lie nearest to, then nearest in the picture.
PlaneFrame plane_of(const PlumbModel& model, const PlumbLine& line) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Vec2d& p : line.points) {
        const Vec2d q = p - model.centre;
        const PlumbRay<double> ray = plumb_ray(model.kind, model.shape.data(), q.x * q.x + q.y * q.y);
        const Eigen::Vector3d direction(ray.s * q.x, ray.s * q.y, ray.z);
        sum += direction * direction.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(sum);
    PlaneFrame frame = frame_about(eigen.eigenvectors().col(0));
    using Jet = ceres::Jet<double, 2>;
    const Jet shape[3] = {Jet(model.shape[0]), Jet(model.shape[1]), Jet(model.shape[2])};
    const Jet centre[2] = {Jet(model.centre.x), Jet(model.centre.y)};
    const Jet own[2] = {Jet(0.0, 0), Jet(0.0, 1)};
    for (int step = 0; step < kLineSteps; ++step) {
        Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
        Eigen::Vector2d right = Eigen::Vector2d::Zero();
        for (const Vec2d& p : line.points) {
            const Jet e = residual_of(model.kind, shape, centre, frame, own, p);
            normal += e.v * e.v.transpose();
            right -= e.v * e.a;
        }
        const Eigen::Vector2d change = normal.inverse() * right;
        if (!change.allFinite() || change.norm() > 0.5) {
            break;
        }
        frame = frame_about(frame.n + change[0] * frame.u + change[1] * frame.v);
        if (change.norm() < 1e-9) {
            break;
        }
    }
    return frame;
}

// Rows of a line over its sigma, by the free parameters, what its own unknowns explain taken out.
struct OwnRows {
    Eigen::MatrixXd a;
    Eigen::VectorXd e;
};

OwnRows own_rows(const PlumbModel& model, const PlumbLine& line) {
    using Jet = ceres::Jet<double, 7>;
    const PlaneFrame frame = plane_of(model, line);
    const Jet shape[3] = {Jet(model.shape[0], 0), Jet(model.shape[1], 1), Jet(model.shape[2], 2)};
    const Jet centre[2] = {Jet(model.centre.x, 3), Jet(model.centre.y, 4)};
    const Jet own[2] = {Jet(0.0, 5), Jet(0.0, 6)};
    const auto rows = static_cast<Index>(line.points.size());
    const Index terms = model.terms;
    Eigen::MatrixXd shared(rows, terms + 2);
    Eigen::Matrix<double, Eigen::Dynamic, 2> lines(rows, 2);
    Eigen::VectorXd e(rows);
    for (Index i = 0; i < rows; ++i) {
        const Jet r = residual_of(model.kind, shape, centre, frame, own, line.points[static_cast<std::size_t>(i)]);
        shared.row(i).head(terms) = r.v.head(terms).transpose();
        shared.row(i).tail(2) = r.v.segment<2>(3).transpose();
        lines.row(i) = r.v.tail<2>().transpose();
        e(i) = r.a;
    }
    const Eigen::Matrix2d inverse = (lines.transpose() * lines).inverse();
    const auto without = [&](const auto& columns) {
        return ((columns - lines * (inverse * (lines.transpose() * columns))) / line.sigma).eval();
    };
    return {without(shared), without(e)};
}

void solve_lines(const std::vector<PlumbLine>& lines, PlumbModel& model) {
    ceres::Problem problem;
    std::array<double, 2> centre{model.centre.x, model.centre.y};
    problem.AddParameterBlock(model.shape.data(), kShapeTerms);
    problem.AddParameterBlock(centre.data(), 2);
    std::vector<int> held;
    for (int k = model.terms; k < static_cast<int>(kShapeTerms); ++k) {
        held.push_back(k);
    }
    if (!held.empty()) {
        problem.SetManifold(model.shape.data(), new ceres::SubsetManifold(kShapeTerms, held));
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    options.linear_solver_ordering->AddElementToGroup(model.shape.data(), 1);
    options.linear_solver_ordering->AddElementToGroup(centre.data(), 1);
    std::vector<std::array<double, 2>> own(lines.size(), {0.0, 0.0});
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const PlaneFrame frame = plane_of(model, lines[i]);
        problem.AddParameterBlock(own[i].data(), 2);
        options.linear_solver_ordering->AddElementToGroup(own[i].data(), 0);
        for (const Vec2d& p : lines[i].points) {
            problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PlumbCost, 1, kShapeTerms, 2, 2>(
                                         new PlumbCost{model.kind, frame, p, lines[i].sigma}),
                                     nullptr, model.shape.data(), centre.data(), own[i].data());
        }
    }
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<CentreCost, 2, 2>(new CentreCost), nullptr, centre.data());
    options.max_num_iterations = 60;
    options.function_tolerance = 1e-10;
    options.num_threads = 1;  // sums in one order: the same bytes everywhere
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    model.centre = {centre[0], centre[1]};
}

}  // namespace

Straightness straightened(const PlumbModel& model, const PlumbLine& line) {
    const PlaneFrame frame = plane_of(model, line);
    const double own[2] = {0.0, 0.0};
    const double centre[2] = {model.centre.x, model.centre.y};
    const auto residual_at = [&](const Vec2d& p) {
        return residual_of(model.kind, model.shape.data(), centre, frame, own, p);
    };
    const Vec2d chord = line.points.back() - line.points.front();
    const double length2 = chord.x * chord.x + chord.y * chord.y;
    // A plane's normal points either way.
    const Vec2d& middle = line.points[line.points.size() / 2];
    const Vec2d left = (1e-6 / std::sqrt(length2)) * Vec2d{chord.y, -chord.x};
    const double sign = residual_at(middle + left) > residual_at(middle) ? 1.0 : -1.0;
    Straightness result;
    double squares = 0.0;
    for (const Vec2d& p : line.points) {
        result.residual.push_back(sign * residual_at(p));
        squares += result.residual.back() * result.residual.back();
    }
    const auto count = static_cast<double>(line.points.size());
    result.rms = std::sqrt(squares / std::max(count - 2.0, 1.0));
    // Of powers of the way along the line the straight ones are taken out, and each of the next two then is a bend.
    Eigen::MatrixXd basis(static_cast<Index>(line.points.size()), 4);
    Eigen::VectorXd e(basis.rows());
    for (Index i = 0; i < basis.rows(); ++i) {
        const Vec2d on = line.points[static_cast<std::size_t>(i)] - line.points.front();
        const double t = 2.0 * (on.x * chord.x + on.y * chord.y) / length2 - 1.0;
        basis.row(i) << 1.0, t, t * t, t * t * t;
        e(i) = result.residual[static_cast<std::size_t>(i)];
    }
    double bow = 0.0;
    for (Index k = 0; k < 4; ++k) {
        for (Index j = 0; j < k; ++j) {
            basis.col(k) -= basis.col(j).dot(basis.col(k)) * basis.col(j);
        }
        basis.col(k).normalize();
        bow += k < 2 ? 0.0 : std::pow(basis.col(k).dot(e), 2);
    }
    result.bow = std::sqrt(bow / count);
    return result;
}

std::optional<PlumbFit> fit_plumb_lines(const std::vector<PlumbLine>& lines, const PlumbModel& start) {
    constexpr double kSingular = 1e-15;
    PlumbFit fit{.model = start, .covariance = {}, .held_out = {}, .influence = {}, .reach = {}, .inverse = {}};
    solve_lines(lines, fit.model);
    const Index count = start.terms + 2;
    Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(count, count);
    prior.diagonal().tail(2).setConstant(1.0 / (kCentrePrior * kCentrePrior));
    std::vector<OwnRows> rows;
    std::vector<Eigen::MatrixXd> squares;
    Eigen::MatrixXd normal = prior;
    for (const PlumbLine& line : lines) {
        rows.push_back(own_rows(fit.model, line));
        squares.emplace_back(rows.back().a.transpose() * rows.back().a);
        normal += squares.back();
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> solver(normal);
    if (!normal.allFinite() || solver.rcond() < kSingular) {
        return std::nullopt;
    }
    fit.inverse = solver.inverse();
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(count, count);
    Eigen::MatrixXd meat = prior;
    const auto clusters = static_cast<double>(lines.size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const Eigen::FullPivLU<Eigen::MatrixXd> others(one - squares[i] * fit.inverse);
        if (!others.isInvertible()) {
            return std::nullopt;  // without this line nothing is left
        }
        const Eigen::MatrixXd left = others.inverse();  // (1 − S M)⁻¹
        const Eigen::VectorXd u = left * (rows[i].a.transpose() * rows[i].e);
        meat += (clusters - 1.0) / clusters * u * u.transpose();
        fit.influence.emplace_back(left * squares[i] * left.transpose());
        fit.reach.emplace_back(squares[i] * left.transpose() * fit.inverse);
        const Eigen::VectorXd predicted = rows[i].e + rows[i].a * (fit.inverse * u);
        fit.held_out.push_back(predicted.squaredNorm() / static_cast<double>(predicted.size()));
    }
    fit.covariance = fit.inverse * meat * fit.inverse;
    return fit.covariance.allFinite() ? std::optional(std::move(fit)) : std::nullopt;
}

double freedom_of(const PlumbFit& fit, const Eigen::VectorXd& gradient) {
    // The estimate is a sum of squares e'g of lines; with g_i'g_j = δ v_i'v_i − w_i' M w_j its trace and that of its
    // square are known.
    const Eigen::VectorXd m = fit.inverse * gradient;
    const std::size_t n = fit.influence.size();
    Eigen::MatrixXd gram(static_cast<Index>(n), static_cast<Index>(n));
    std::vector<Eigen::VectorXd> w;
    for (std::size_t i = 0; i < n; ++i) {
        w.emplace_back(fit.reach[i] * gradient);
    }
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
            gram(static_cast<Index>(i), static_cast<Index>(j)) =
                (i == j ? m.dot(fit.influence[i] * m) : 0.0) - w[i].dot(fit.inverse * w[j]);
        }
    }
    const double trace = gram.trace();
    const double by_lines = trace * trace / gram.squaredNorm();
    const auto centre = static_cast<Index>(gradient.size()) - 2;
    const double by_prior = m.segment<2>(centre).squaredNorm() / (kCentrePrior * kCentrePrior);
    const double all = gradient.dot(fit.covariance * gradient);
    const double told = std::max(all - by_prior, 1e-3 * all);
    return std::max(1.0, by_lines * all * all / (told * told));
}

}  // namespace lensproof::calibration
