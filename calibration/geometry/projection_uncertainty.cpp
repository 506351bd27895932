#include "calibration/geometry/projection_uncertainty.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calibration/statistics/dense_solvers.h"

namespace lensproof::calibration {
namespace {

constexpr double kLeast_px = 1e-9;  // that weights are finite

// Derivative of `function` (a pixel) by central differences; the projections are smooth, and a step of 1e-6 of the
// parameter's own scale leaves nine digits. None where a side is not imaged.
template <class Function>
std::optional<Eigen::Vector2d> derivative(const Function& function, double step) {
    const std::optional<Vec2d> above = function(step);
    const std::optional<Vec2d> below = function(-step);
    if (!above || !below) {
        return std::nullopt;
    }
    return Eigen::Vector2d((above->x - below->x) / (2.0 * step), (above->y - below->y) / (2.0 * step));
}

// ∂q/∂(intrinsics), in the columns of the shared parameters (the board's heights have no part in it).
std::optional<Eigen::MatrixXd> by_intrinsics(const GeometryFit& fit, const Vec3d& point, int shared) {
    const std::vector<double> values = parameters(fit.model);
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(2, shared);
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (fit.covariance[i * (values.size() + 1)] == 0.0) {
            continue;
        }
        const auto column = derivative(
            [&](double step) {
                std::vector<double> moved = values;
                moved[i] += step;
                return project(with_parameters(fit.model, moved), point);
            },
            1e-6 * std::max(1.0, std::abs(values[i])));
        if (!column) {
            return std::nullopt;
        }
        jacobian.col(static_cast<Eigen::Index>(i)) = *column;
    }
    return jacobian;
}

std::optional<Eigen::Matrix<double, 2, 3>> by_point(const CameraModel& model, const Vec3d& point) {
    Eigen::Matrix<double, 2, 3> jacobian;
    for (int axis = 0; axis < 3; ++axis) {
        const auto column = derivative(
            [&](double step) {
                Vec3d moved = point;
                (axis == 0 ? moved.x : axis == 1 ? moved.y : moved.z) += step;
                return project(model, moved);
            },
            1e-6 * length(point));
        if (!column) {
            return std::nullopt;
        }
        jacobian.col(axis) = *column;
    }
    return jacobian;
}

Eigen::Matrix3d cross_matrix(const Vec3d& v) {
    Eigen::Matrix3d matrix;
    matrix << 0.0, -v.z, v.y, v.z, 0.0, -v.x, -v.y, v.x, 0.0;
    return matrix;
}

// How a rotation vector r that changes by δr turns the rotated vectors: R(r + δr) = exp([J δr]×) R(r), J the left
// Jacobian of the rotation group (Chirikjian 2011, Stochastic Models, eq. 10.86).
Eigen::Matrix3d left_jacobian(const Vec3d& r) {
    const double angle = length(r);
    const Eigen::Matrix3d k = cross_matrix(r);
    const double a = angle > 1e-4 ? (1.0 - std::cos(angle)) / (angle * angle) : 0.5 - angle * angle / 24.0;
    const double b =
        angle > 1e-4 ? (angle - std::sin(angle)) / (angle * angle * angle) : 1.0 / 6.0 - angle * angle / 120.0;
    return Eigen::Matrix3d::Identity() + a * k + b * k * k;
}

// ∂p/∂pose for a point p that is fixed on the chart: p − t turns about the chart's origin, and t moves it. A direction
// (infinitely far) turns only.
Eigen::Matrix<double, 3, 6> point_by_pose(const Pose& pose, const Vec3d& point, bool infinite) {
    Eigen::Matrix<double, 3, 6> jacobian = Eigen::Matrix<double, 3, 6>::Zero();
    const Vec3d arm = infinite ? point : point - pose.translation_mm;
    jacobian.leftCols<3>() = -cross_matrix(arm) * left_jacobian(pose.rotation_rad);
    if (!infinite) {
        jacobian.rightCols<3>().setIdentity();
    }
    return jacobian;
}

// In the frame of another fit of the same views, what is at `point` in that of `fit`.
Vec3d seen_by(const GeometryFit& other, const GeometryFit& fit, const Vec3d& point, bool infinite) {
    Vec3d mean;
    for (std::size_t v = 0; v < fit.views.size(); ++v) {
        const Pose& from = fit.views[v].pose;
        const Pose& to = other.views[v].pose;
        const Pose back{.rotation_rad = -1.0 * from.rotation_rad, .translation_mm = {}};
        const Vec3d moved = turned(to, turned(back, infinite ? point : point - from.translation_mm));
        mean = mean + (1.0 / static_cast<double>(fit.views.size())) * (infinite ? moved : moved + to.translation_mm);
    }
    return mean;
}

// Of noise, and of models that differ.
std::optional<double> together(const std::optional<double>& noise, const std::optional<double>& models) {
    return noise ? std::optional(std::hypot(*noise, models.value_or(0.0))) : std::nullopt;
}

Vec3d chart_centre(const ChartView& view, const Pose& pose) {
    Vec2d middle;
    for (const Vec2d& p : view.chart_mm) {
        middle.x += p.x / static_cast<double>(view.chart_mm.size());
        middle.y += p.y / static_cast<double>(view.chart_mm.size());
    }
    return to_camera(pose, middle);
}

std::vector<cv::Point2f> hull_of(const std::vector<Vec2d>& points) {
    std::vector<cv::Point2f> single;
    single.reserve(points.size());
    for (const Vec2d& p : points) {
        single.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y));
    }
    std::vector<cv::Point2f> hull;
    cv::convexHull(single, hull);
    return hull;
}

}  // namespace

std::optional<double> projection_uncertainty_px(const GeometryFit& fit, const Vec2d& pixel,
                                                std::optional<double> distance_mm) {
    const auto ray = unproject(fit.model, pixel);
    if (!ray) {
        return std::nullopt;
    }
    const Vec3d point = distance_mm.value_or(1.0) * *ray;
    const int shared = static_cast<int>(parameters(fit.model).size()) + kBoardTerms;
    auto total = by_intrinsics(fit, point, shared);
    const auto slope = by_point(fit.model, point);
    if (!total || !slope) {
        return std::nullopt;
    }
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
    Eigen::Matrix2d variance = Eigen::Matrix2d::Zero();
    const double weight = 1.0 / static_cast<double>(fit.views.size());
    for (const FittedView& view : fit.views) {
        const Eigen::Matrix<double, 2, 6> b = weight * *slope * point_by_pose(view.pose, point, !distance_mm);
        *total += b * Eigen::Map<const RowMajor>(view.pose_follows.data(), 6, shared);
        variance += b * Eigen::Map<const Matrix6>(view.pose_covariance.data()) * b.transpose();
    }
    variance += *total * Eigen::Map<const RowMajor>(fit.shared_covariance.data(), shared, shared) * total->transpose();
    return std::sqrt(std::max(symmetric_eigen(variance).values(1), 0.0));
}

std::optional<double> models_disagreement_px(const GeometryFit& fit, const std::vector<GeometryFit>& rivals,
                                             const Vec2d& pixel, std::optional<double> distance_mm) {
    const auto ray = unproject(fit.model, pixel);
    if (!ray) {
        return std::nullopt;
    }
    struct Opinion {
        double distance = 0.0;
        double weight = 0.0;
    };
    std::vector<Opinion> opinions;
    double sum = 0.0;
    for (const GeometryFit& rival : rivals) {
        const auto at = project(rival.model, seen_by(rival, fit, distance_mm.value_or(1.0) * *ray, !distance_mm));
        if (at) {
            const double distance = std::hypot(at->x - pixel.x, at->y - pixel.y);
            const double own = projection_uncertainty_px(rival, *at, distance_mm).value_or(distance);
            sum +=
                opinions.emplace_back(Opinion{distance, 1.0 / std::max(std::hypot(distance, own), kLeast_px)}).weight;
        }
    }
    std::ranges::sort(opinions, {}, &Opinion::distance);
    double nearer = 0.0;
    for (const Opinion& opinion : opinions) {
        nearer += opinion.weight;
        if (nearer >= 0.5 * sum) {
            return opinion.distance;
        }
    }
    return std::nullopt;
}

std::vector<ChartView> used_points(const std::vector<ChartView>& views, const GeometryFit& fit) {
    std::vector<ChartView> result;
    for (std::size_t v = 0; v < views.size(); ++v) {
        ChartView& view = result.emplace_back(
            ChartView{.name = views[v].name, .chart_mm = {}, .image_px = {}, .weight = fit.views[v].weight});
        for (const PointResidual& r : fit.views[v].residuals) {
            if (r.used) {
                add_point(view, views[v], static_cast<std::size_t>(r.index));
            }
        }
    }
    return result;
}

std::vector<Vec2d> convex_hull(const std::vector<Vec2d>& points) {
    std::vector<Vec2d> corners;
    for (const cv::Point2f& p : hull_of(points)) {
        corners.push_back({p.x, p.y});
    }
    return corners;
}

std::vector<bool> covered_pixels(const std::vector<ChartView>& views, const std::vector<Vec2d>& pixels) {
    std::vector<Vec2d> points;
    for (const ChartView& view : views) {
        points.insert(points.end(), view.image_px.begin(), view.image_px.end());
    }
    const std::vector<cv::Point2f> hull = hull_of(points);
    std::vector<bool> inside;
    for (const Vec2d& p : pixels) {
        const cv::Point2f at(static_cast<float>(p.x), static_cast<float>(p.y));
        inside.push_back(cv::pointPolygonTest(hull, at, false) >= 0.0);
    }
    return inside;
}

UncertaintyMap uncertainty_map(const GeometryFit& fit, const std::vector<ChartView>& views, int width_px, int height_px,
                               const std::vector<GeometryFit>& rivals, int columns) {
    UncertaintyMap map;
    map.columns = columns;
    map.rows = std::max(2, static_cast<int>(std::lround(1.0 + (columns - 1.0) * height_px / width_px)));
    for (int i = 0; i < map.columns; ++i) {
        map.x_px.push_back((width_px - 1.0) * i / (map.columns - 1));
    }
    for (int j = 0; j < map.rows; ++j) {
        map.y_px.push_back((height_px - 1.0) * j / (map.rows - 1));
    }
    const auto charts = static_cast<double>(std::ranges::count(views, false, &ChartView::is_far));
    for (std::size_t v = 0; v < views.size(); ++v) {
        map.near_mm += views[v].is_far() ? 0.0 : length(chart_centre(views[v], fit.views[v].pose)) / charts;
    }
    std::vector<Vec2d> pixels;
    for (const double y : map.y_px) {
        for (const double x : map.x_px) {
            const Vec2d& pixel = pixels.emplace_back(Vec2d{x, y});
            const auto models = models_disagreement_px(fit, rivals, pixel);
            map.far_px.push_back(together(projection_uncertainty_px(fit, pixel), models));
            map.near_px.push_back(charts > 0.0 ? together(projection_uncertainty_px(fit, pixel, map.near_mm),
                                                          models_disagreement_px(fit, rivals, pixel, map.near_mm))
                                               : std::nullopt);
            if (!rivals.empty()) {
                map.models_px.push_back(models);
            }
        }
    }
    map.covered = covered_pixels(used_points(views, fit), pixels);
    return map;
}

}  // namespace lensproof::calibration
