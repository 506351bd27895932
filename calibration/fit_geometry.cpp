#include "calibration/fit_geometry.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "calibration/disc_centroid.h"
#include "engine/io/input_error.h"

namespace lensproof {
namespace {

constexpr double kSmallestOutlier_px = 0.1;  // no point this close is ever an outlier
constexpr int kOutlierRounds = 3;
constexpr double kUndetermined = 0.05;   // a relative standard error above this is no measurement
constexpr double kLeastSigma_px = 0.01;  // no detector is better; judges views whose residuals happen to be tiny

// One feature's residual; parameters: intrinsics, and the pose's rotation vector and translation.
template <class Model>
struct Reprojection {
    Vec2d chart_mm;
    Vec2d image_px;
    double disc_diameter_mm = 0.0;

    template <class T>
    bool operator()(const T* intrinsics, const T* pose, T* residual) const {
        const auto map = [&](double x, double y, Vec2<T>& pixel) {
            const T point[3] = {T(x), T(y), T(0.0)};
            T rotated[3];
            ceres::AngleAxisRotatePoint(pose, point, rotated);
            return Model::project(intrinsics, Vec3<T>{rotated[0] + pose[3], rotated[1] + pose[4], rotated[2] + pose[5]},
                                  pixel);
        };
        Vec2<T> predicted;
        const bool imaged = disc_diameter_mm > 0.0
                                ? disc_centroid(map, chart_mm.x, chart_mm.y, disc_diameter_mm, predicted)
                                : map(chart_mm.x, chart_mm.y, predicted);
        if (!imaged) {
            return false;
        }
        residual[0] = image_px.x - predicted.x;
        residual[1] = image_px.y - predicted.y;
        return true;
    }
};

// What is varied: intrinsics and a pose per view, as Ceres wants them.
template <class Model>
struct State {
    std::array<double, Model::count> intrinsics{};
    std::vector<std::array<double, 6>> poses;  // rotation vector, translation (mm)
};

template <class Model>
using Cost = ceres::AutoDiffCostFunction<Reprojection<Model>, 2, Model::count, 6>;

using UsedPoints = std::vector<std::vector<bool>>;

template <class Model>
class Fit {
  public:
    Fit(const std::vector<ChartView>& views, int width, int height, const GeometryOptions& options)
        : views_(views),
          options_(options),
          middle_{(width - 1) / 2.0, (height - 1) / 2.0},
          half_diagonal_(0.5 * std::hypot(width, height)) {
        for (const ChartView& view : views) {
            used_.emplace_back(view.image_px.size(), true);
        }
    }

    GeometryFit run() {
        check_counts();
        State<Model> state = best_start();
        solve(state, held());
        for (int round = 0; round < kOutlierRounds && options_.outlier_sigmas > 0.0; ++round) {
            if (!drop_outliers(state)) {
                break;
            }
            check_counts();
            solve(state, held());
        }
        return result(state);
    }

  private:
    // Indices of the intrinsics that are not fitted.
    [[nodiscard]] std::vector<int> held() const {
        std::vector<int> indices;
        if (options_.known_focal_px) {
            indices.push_back(0);
        }
        if (options_.fix_centre) {
            indices.insert(indices.end(), {1, 2});
        }
        const int terms =
            std::clamp(options_.radial_terms.value_or(Model::max_radial_terms), 0, Model::max_radial_terms);
        for (int i = 3 + terms; i < 3 + Model::max_radial_terms; ++i) {
            indices.push_back(i);
        }
        if (!options_.fit_tangential) {
            for (int i = 3 + Model::max_radial_terms; i < Model::count; ++i) {
                indices.push_back(i);
            }
        }
        return indices;
    }

    [[nodiscard]] int point_count() const {
        std::ptrdiff_t count = 0;
        for (const auto& view : used_) {
            count += std::count(view.begin(), view.end(), true);
        }
        return static_cast<int>(count);
    }

    [[nodiscard]] int unknown_count() const {
        return Model::count - static_cast<int>(held().size()) + 6 * static_cast<int>(views_.size());
    }

    void check_counts() const {
        if (2 * point_count() <= unknown_count()) {
            throw InputError("fitting a camera model: " + std::to_string(point_count()) + " points in " +
                             std::to_string(views_.size()) + " views cannot determine " +
                             std::to_string(unknown_count()) + " unknowns: expected more points or views");
        }
    }

    // Poses under an undistorted model of the given focal length, and the rms misfit of the rays in px.
    std::optional<double> start_at(double focal, State<Model>& state) const {
        state.intrinsics = {};
        state.intrinsics[0] = focal;
        state.intrinsics[1] = middle_.x;
        state.intrinsics[2] = middle_.y;
        state.poses.clear();
        double sum = 0.0;
        std::size_t count = 0;
        for (const ChartView& view : views_) {
            std::vector<Vec3d> rays;
            for (const Vec2d& pixel : view.image_px) {
                const double dx = pixel.x - middle_.x;
                const double dy = pixel.y - middle_.y;
                const double radius = std::hypot(dx, dy);
                const double angle = Model::undistorted_angle(focal, radius);
                if (angle > std::numbers::pi) {
                    return std::nullopt;
                }
                const double lateral = radius > 0.0 ? std::sin(angle) / radius : 0.0;
                rays.push_back({lateral * dx, lateral * dy, std::cos(angle)});
            }
            const auto pose = planar_pose(view.chart_mm, rays);
            if (!pose) {
                return std::nullopt;
            }
            for (std::size_t i = 0; i < rays.size(); ++i) {
                const Vec3d seen = normalized(to_camera(*pose, view.chart_mm[i]));
                const double miss = focal * length(seen - rays[i]);
                sum += miss * miss;
            }
            count += rays.size();
            state.poses.push_back({pose->rotation_rad.x, pose->rotation_rad.y, pose->rotation_rad.z,
                                   pose->translation_mm.x, pose->translation_mm.y, pose->translation_mm.z});
        }
        const double rms = std::sqrt(sum / static_cast<double>(count));
        return std::isfinite(rms) ? std::optional(rms) : std::nullopt;
    }

    // Scans focal lengths from a 180° fisheye to a long lens and fits from the few best; the best of these fits wins.
    State<Model> best_start() const {
        std::vector<double> focals;
        if (options_.known_focal_px) {
            focals = {*options_.known_focal_px};
        } else {
            for (double focal = 0.25 * half_diagonal_; focal < 40.0 * half_diagonal_; focal *= 1.2) {
                focals.push_back(focal);
            }
        }
        struct Candidate {
            double misfit = 0.0;
            State<Model> state;
        };
        std::vector<Candidate> candidates;
        for (const double focal : focals) {
            State<Model> state;
            if (const auto misfit = start_at(focal, state)) {
                candidates.push_back({*misfit, state});
            }
        }
        if (candidates.empty()) {
            throw InputError(
                "fitting a camera model: no view shows the chart's points as a flat chart would look; "
                "expected at least four points, not on a line, in every view");
        }
        std::stable_sort(candidates.begin(), candidates.end(),
                         [](const Candidate& a, const Candidate& b) { return a.misfit < b.misfit; });
        candidates.resize(std::min<std::size_t>(candidates.size(), 3));
        State<Model> best;
        double best_cost = std::numeric_limits<double>::infinity();
        for (Candidate& candidate : candidates) {
            // Focal length and poses first, so that the distortion does not run after a wrong scale.
            std::vector<int> all_but_focal;
            for (int i = options_.known_focal_px ? 0 : 1; i < Model::count; ++i) {
                all_but_focal.push_back(i);
            }
            solve(candidate.state, all_but_focal);
            const double cost = solve(candidate.state, held());
            if (cost < best_cost) {
                best_cost = cost;
                best = candidate.state;
            }
        }
        if (!std::isfinite(best_cost)) {
            throw InputError("fitting a camera model: the views do not agree with any " + std::string(Model::kind) +
                             " camera");
        }
        return best;
    }

    [[nodiscard]] Reprojection<Model> reprojection(std::size_t view, std::size_t point) const {
        return {views_[view].chart_mm[point], views_[view].image_px[point], options_.disc_diameter_mm};
    }

    void add_residuals(ceres::Problem& problem, State<Model>& state) const {
        for (std::size_t v = 0; v < views_.size(); ++v) {
            problem.AddParameterBlock(state.poses[v].data(), 6);
            for (std::size_t i = 0; i < views_[v].image_px.size(); ++i) {
                if (used_[v][i]) {
                    problem.AddResidualBlock(new Cost<Model>(new Reprojection<Model>(reprojection(v, i))), nullptr,
                                             state.intrinsics.data(), state.poses[v].data());
                }
            }
        }
    }

    static void hold(ceres::Problem& problem, State<Model>& state, const std::vector<int>& indices) {
        if (static_cast<int>(indices.size()) == Model::count) {
            problem.SetParameterBlockConstant(state.intrinsics.data());
        } else if (!indices.empty()) {
            problem.SetManifold(state.intrinsics.data(), new ceres::SubsetManifold(Model::count, indices));
        }
    }

    double solve(State<Model>& state, const std::vector<int>& indices) const {
        ceres::Problem problem;
        add_residuals(problem, state);
        hold(problem, state, indices);
        ceres::Solver::Options options;
        options.linear_solver_type = ceres::DENSE_SCHUR;
        options.max_num_iterations = 200;
        options.function_tolerance = 1e-14;
        options.gradient_tolerance = 1e-14;
        options.parameter_tolerance = 1e-12;
        options.num_threads = 1;  // sums in one order: the same bytes everywhere
        options.logging_type = ceres::SILENT;
        // Poses are eliminated, the shared intrinsics stay.
        options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
        for (auto& pose : state.poses) {
            options.linear_solver_ordering->AddElementToGroup(pose.data(), 0);
        }
        options.linear_solver_ordering->AddElementToGroup(state.intrinsics.data(), 1);
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem, &summary);
        return summary.IsSolutionUsable() && std::isfinite(summary.final_cost)
                   ? summary.final_cost
                   : std::numeric_limits<double>::infinity();
    }

    [[nodiscard]] std::optional<Vec2d> residual(const State<Model>& state, std::size_t view, std::size_t point) const {
        double values[2];
        if (!reprojection(view, point)(state.intrinsics.data(), state.poses[view].data(), values)) {
            return std::nullopt;
        }
        return Vec2d{values[0], values[1]};
    }

    // True when the set of used points has changed.
    bool drop_outliers(const State<Model>& state) {
        std::vector<double> magnitudes;
        for (std::size_t v = 0; v < views_.size(); ++v) {
            for (std::size_t i = 0; i < used_[v].size(); ++i) {
                if (const auto r = residual(state, v, i); r && used_[v][i]) {
                    magnitudes.push_back(std::abs(r->x));
                    magnitudes.push_back(std::abs(r->y));
                }
            }
        }
        const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
        std::nth_element(magnitudes.begin(), middle, magnitudes.end());
        const double sigma = 1.4826 * *middle;  // of a normal distribution with this median magnitude
        const double limit = std::max(options_.outlier_sigmas * sigma, kSmallestOutlier_px);
        bool changed = false;
        for (std::size_t v = 0; v < views_.size(); ++v) {
            for (std::size_t i = 0; i < used_[v].size(); ++i) {
                const auto r = residual(state, v, i);
                const bool use = r && std::hypot(r->x, r->y) <= limit;
                changed = changed || use != used_[v][i];
                used_[v][i] = use;
            }
        }
        return changed;
    }

    // Covariance of the intrinsics per unit variance: the inverse of their normal matrix after the poses have been
    // eliminated view by view (Schur complement), columns scaled to unit length so that ranks mean something.
    [[nodiscard]] Eigen::MatrixXd unit_covariance(const State<Model>& state) const {
        const std::vector<int> indices = held();
        std::vector<int> free;
        for (int i = 0; i < Model::count; ++i) {
            if (std::find(indices.begin(), indices.end(), i) == indices.end()) {
                free.push_back(i);
            }
        }
        const int n = static_cast<int>(free.size());
        Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(Model::count, Model::count);
        if (n == 0) {
            return covariance;
        }
        Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
        Eigen::MatrixXd reduced = Eigen::MatrixXd::Zero(n, n);
        for (std::size_t v = 0; v < views_.size(); ++v) {
            Eigen::MatrixXd own = Eigen::MatrixXd::Zero(n, n);
            Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(n, 6);
            Eigen::Matrix<double, 6, 6> pose = Eigen::Matrix<double, 6, 6>::Zero();
            for (std::size_t i = 0; i < used_[v].size(); ++i) {
                if (!used_[v][i]) {
                    continue;
                }
                const Cost<Model> cost(new Reprojection<Model>(reprojection(v, i)));
                Eigen::Matrix<double, 2, Model::count, Eigen::RowMajor> j_intrinsics;
                Eigen::Matrix<double, 2, 6, Eigen::RowMajor> j_pose;
                const double* blocks[2] = {state.intrinsics.data(), state.poses[v].data()};
                double* jacobians[2] = {j_intrinsics.data(), j_pose.data()};
                double values[2];
                if (!cost.Evaluate(blocks, values, jacobians)) {
                    continue;
                }
                const Eigen::MatrixXd j = j_intrinsics(Eigen::all, free);
                own += j.transpose() * j;
                mixed += j.transpose() * j_pose;
                pose += j_pose.transpose() * j_pose;
            }
            normal += own;
            const Eigen::Matrix<double, 6, 1> size = pose.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
            const Eigen::Matrix<double, 6, 6> scaled = size.asDiagonal() * pose * size.asDiagonal();
            const Eigen::MatrixXd scaled_mixed = mixed * size.asDiagonal();
            reduced += own - scaled_mixed * scaled.completeOrthogonalDecomposition().solve(scaled_mixed.transpose());
        }
        const Eigen::VectorXd size = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
        const Eigen::MatrixXd scaled = size.asDiagonal() * reduced * size.asDiagonal();
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
        if (eigen.info() != Eigen::Success || !(eigen.eigenvalues()(0) > 1e-13)) {
            throw undetermined("at least one parameter");
        }
        const Eigen::MatrixXd inverse = size.asDiagonal() * eigen.eigenvectors() *
                                        eigen.eigenvalues().cwiseInverse().asDiagonal() *
                                        eigen.eigenvectors().transpose() * size.asDiagonal();
        covariance(free, free) = inverse;
        return covariance;
    }

    [[nodiscard]] InputError undetermined(const std::string& what) const {
        std::string help = "add views of the chart tilted by 20° or more and reaching into the corners";
        if (!options_.known_focal_px) {
            help += ", or state the focal length";
        }
        if (!options_.fix_centre) {
            help += ", or fix the centre";
        }
        return InputError("fitting a camera model: " + std::to_string(views_.size()) +
                          (views_.size() == 1 ? " view does" : " views do") + " not determine " + what + ": " + help);
    }

    void check_determined(const State<Model>& state, const Eigen::MatrixXd& unit, double sigma) const {
        const double judged = std::max(sigma, kLeastSigma_px);
        const double focal_error = judged * std::sqrt(unit(0, 0));
        if (!(focal_error < kUndetermined * std::abs(state.intrinsics[0]))) {
            throw undetermined("the focal length (" + std::to_string(state.intrinsics[0]) + " ± " +
                               std::to_string(focal_error) + " px)");
        }
        const double centre_error = judged * std::sqrt(std::max(unit(1, 1), unit(2, 2)));
        if (!(centre_error < kUndetermined * half_diagonal_)) {
            throw undetermined("the principal point (± " + std::to_string(centre_error) + " px)");
        }
        if (!(state.intrinsics[0] > 0.0)) {
            throw undetermined("the focal length");
        }
    }

    GeometryFit result(const State<Model>& state) const {
        GeometryFit fit;
        Model model{state.intrinsics};
        fit.model = model;
        double sum = 0.0;
        for (std::size_t v = 0; v < views_.size(); ++v) {
            const auto& p = state.poses[v];
            FittedView view{.pose = {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}}, .residuals = {}};
            for (std::size_t i = 0; i < used_[v].size(); ++i) {
                const auto r = residual(state, v, i);
                if (!r) {
                    continue;
                }
                view.residuals.push_back({static_cast<int>(i), *r, used_[v][i]});
                if (used_[v][i]) {
                    sum += r->x * r->x + r->y * r->y;
                    const Vec2d& pixel = views_[v].image_px[i];
                    fit.covered_radius_px = std::max(fit.covered_radius_px, std::hypot(pixel.x - state.intrinsics[1],
                                                                                       pixel.y - state.intrinsics[2]));
                }
            }
            fit.views.push_back(std::move(view));
        }
        fit.points_used = point_count();
        fit.rms_px = std::sqrt(sum / fit.points_used);
        fit.sigma_px = std::sqrt(sum / (2 * fit.points_used - unknown_count()));
        const Eigen::MatrixXd unit = unit_covariance(state);
        check_determined(state, unit, fit.sigma_px);
        const Eigen::MatrixXd covariance = fit.sigma_px * fit.sigma_px * unit;
        fit.covariance.assign(covariance.data(),
                              covariance.data() + covariance.size());  // symmetric: order is no matter
        return fit;
    }

    const std::vector<ChartView>& views_;
    const GeometryOptions& options_;
    Vec2d middle_;
    double half_diagonal_;
    UsedPoints used_;
};

void check_input(const std::vector<ChartView>& views, int width, int height, const GeometryOptions& options) {
    if (views.empty()) {
        throw InputError("fitting a camera model: no views: expected at least one with the chart in it");
    }
    if (width < 1 || height < 1) {
        throw InputError("fitting a camera model: the picture is " + std::to_string(width) + " × " +
                         std::to_string(height));
    }
    if (options.known_focal_px && !(*options.known_focal_px > 0.0 && std::isfinite(*options.known_focal_px))) {
        throw InputError("fitting a camera model: the focal length is " + std::to_string(*options.known_focal_px) +
                         " px: expected a positive length");
    }
    for (const ChartView& view : views) {
        if (view.chart_mm.size() != view.image_px.size() || view.chart_mm.size() < 4) {
            throw InputError(view.name + ": " + std::to_string(view.chart_mm.size()) + " chart points and " +
                             std::to_string(view.image_px.size()) + " image points: expected as many, and at least 4");
        }
        for (std::size_t i = 0; i < view.chart_mm.size(); ++i) {
            if (!std::isfinite(view.chart_mm[i].x + view.chart_mm[i].y + view.image_px[i].x + view.image_px[i].y)) {
                throw InputError(view.name + ": point " + std::to_string(i) + " is not finite");
            }
        }
    }
}

}  // namespace

double GeometryFit::standard_error(int parameter) const {
    const int count = static_cast<int>(parameters(model).size());
    return std::sqrt(covariance[static_cast<std::size_t>(parameter) * (count + 1)]);
}

GeometryFit fit_geometry(const std::vector<ChartView>& views, int width_px, int height_px,
                         const GeometryOptions& options) {
    check_input(views, width_px, height_px, options);
    if (options.model == ModelKind::brown_conrady) {
        return Fit<BrownConrady>(views, width_px, height_px, options).run();
    }
    return Fit<KannalaBrandt>(views, width_px, height_px, options).run();
}

std::optional<Vec2d> predict(const CameraModel& model, const Pose& pose, const Vec2d& chart_mm,
                             double disc_diameter_mm) {
    const auto map = [&](double x, double y, Vec2d& pixel) {
        const auto imaged = project(model, to_camera(pose, {x, y}));
        pixel = imaged.value_or(Vec2d{});
        return imaged.has_value();
    };
    Vec2d predicted;
    const bool imaged = disc_diameter_mm > 0.0 ? disc_centroid(map, chart_mm.x, chart_mm.y, disc_diameter_mm, predicted)
                                               : map(chart_mm.x, chart_mm.y, predicted);
    return imaged ? std::optional(predicted) : std::nullopt;
}

}  // namespace lensproof
