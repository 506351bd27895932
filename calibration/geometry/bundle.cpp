#include "calibration/geometry/bundle.h"

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace lensproof::calibration {
namespace {

void hold(ceres::Problem& problem, std::vector<double>& intrinsics, const Held& held) {
    if (held.intrinsics.size() == intrinsics.size()) {
        problem.SetParameterBlockConstant(intrinsics.data());
    } else if (!held.intrinsics.empty()) {
        problem.SetManifold(intrinsics.data(),
                            new ceres::SubsetManifold(static_cast<int>(intrinsics.size()), held.intrinsics));
    }
}

ceres::Solver::Options solver_options() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.max_num_iterations = 200;
    options.function_tolerance = 1e-14;
    options.gradient_tolerance = 1e-14;
    options.parameter_tolerance = 1e-12;
    // Terms that can stand in for each other (k1 and k4 of a rational function) always stay damped a little, so that
    // the normal matrix can be solved.
    options.max_trust_region_radius = 1e11;
    options.num_threads = 1;  // sums in one order: the same bytes everywhere
    options.logging_type = ceres::SILENT;
    return options;
}

}  // namespace

Vec3d in_camera(const ChartView& view, std::size_t point, const Pose& pose) {
    return view.is_far() ? turned(pose, view.directions[point]) : to_camera(pose, view.chart_mm[point]);
}

void add_point(ChartView& to, const ChartView& from, std::size_t point) {
    if (from.is_far()) {
        to.directions.push_back(from.directions[point]);
    } else {
        to.chart_mm.push_back(from.chart_mm[point]);
    }
    to.image_px.push_back(from.image_px[point]);
}

PointBundle make_bundle(const std::vector<ChartView>& views, double disc_diameter_mm) {
    PointBundle bundle{.views = views, .used = {}, .disc_diameter_mm = disc_diameter_mm, .frame = {}};
    Vec2d low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    Vec2d high{-low.x, -low.y};
    for (const ChartView& view : views) {
        bundle.used.emplace_back(view.image_px.size(), true);
        for (const Vec2d& p : view.chart_mm) {
            low = {std::min(low.x, p.x), std::min(low.y, p.y)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y)};
        }
    }
    if (high.x > low.x && high.y > low.y) {
        bundle.frame = {{0.5 * (low.x + high.x), 0.5 * (low.y + high.y)},
                        {0.5 * (high.x - low.x), 0.5 * (high.y - low.y)}};
    }
    return bundle;
}

Feature feature(const PointBundle& bundle, std::size_t view, std::size_t point) {
    const ChartView& of = bundle.views[view];
    if (of.is_far()) {
        return {.image_px = of.image_px[point], .direction = of.directions[point]};
    }
    return {
        .chart_mm = of.chart_mm[point], .image_px = of.image_px[point], .disc_diameter_mm = bundle.disc_diameter_mm};
}

int count_used(const PointBundle& bundle) {
    std::ptrdiff_t count = 0;
    for (const auto& view : bundle.used) {
        count += std::count(view.begin(), view.end(), true);
    }
    return static_cast<int>(count);
}

double solve(const PointBundle& bundle, BundleState& state, const Held& held, double cauchy_scale_px) {
    ceres::Problem::Options ownership;
    ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(ownership);
    ceres::CauchyLoss cauchy(cauchy_scale_px > 0.0 ? cauchy_scale_px : 1.0);
    std::vector<double> intrinsics = parameters(state.model);
    ceres::Solver::Options options = solver_options();
    // Poses are eliminated, what is shared stays.
    options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (std::size_t v = 0; v < bundle.views.size(); ++v) {
        options.linear_solver_ordering->AddElementToGroup(state.poses[v].data(), 0);
        problem.AddParameterBlock(state.poses[v].data(), 6);
        if (held.poses) {
            problem.SetParameterBlockConstant(state.poses[v].data());
        } else if (bundle.views[v].is_far()) {
            problem.SetManifold(state.poses[v].data(), new ceres::SubsetManifold(6, {3, 4, 5}));
        }
    }
    problem.AddParameterBlock(intrinsics.data(), static_cast<int>(intrinsics.size()));
    problem.AddParameterBlock(state.heights.data(), kBoardTerms);
    options.linear_solver_ordering->AddElementToGroup(intrinsics.data(), 1);
    options.linear_solver_ordering->AddElementToGroup(state.heights.data(), 1);
    hold(problem, intrinsics, held);
    if (held.heights) {
        problem.SetParameterBlockConstant(state.heights.data());
    }
    std::vector<std::unique_ptr<ceres::LossFunction>> losses;
    for (std::size_t v = 0; v < bundle.views.size(); ++v) {
        ceres::LossFunction* loss = cauchy_scale_px > 0.0 ? &cauchy : nullptr;
        if (bundle.views[v].weight != 1.0) {
            losses.push_back(
                std::make_unique<ceres::ScaledLoss>(loss, bundle.views[v].weight, ceres::DO_NOT_TAKE_OWNERSHIP));
            loss = losses.back().get();
        }
        for (std::size_t i = 0; i < bundle.used[v].size(); ++i) {
            if (bundle.used[v][i]) {
                problem.AddResidualBlock(
                    reprojection_cost(kind(state.model), feature(bundle, v, i), bundle.frame).release(), loss,
                    intrinsics.data(), state.poses[v].data(), state.heights.data());
            }
        }
    }
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    state.model = with_parameters(state.model, intrinsics);
    return summary.IsSolutionUsable() && std::isfinite(summary.final_cost) ? summary.final_cost
                                                                           : std::numeric_limits<double>::infinity();
}

std::optional<Vec2d> residual(const PointBundle& bundle, const BundleState& state, std::size_t view,
                              std::size_t point) {
    const auto cost = reprojection_cost(kind(state.model), feature(bundle, view, point), bundle.frame);
    const std::vector<double> intrinsics = parameters(state.model);
    const double* blocks[3] = {intrinsics.data(), state.poses[view].data(), state.heights.data()};
    double values[2];
    if (!cost->Evaluate(blocks, values, nullptr)) {
        return std::nullopt;
    }
    return Vec2d{values[0], values[1]};
}

}  // namespace lensproof::calibration
