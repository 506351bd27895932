#include "calibration/explain/lens_fit.h"

#include <ceres/cost_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Dense>
#include <cmath>

namespace lensproof::calibration {

namespace {

LensState state_from(const double* changes, Eigen::Index count, const double* poses, std::size_t views) {
    LensState state{.changes = Eigen::Map<const Eigen::VectorXd>(changes, count), .poses = {}};
    for (std::size_t v = 0; v < views; ++v) {
        PoseParameters pose{};
        std::copy_n(poses + kPoseUnknowns * v, kPoseUnknowns, pose.begin());
        state.poses.push_back(pose);
    }
    return state;
}

/// All residuals at once, of the changes and of all poses; last the departures from the belief.
class LensCost final : public ceres::CostFunction {
  public:
    LensCost(ResidualTracer& tracer, const Belief& belief, Eigen::Index rows, std::size_t views)
        : tracer_(tracer), belief_(belief), rows_(rows), views_(views) {
        set_num_residuals(static_cast<int>(rows + belief.mean.size()));
        *mutable_parameter_block_sizes() = {static_cast<int>(belief.mean.size()),
                                            kPoseUnknowns * static_cast<int>(views)};
    }

    bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override {
        const Eigen::Index count = belief_.mean.size();
        const LensState state = state_from(blocks[0], count, blocks[1], views_);
        const auto found = tracer_.residuals(state, jacobians != nullptr);
        if (!found || !found->values.allFinite()) {
            return false;
        }
        Eigen::Map<Eigen::VectorXd> all(residuals, rows_ + count);
        all.head(rows_) = found->values;
        Eigen::VectorXd weight = Eigen::VectorXd::Zero(count);
        for (Eigen::Index i = 0; i < count; ++i) {
            weight[i] = belief_.sigma[i] > 0.0 ? 1.0 / belief_.sigma[i] : 0.0;
        }
        all.tail(count) = weight.cwiseProduct(state.changes - belief_.mean);
        using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        if (jacobians != nullptr && jacobians[0] != nullptr) {
            Eigen::Map<RowMajor> by_change(jacobians[0], rows_ + count, count);
            by_change.topRows(rows_) = found->by_change;
            by_change.bottomRows(count) = weight.asDiagonal();
        }
        if (jacobians != nullptr && jacobians[1] != nullptr) {
            Eigen::Map<RowMajor> by_pose(jacobians[1], rows_ + count, found->by_pose.cols());
            by_pose.topRows(rows_) = found->by_pose;
            by_pose.bottomRows(count).setZero();
        }
        return true;
    }

  private:
    ResidualTracer& tracer_;
    const Belief& belief_;
    Eigen::Index rows_;
    std::size_t views_;
};

void hold(ceres::Problem& problem, Eigen::VectorXd& changes, const Belief& belief) {
    std::vector<int> held;
    for (Eigen::Index i = 0; i < changes.size(); ++i) {
        if (!(belief.sigma[i] > 0.0)) {
            held.push_back(static_cast<int>(i));
            changes[i] = belief.mean[i];
        }
    }
    if (static_cast<Eigen::Index>(held.size()) == changes.size()) {
        problem.SetParameterBlockConstant(changes.data());
    } else if (!held.empty()) {
        problem.SetManifold(changes.data(), new ceres::SubsetManifold(static_cast<int>(changes.size()), held));
    }
}

ceres::Solver::Options lens_solver_options() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.max_num_iterations = 30;
    options.function_tolerance = 5e-6;  // of some hundreds: where half a unit is a standard error, a hundredth
    // What is believed keeps every direction determined: hardly any damping, or the weak ones take fifty steps.
    options.initial_trust_region_radius = 1e12;
    options.max_trust_region_radius = 1e16;
    options.gradient_tolerance = 1e-12;
    options.parameter_tolerance = 1e-10;
    options.num_threads = 1;  // sums in one order: the same bytes everywhere
    options.logging_type = ceres::SILENT;
    return options;
}

std::vector<Eigen::Index> free_changes(const Eigen::VectorXd& sigma) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < sigma.size(); ++i) {
        if (sigma[i] > 0.0) {
            free.push_back(i);
        }
    }
    return free;
}

/// 1 + Σ^½ A Σ^½ over what is free: what is known in units of the belief.
Eigen::MatrixXd scaled_precision(const Eigen::MatrixXd& information, const Eigen::VectorXd& sigma,
                                 const std::vector<Eigen::Index>& free) {
    const Eigen::VectorXd scale = sigma(free);
    Eigen::MatrixXd precision = scale.asDiagonal() * Eigen::MatrixXd(information(free, free)) * scale.asDiagonal();
    precision.diagonal().array() += 1.0;
    return precision;
}

}  // namespace

Belief usual_belief(const std::vector<LensChange>& changes) {
    const auto count = static_cast<Eigen::Index>(changes.size());
    Belief belief{.mean = Eigen::VectorXd::Zero(count), .sigma = Eigen::VectorXd(count)};
    for (Eigen::Index i = 0; i < count; ++i) {
        belief.sigma[i] = tolerance(changes[static_cast<std::size_t>(i)].kind).usual;
    }
    return belief;
}

Belief prescribed_belief(const std::vector<LensChange>& changes) {
    Belief belief = usual_belief(changes);
    for (Eigen::Index i = 0; i < belief.sigma.size(); ++i) {
        const ChangeKind kind = changes[static_cast<std::size_t>(i)].kind;
        if (kind != ChangeKind::scale && kind != ChangeKind::sensor_shift) {
            belief.sigma[i] = 0.0;
        }
    }
    return belief;
}

Eigen::MatrixXd information_of(const LensResiduals& residuals) {
    const Eigen::MatrixXd& c = residuals.by_change;
    const Eigen::MatrixXd& p = residuals.by_pose;
    const Eigen::MatrixXd across = p.transpose() * c;
    const Eigen::LDLT<Eigen::MatrixXd> poses(p.transpose() * p);
    Eigen::MatrixXd information = c.transpose() * c - across.transpose() * poses.solve(across);
    return 0.5 * (information + information.transpose());
}

double log_occam_factor(const Eigen::MatrixXd& information, const Eigen::VectorXd& sigma) {
    const auto free = free_changes(sigma);
    const Eigen::LDLT<Eigen::MatrixXd> factor(scaled_precision(information, sigma, free));
    return -0.5 * factor.vectorD().array().max(1e-300).log().sum();
}

Eigen::MatrixXd LensFit::covariance() const {
    const auto free = free_changes(belief.sigma);
    const Eigen::VectorXd scale = belief.sigma(free);
    const auto count = static_cast<Eigen::Index>(free.size());
    const Eigen::MatrixXd scaled =
        scaled_precision(information, belief.sigma, free).ldlt().solve(Eigen::MatrixXd::Identity(count, count));
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(belief.sigma.size(), belief.sigma.size());
    all(free, free) = scale.asDiagonal() * scaled * scale.asDiagonal();
    return all;
}

double LensFit::largest_strain() const {
    double largest = 0.0;
    for (const Eigen::Index i : free_changes(belief.sigma)) {
        largest = std::max(largest, std::abs(state.changes[i] - belief.mean[i]) / belief.sigma[i]);
    }
    return largest;
}

double LensFit::freedom() const {
    // Of each change the data decide the fraction 1 − posterior variance / prior variance.
    const Eigen::MatrixXd known = covariance();
    double decided = 0.0;
    for (const Eigen::Index i : free_changes(belief.sigma)) {
        decided += 1.0 - known(i, i) / (belief.sigma[i] * belief.sigma[i]);
    }
    return static_cast<double>(residuals.size()) - kPoseUnknowns * static_cast<double>(state.poses.size()) - decided;
}

std::optional<LensFit> fit_lens(const ExplainedLens& lens, const SeenPoints& seen, const LensState& start,
                                const Belief& belief) {
    ResidualTracer tracer(lens, seen);
    const auto first = tracer.residuals(start, false);
    if (!first) {
        return std::nullopt;
    }
    const std::size_t views = seen.views.size();
    Eigen::VectorXd changes = start.changes;
    std::vector<double> poses;
    for (const PoseParameters& pose : start.poses) {
        poses.insert(poses.end(), pose.begin(), pose.end());
    }
    ceres::Problem problem;
    problem.AddResidualBlock(new LensCost(tracer, belief, first->values.size(), views), nullptr, changes.data(),
                             poses.data());
    hold(problem, changes, belief);
    ceres::Solver::Summary summary;
    ceres::Solve(lens_solver_options(), &problem, &summary);
    if (!summary.IsSolutionUsable()) {
        return std::nullopt;
    }
    LensFit fit{.state = state_from(changes.data(), changes.size(), poses.data(), views), .belief = belief};
    const auto residuals = tracer.residuals(fit.state, true);
    if (!residuals) {
        return std::nullopt;
    }
    fit.residuals = residuals->values;
    fit.chi2 = fit.residuals.squaredNorm();
    for (const Eigen::Index i : free_changes(belief.sigma)) {
        fit.strain2 += std::pow((changes[i] - belief.mean[i]) / belief.sigma[i], 2);
    }
    fit.information = information_of(*residuals);
    fit.log_evidence = -0.5 * (fit.chi2 + fit.strain2) + log_occam_factor(fit.information, belief.sigma);
    return fit;
}

}  // namespace lensproof::calibration
