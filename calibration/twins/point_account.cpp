#include "calibration/twins/point_account.h"

#include <Eigen/Dense>
#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "calibration/comparison/warp.h"
#include "calibration/statistics/dense_solvers.h"

namespace lensproof::calibration {

namespace {

constexpr std::size_t kManyPoints = 200;
constexpr int kLeastViewsForChart = 3;

/// Columns that explain two rows a point, added block by block.
class Design {
  public:
    explicit Design(std::size_t points) : rows_(2 * static_cast<Eigen::Index>(points)) {}

    Eigen::Index add(Eigen::Index columns) {
        const Eigen::Index first = matrix_.cols();
        matrix_.conservativeResize(rows_, first + columns);
        matrix_.rightCols(columns).setZero();
        return first;
    }
    void set(std::size_t point, Eigen::Index column, const Vec2d& value) {
        matrix_(2 * static_cast<Eigen::Index>(point), column) = value.x;
        matrix_(2 * static_cast<Eigen::Index>(point) + 1, column) = value.y;
    }
    [[nodiscard]] const Eigen::MatrixXd& matrix() const { return matrix_; }

  private:
    Eigen::Index rows_;
    Eigen::MatrixXd matrix_{rows_, 0};
};

/// What is left of displacements once columns are taken from them, and how many of these say something new.
struct Fitted {
    Eigen::VectorXd residual;
    Eigen::Index rank = 0;

    [[nodiscard]] double squares() const { return residual.squaredNorm(); }
};

Fitted fitted(const Eigen::MatrixXd& design, const Eigen::VectorXd& displaced) {
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
    constexpr double kDependent = 1e-9;
    qr.setThreshold(kDependent);
    qr.compute(design);
    return {displaced - design * qr.solve(displaced), qr.rank()};
}

void add_poses(const std::vector<TwinPoint>& points, const FrameScale& frame, Design& design) {
    std::map<int, Eigen::Index> columns;
    for (const TwinPoint& point : points) {
        columns.emplace(point.view, 0);
    }
    for (auto& [view, column] : columns) {
        column = design.add(kMostWarpTerms);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto moves = displacements(frame.unit(points[i].twin_px.x, points[i].twin_px.y));
        for (std::size_t k = 0; k < moves.size(); ++k) {
            design.set(i, columns[points[i].view] + static_cast<Eigen::Index>(k), moves[k]);
        }
    }
}

/// Powers of the place from the second degree on, for x and for y; lower ones are poses.
void add_lens(const std::vector<TwinPoint>& points, const FrameScale& frame, Design& design) {
    const int degree = points.size() < kManyPoints ? 3 : 5;
    for (int power = 2; power <= degree; ++power) {
        for (int of_y = 0; of_y <= power; ++of_y) {
            const Eigen::Index column = design.add(2);
            for (std::size_t i = 0; i < points.size(); ++i) {
                const Vec2d u = frame.unit(points[i].twin_px.x, points[i].twin_px.y);
                const double value = std::pow(u.x, power - of_y) * std::pow(u.y, of_y);
                design.set(i, column, {value, 0.0});
                design.set(i, column + 1, {0.0, value});
            }
        }
    }
}

void add_chart(const std::vector<TwinPoint>& points, Design& design) {
    std::map<int, Eigen::Index> columns;
    for (const TwinPoint& point : points) {
        columns.emplace(point.feature, 0);
    }
    for (auto& [feature, column] : columns) {
        column = design.add(2);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Index column = columns[points[i].feature];
        design.set(i, column, points[i].by_chart_x_px);
        design.set(i, column + 1, points[i].by_chart_y_px);
    }
}

/// Of what a block took from the sum of squares: of n coordinates with variance s² of noise, a fraction of variance λ
/// s² / n makes squares that are s² times χ² of the block's degrees of freedom k and noncentrality λ, of which the mean
/// is k + λ and the variance 2 (k + 2 λ).
TwinDisplacement displacement_of(const Fitted& before, const Fitted& after, double variance, double coordinates) {
    const auto freedom = static_cast<double>(after.rank - before.rank);
    const double squares = (before.squares() - after.squares()) / variance;
    const double noncentral = std::max(0.0, squares - freedom);
    const double mean_square = variance * noncentral / coordinates;
    const double spread = variance * std::sqrt(2.0 * (freedom + 2.0 * noncentral)) / coordinates;
    TwinDisplacement displacement{.rms_px = std::sqrt(mean_square)};
    displacement.standard_error_px = std::sqrt(mean_square + spread) - displacement.rms_px;
    displacement.significance = freedom > 0.0 ? squares / freedom : 0.0;
    return displacement;
}

Curve radial_curve(const std::vector<TwinPoint>& points, const std::vector<Vec2d>& lens_px, const FrameScale& frame,
                   double sigma_px) {
    constexpr int kRings = 12;
    struct Ring {
        double height = 0.0;
        double sum = 0.0;
        double squares = 0.0;
        int count = 0;
    };
    std::vector<Ring> rings(kRings);
    double farthest = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec2d u = frame.unit(points[i].twin_px.x, points[i].twin_px.y);
        const double height = length(u);
        farthest = std::max(farthest, height);
        Ring& ring = rings[static_cast<std::size_t>(std::clamp(static_cast<int>(height * kRings), 0, kRings - 1))];
        const double along = height > 0.0 ? dot(lens_px[i], u) / height : 0.0;
        ring.height += height;
        ring.sum += along;
        ring.squares += along * along;
        ++ring.count;
    }
    Curve curve;
    for (const Ring& ring : rings) {
        if (ring.count >= 2) {
            const double mean = ring.sum / ring.count;
            const double scatter = std::max(0.0, ring.squares / ring.count - mean * mean);
            const double error = std::sqrt((scatter + sigma_px * sigma_px) / ring.count);
            append(curve, ring.height / ring.count, {mean, mean - k95 * error, mean + k95 * error});
        }
    }
    curve.covered_image_height = farthest;
    return curve;
}

}  // namespace

PointAccount account_of_points(const std::vector<TwinPoint>& points, int width_px, int height_px) {
    const FrameScale frame(width_px, height_px);
    const auto rows = 2 * static_cast<Eigen::Index>(points.size());
    Eigen::VectorXd displaced(rows);
    double expected = 0.0;
    double known = 0.0;  // coordinates
    std::set<int> views;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const TwinPoint& point = points[i];
        displaced.segment<2>(2 * static_cast<Eigen::Index>(i)) << point.photo_px.x - point.twin_px.x,
            point.photo_px.y - point.twin_px.y;
        if (point.standard_error_px) {
            expected += dot(*point.standard_error_px, *point.standard_error_px);
            known += 2.0;
        }
        views.insert(point.view);
    }
    Design design(points.size());
    add_poses(points, frame, design);
    const Fitted poses = fitted(design.matrix(), displaced);
    add_lens(points, frame, design);
    const Fitted lens = fitted(design.matrix(), displaced);
    const bool tells_chart = static_cast<int>(views.size()) >= kLeastViewsForChart;
    if (tells_chart) {
        add_chart(points, design);
    }
    const Fitted rest = tells_chart ? fitted(design.matrix(), displaced) : lens;
    const double freedom = std::max(1.0, static_cast<double>(rows - rest.rank));
    const double variance = std::max(1e-12, rest.squares() / freedom);
    PointAccount account{.points = static_cast<int>(points.size()),
                         .views = static_cast<int>(views.size()),
                         .displaced_px = std::sqrt(displaced.squaredNorm() / static_cast<double>(rows)),
                         .lens = displacement_of(poses, lens, variance, static_cast<double>(rows)),
                         .chart = {},
                         .rest_px = std::sqrt(variance),
                         .expected_px = std::sqrt(expected / known),
                         .lens_px = {}};
    if (tells_chart) {
        account.chart = displacement_of(lens, rest, variance, static_cast<double>(rows));
    }
    const Eigen::VectorXd by_lens = poses.residual - lens.residual;
    for (Eigen::Index i = 0; i < rows; i += 2) {
        account.lens_px.push_back({by_lens[i], by_lens[i + 1]});
    }
    account.radial_px = radial_curve(points, account.lens_px, frame, account.rest_px);
    return account;
}

std::array<Vec2d, 2> steps_on_chart(const std::vector<Vec2d>& chart_mm, const std::vector<Vec2d>& image_px,
                                    const Vec2d& at_mm) {
    constexpr std::size_t kNearest = 9;
    std::vector<std::size_t> nearest(chart_mm.size());
    std::iota(nearest.begin(), nearest.end(), 0);
    const std::size_t count = std::min(kNearest, nearest.size());
    std::ranges::partial_sort(nearest, nearest.begin() + static_cast<std::ptrdiff_t>(count), {},
                              [&](std::size_t i) { return length(chart_mm[i] - at_mm); });
    Eigen::MatrixXd design(static_cast<Eigen::Index>(count), 3);
    Eigen::MatrixXd places(static_cast<Eigen::Index>(count), 2);
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t i = nearest[k];
        const auto row = static_cast<Eigen::Index>(k);
        design.row(row) << 1.0, chart_mm[i].x - at_mm.x, chart_mm[i].y - at_mm.y;
        places.row(row) << image_px[i].x, image_px[i].y;
    }
    const Eigen::MatrixXd terms = least_norm_solution(design, places);
    return {Vec2d{terms(1, 0), terms(1, 1)}, Vec2d{terms(2, 0), terms(2, 1)}};
}

void fields(JsonArchive& json, TwinPoint& point) {
    json.field("view", point.view)
        .field("feature", point.feature)
        .field("photo_px", point.photo_px)
        .field("twin_px", point.twin_px)
        .field("standard_error_px", point.standard_error_px)
        .field("by_chart_x_px", point.by_chart_x_px)
        .field("by_chart_y_px", point.by_chart_y_px);
}

}  // namespace lensproof::calibration
