#include "calibration/geometry/cross_validation.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "calibration/geometry/projection_uncertainty.h"
#include "calibration/geometry/rotation_fit.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

constexpr std::size_t kManyViews = 20;  // half of them still make a good fit
constexpr int kFolds = 5;
constexpr std::size_t kLeastPoints = 4;  // that tell a pose
constexpr int kGridColumns = 25;
constexpr std::size_t kLeastGridPoints = 10;

template <class Keep>
std::vector<ChartView> some_views(const std::vector<ChartView>& views, const Keep& keep) {
    std::vector<ChartView> result;
    for (std::size_t v = 0; v < views.size(); ++v) {
        if (keep(v)) {
            result.push_back(views[v]);
        }
    }
    return result;
}

template <class Keep>
std::vector<ChartView> some_points(const std::vector<ChartView>& views, const Keep& keep) {
    std::vector<ChartView> result;
    for (std::size_t v = 0; v < views.size(); ++v) {
        ChartView view{.name = views[v].name, .chart_mm = {}, .image_px = {}};
        for (std::size_t i = 0; i < views[v].image_px.size(); ++i) {
            if (keep(v, i)) {
                add_point(view, views[v], i);
            }
        }
        result.push_back(std::move(view));
    }
    return result;
}

// Mean squared distance of a view's points from where `fit`'s camera, brought to the view's own pose, expects them.
double held_out_error(const ChartView& view, const PoseParameters& start, const GeometryFit& fit, double disc) {
    PointBundle bundle = make_bundle({view}, disc);
    if (fit.board) {
        bundle.frame = fit.board->frame;
    }
    BundleState state = state_of(fit);
    state.poses = {start};
    Held held;
    for (int i = 0; i < static_cast<int>(parameters(state.model).size()); ++i) {
        held.intrinsics.push_back(i);
    }
    solve(bundle, state, held);
    double sum = 0.0;
    for (std::size_t i = 0; i < view.image_px.size(); ++i) {
        // A model that images nothing there is wrong by all it could be.
        const Vec2d r = residual(bundle, state, 0, i).value_or(view.image_px[i]);
        sum += r.x * r.x + r.y * r.y;
    }
    return view.weight * sum / static_cast<double>(view.image_px.size());
}

std::vector<Vec2d> grid(int width, int height) {
    const int rows = std::max(2, kGridColumns * height / width);
    std::vector<Vec2d> pixels;
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < kGridColumns; ++i) {
            pixels.push_back({(width - 1.0) * i / (kGridColumns - 1), (height - 1.0) * j / (rows - 1)});
        }
    }
    return pixels;
}

}  // namespace

std::optional<HalvesDifference> mapping_difference(const CameraModel& a, const CameraModel& b,
                                                   const std::vector<Vec2d>& pixels) {
    std::vector<Vec2d> seen;
    std::vector<Vec3d> by_a;
    std::vector<Vec3d> by_b;
    for (const Vec2d& pixel : pixels) {
        const auto ray_a = unproject(a, pixel);
        const auto ray_b = unproject(b, pixel);
        if (ray_a && ray_b) {
            seen.push_back(pixel);
            by_a.push_back(*ray_a);
            by_b.push_back(*ray_b);
        }
    }
    if (seen.size() < kLeastGridPoints) {
        return std::nullopt;
    }
    const Eigen::Matrix3d rotation = rotation_onto(by_a, by_b);
    HalvesDifference difference;
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        const Eigen::Vector3d turned = rotation * Eigen::Vector3d(by_a[i].x, by_a[i].y, by_a[i].z);
        if (const auto pixel = project(b, {turned(0), turned(1), turned(2)})) {
            const double distance = std::hypot(pixel->x - seen[i].x, pixel->y - seen[i].y);
            difference.largest_px = std::max(difference.largest_px, distance);
            sum += distance * distance;
            ++count;
        }
    }
    difference.rms_px = std::sqrt(sum / std::max(count, 1));
    return difference;
}

namespace {

class Validation {
  public:
    Validation(const std::vector<ChartView>& views, int width, int height, const GeometryOptions& options,
               const GeometryFit& fit)
        : width_(width), height_(height), options_(options), fit_(fit) {
        options_.outlier_sigmas = 0.0;
        const std::vector<ChartView> used = used_points(views, fit);
        for (std::size_t v = 0; v < used.size(); ++v) {
            if (used[v].image_px.size() >= kLeastPoints) {
                views_.push_back(used[v]);
                poses_.push_back(pose_parameters(fit.views[v].pose));
            }
        }
    }

    CrossValidation run() {
        CrossValidation result;
        result.held_out_squared_px.assign(views_.size(), 0.0);
        if (views_.size() == 1) {
            split_points(result);
        } else {
            const bool halves = views_.size() >= kManyViews;
            result.folds = halves ? 2 : std::min(kFolds, static_cast<int>(views_.size()));
            for (int fold = 0; fold < result.folds; ++fold) {
                leave_out(fold, result);
            }
        }
        double sum = 0.0;
        std::size_t count = 0;
        for (std::size_t v = 0; v < views_.size(); ++v) {
            sum += result.held_out_squared_px[v] * static_cast<double>(views_[v].image_px.size());
            count += views_[v].image_px.size();
        }
        result.held_out_rms_px = std::sqrt(sum / static_cast<double>(count));
        result.halves = halves_difference();
        return result;
    }

  private:
    [[nodiscard]] bool in_fold(std::size_t view, int fold, int folds) const {
        return static_cast<int>(view % static_cast<std::size_t>(folds)) == fold;
    }

    // A fit to the views whose number modulo `folds` is not `fold`.
    [[nodiscard]] GeometryFit fit_without(int fold, int folds) {
        const auto keep = [&](std::size_t v) { return !in_fold(v, fold, folds); };
        BundleState start = state_of(fit_);
        start.poses.clear();
        for (std::size_t v = 0; v < views_.size(); ++v) {
            if (keep(v)) {
                start.poses.push_back(poses_[v]);
            }
        }
        return refit_geometry(some_views(views_, keep), width_, height_, options_, start);
    }

    void leave_out(int fold, CrossValidation& result) {
        const GeometryFit rest = fit_without(fold, result.folds);
        if (result.folds == 2) {
            halves_.push_back(rest.model);
        }
        for (std::size_t v = 0; v < views_.size(); ++v) {
            if (in_fold(v, fold, result.folds)) {
                result.held_out_squared_px[v] = held_out_error(views_[v], poses_[v], rest, options_.disc_diameter_mm);
            }
        }
    }

    // Each fifth of a single view's points against the other four, which tell the pose too.
    void split_points(CrossValidation& result) {
        result.folds = kFolds;
        double sum = 0.0;
        for (int fold = 0; fold < kFolds; ++fold) {
            const auto left_out = [&](std::size_t /*view*/, std::size_t i) { return in_fold(i, fold, kFolds); };
            const auto rest = some_points(views_, [&](std::size_t v, std::size_t i) { return !left_out(v, i); });
            const GeometryFit fit = refit_geometry(rest, width_, height_, options_, state_of(fit_));
            PointBundle tested = make_bundle(some_points(views_, left_out), options_.disc_diameter_mm);
            if (fit.board) {
                tested.frame = fit.board->frame;
            }
            const BundleState state = state_of(fit);
            for (std::size_t i = 0; i < tested.views[0].image_px.size(); ++i) {
                const Vec2d r = residual(tested, state, 0, i).value_or(tested.views[0].image_px[i]);
                sum += r.x * r.x + r.y * r.y;
            }
        }
        result.held_out_squared_px[0] = sum / static_cast<double>(views_[0].image_px.size());
    }

    std::optional<HalvesDifference> halves_difference() {
        if (views_.size() < 4) {
            return std::nullopt;
        }
        try {
            for (int half = static_cast<int>(halves_.size()); half < 2; ++half) {
                halves_.push_back(fit_without(half, 2).model);
            }
        } catch (const InputError&) {
            return std::nullopt;  // half the views do not determine a camera
        }
        std::vector<Vec2d> pixels = grid(width_, height_);
        const std::vector<bool> covered = covered_pixels(views_, pixels);
        std::vector<Vec2d> inside;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            if (covered[i]) {
                inside.push_back(pixels[i]);
            }
        }
        return mapping_difference(halves_[0], halves_[1], inside);
    }

    std::vector<ChartView> views_;
    std::vector<PoseParameters> poses_;
    int width_;
    int height_;
    GeometryOptions options_;
    const GeometryFit& fit_;
    std::vector<CameraModel> halves_;
};

}  // namespace

CrossValidation cross_validate(const std::vector<ChartView>& views, int width_px, int height_px,
                               const GeometryOptions& options, const GeometryFit& fit) {
    return Validation(views, width_px, height_px, options, fit).run();
}

}  // namespace lensproof::calibration
