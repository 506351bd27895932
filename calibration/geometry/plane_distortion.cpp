#include "calibration/geometry/plane_distortion.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "calibration/statistics/linear_fit.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

using Eigen::Index;

constexpr Index kHomography = 8;  // row by row, the last element being 1
constexpr Index kMostTerms = 3;
constexpr std::size_t kMostPlaneViews = 8;  // the more points, the rather; every view brings its own eight unknowns
constexpr double kPlaneOutlierSigmas = 6.0;
constexpr double kLeastPlaneSigma_px = 0.005;  // no detector is better
constexpr int kSteps = 30;
constexpr double kPlaneSettled = 1e-10;  // of the parameters, which are of the order of 1

// Points of a view in units of order 1.
struct PlaneView {
    std::size_t index = 0;  // among the views given
    std::vector<Vec2d> chart;
    std::vector<Vec2d> image;
};

struct PlaneFit {
    Eigen::VectorXd parameters;  // eight a view, then the coefficients
    LinearFit last;
};

Vec2d through_homography(const Eigen::VectorXd& p, Index first, const Vec2d& at) {
    const double w = p(first + 6) * at.x + p(first + 7) * at.y + 1.0;
    return {(p(first) * at.x + p(first + 1) * at.y + p(first + 2)) / w,
            (p(first + 3) * at.x + p(first + 4) * at.y + p(first + 5)) / w};
}

// The picture's points less those of the parameters, and how these move with each parameter.
LinearProblem linearised(const std::vector<PlaneView>& views, const Eigen::VectorXd& p) {
    const Index shared = kHomography * static_cast<Index>(views.size());
    Index rows = 0;
    for (const PlaneView& view : views) {
        rows += 2 * static_cast<Index>(view.chart.size());
    }
    LinearProblem problem{.a = Eigen::MatrixXd::Zero(rows, p.size()),
                          .y = Eigen::VectorXd(rows),
                          .row_sigma = Eigen::VectorXd::Ones(rows),
                          .group = {}};
    Index row = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
        const Index first = kHomography * static_cast<Index>(v);
        for (std::size_t i = 0; i < views[v].chart.size(); ++i, row += 2) {
            const Vec2d& at = views[v].chart[i];
            const Vec2d q = through_homography(p, first, at);
            const double w = p(first + 6) * at.x + p(first + 7) * at.y + 1.0;
            const double t = q.x * q.x + q.y * q.y;
            double scale = 1.0;
            double slope = 0.0;  // of the scale, with t
            double power = 1.0;
            for (Index k = shared; k < p.size(); ++k) {
                slope += static_cast<double>(k - shared + 1) * p(k) * power;
                power *= t;
                scale += p(k) * power;
                problem.a(row, k) = q.x * power;
                problem.a(row + 1, k) = q.y * power;
            }
            const Eigen::Vector2d u(q.x, q.y);
            const Eigen::Matrix2d moved = scale * Eigen::Matrix2d::Identity() + 2.0 * slope * u * u.transpose();
            Eigen::Matrix<double, 2, kHomography> of_homography;
            of_homography << at.x, at.y, 1.0, 0.0, 0.0, 0.0, -q.x * at.x, -q.x * at.y,  //
                0.0, 0.0, 0.0, at.x, at.y, 1.0, -q.y * at.x, -q.y * at.y;
            problem.a.block<2, kHomography>(row, first) = moved * of_homography / w;
            problem.y(row) = views[v].image[i].x - scale * q.x;
            problem.y(row + 1) = views[v].image[i].y - scale * q.y;
            problem.group.insert(problem.group.end(), 2, static_cast<int>(row / 2));
        }
    }
    return problem;
}

// The homography by linear least squares, nothing being distorted.
std::optional<Eigen::VectorXd> start_of(const PlaneView& view) {
    const auto rows = static_cast<Index>(2 * view.chart.size());
    LinearProblem problem{.a = Eigen::MatrixXd::Zero(rows, kHomography),
                          .y = Eigen::VectorXd(rows),
                          .row_sigma = Eigen::VectorXd::Ones(rows),
                          .group = {}};
    for (std::size_t i = 0; i < view.chart.size(); ++i) {
        const auto row = static_cast<Index>(2 * i);
        const Vec2d& at = view.chart[i];
        const Vec2d& to = view.image[i];
        problem.a.row(row) << at.x, at.y, 1.0, 0.0, 0.0, 0.0, -to.x * at.x, -to.x * at.y;
        problem.a.row(row + 1) << 0.0, 0.0, 0.0, at.x, at.y, 1.0, -to.y * at.x, -to.y * at.y;
        problem.y(row) = to.x;
        problem.y(row + 1) = to.y;
        problem.group.insert(problem.group.end(), 2, static_cast<int>(i));
    }
    const auto fit = fit_linear(problem, kPlaneOutlierSigmas, 1e-6);
    return fit ? std::optional(fit->parameters) : std::nullopt;
}

// Gauss and Newton's steps: first with all points, then without outliers.
std::optional<PlaneFit> fit_terms(const std::vector<PlaneView>& views, const Eigen::VectorXd& start,
                                  double least_sigma) {
    PlaneFit fit{.parameters = start, .last = {}};
    bool robust = false;
    for (int step = 0; step < kSteps; ++step) {
        auto linear = fit_linear(linearised(views, fit.parameters), robust ? kPlaneOutlierSigmas : 0.0, least_sigma);
        if (!linear || !linear->parameters.allFinite()) {
            return std::nullopt;
        }
        fit.parameters += linear->parameters;
        const double moved = linear->parameters.cwiseAbs().maxCoeff();
        fit.last = std::move(*linear);
        if (moved < (robust ? kPlaneSettled : 1e-4)) {
            if (robust) {
                return fit;
            }
            robust = true;
        }
    }
    return std::nullopt;
}

std::vector<PlaneView> in_units(const std::vector<ChartView>& views, const Vec2d& middle, double half_diagonal) {
    std::vector<PlaneView> result;
    for (std::size_t v = 0; v < views.size(); ++v) {
        const auto box_of = [&](auto coordinate) {
            const auto [low, high] = std::ranges::minmax(views[v].chart_mm, {}, coordinate);
            return std::pair(std::invoke(coordinate, low), std::invoke(coordinate, high));
        };
        const auto x = box_of(&Vec2d::x);
        const auto y = box_of(&Vec2d::y);
        const double size = 0.5 * std::max(x.second - x.first, y.second - y.first);
        PlaneView& own = result.emplace_back();
        own.index = v;
        for (std::size_t i = 0; i < views[v].chart_mm.size(); ++i) {
            const Vec2d& at = views[v].chart_mm[i];
            const Vec2d& to = views[v].image_px[i];
            own.chart.push_back(
                {(at.x - 0.5 * (x.first + x.second)) / size, (at.y - 0.5 * (y.first + y.second)) / size});
            own.image.push_back({(to.x - middle.x) / half_diagonal, (to.y - middle.y) / half_diagonal});
        }
    }
    std::ranges::stable_sort(result, std::greater<>(), [](const PlaneView& view) { return view.chart.size(); });
    result.resize(std::min(result.size(), kMostPlaneViews));
    return result;
}

std::optional<PlaneFit> best_fit(const std::vector<PlaneView>& views, double least_sigma) {
    const Index shared = kHomography * static_cast<Index>(views.size());
    Eigen::VectorXd start = Eigen::VectorXd::Zero(shared);
    for (std::size_t v = 0; v < views.size(); ++v) {
        const auto own = start_of(views[v]);
        if (!own) {
            return std::nullopt;
        }
        start.segment<kHomography>(kHomography * static_cast<Index>(v)) = *own;
    }
    std::optional<PlaneFit> best;
    double least = std::numeric_limits<double>::infinity();
    for (Index terms = 1; terms <= kMostTerms; ++terms) {
        Eigen::VectorXd longer = Eigen::VectorXd::Zero(shared + terms);
        longer.head(start.size()) = start;
        auto fit = fit_terms(views, longer, least_sigma);
        if (!fit) {
            break;
        }
        start = fit->parameters;
        const double judged = aicc(fit->last.chi_squared, fit->last.rows_used, static_cast<double>(longer.size()));
        if (judged < least) {
            least = judged;
            best = std::move(fit);
        }
    }
    return best;
}

// |q| where |p| is `height`, and how |p| grows with it; none beyond the largest height that the coefficients image.
struct Undistorted {
    double height = 0.0;
    double slope = 1.0;
};

std::optional<Undistorted> undistorted(const std::vector<double>& k, double height) {
    Undistorted q{.height = height};
    for (int i = 0; i < 100; ++i) {
        double scale = 1.0;
        q.slope = 1.0;
        double power = 1.0;
        for (std::size_t j = 0; j < k.size(); ++j) {
            power *= q.height * q.height;
            scale += k[j] * power;
            q.slope += static_cast<double>(2 * j + 3) * k[j] * power;
        }
        if (!(q.slope > 0.0)) {
            return std::nullopt;
        }
        const double step = (height - q.height * scale) / q.slope;
        q.height += step;
        if (std::abs(step) <= 1e-14 * height) {
            return q;
        }
    }
    return std::nullopt;
}

}  // namespace

PlaneDistortion fit_plane_distortion(const std::vector<ChartView>& views, int width_px, int height_px) {
    const Vec2d middle{0.5 * (width_px - 1), 0.5 * (height_px - 1)};
    const double half_diagonal = 0.5 * std::hypot(width_px, height_px);
    const std::vector<PlaneView> used = in_units(views, middle, half_diagonal);
    const auto fit = best_fit(used, kLeastPlaneSigma_px / half_diagonal);
    if (!fit) {
        throw InputError(
            "the chart's points do not determine a distortion: expected at least five in each picture, no "
            "four of them on a line, at several distances from the picture's middle");
    }
    PlaneDistortion result;
    const Index shared = kHomography * static_cast<Index>(used.size());
    const Index terms = fit->parameters.size() - shared;
    result.coefficients.assign(fit->parameters.begin() + shared, fit->parameters.end());
    const Eigen::MatrixXd covariance = fit->last.covariance.bottomRightCorner(terms, terms);
    result.covariance.assign(covariance.data(), covariance.data() + covariance.size());
    result.residuals.resize(views.size());
    result.points_used = fit->last.rows_used / 2;
    result.rms_px = half_diagonal * std::sqrt(fit->last.chi_squared / std::max(result.points_used, 1));
    std::size_t row = 0;
    for (const PlaneView& view : used) {
        for (std::size_t i = 0; i < view.image.size(); ++i, row += 2) {
            const auto r = static_cast<Index>(row);
            const bool is_used = fit->last.used[row];
            result.residuals[view.index].push_back(
                {static_cast<int>(i),
                 {half_diagonal * fit->last.residuals(r), half_diagonal * fit->last.residuals(r + 1)},
                 is_used});
            if (is_used) {
                result.covered_radius_px =
                    std::max(result.covered_radius_px, half_diagonal * std::hypot(view.image[i].x, view.image[i].y));
            }
        }
    }
    return result;
}

Curve distortion_curve(const PlaneDistortion& distortion, double half_diagonal_px) {
    const std::size_t count = distortion.coefficients.size();
    Curve curve;
    curve.covered_image_height = distortion.covered_radius_px / half_diagonal_px;
    for (const double height : standard_image_heights()) {
        const auto q = undistorted(distortion.coefficients, height);
        if (!q) {
            break;
        }
        const double value = height > 0.0 ? 100.0 * (height / q->height - 1.0) : 0.0;
        std::vector<double> gradient;  // with the coefficients, at this height
        for (std::size_t j = 0; j < count; ++j) {
            gradient.push_back(100.0 * height * std::pow(q->height, static_cast<double>(2 * j + 1)) / q->slope);
        }
        double variance = 0.0;
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t j = 0; j < count; ++j) {
                variance += gradient[i] * distortion.covariance[i * count + j] * gradient[j];
            }
        }
        const double half_width = k95 * std::sqrt(std::max(variance, 0.0));
        append(curve, height, {value, value - half_width, value + half_width});
    }
    return curve;
}

}  // namespace lensproof::calibration
