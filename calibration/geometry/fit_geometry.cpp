#include "calibration/geometry/fit_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "calibration/geometry/bundle_start.h"
#include "engine/base/input_error.h"
#include "engine/base/order_statistics.h"

namespace lensproof::calibration {
namespace {

constexpr double kSmallestOutlier_px = 0.1;  // no point this close is ever an outlier
constexpr int kOutlierRounds = 3;
// Of a view's points: normal noise has no outlier at 6 sigmas. The view is off, and not some of its points, if its
// robust spread is this often that of all (of twenty points it is known to a fifth), or if so many outliers in one view
// are that improbable where the other views have theirs.
constexpr double kOutliersByView = 0.1;
constexpr double kSpreadByView = 2.0;
constexpr double kImprobable = 1e-4;
constexpr double kSigmasOfTenth = 1.645;  // a tenth of normal noise's magnitudes is larger
constexpr double kHeavyTails = 1.5;       // of the plain standard deviation over the robust one, 1 for normal noise
constexpr double kUndetermined = 0.05;    // a relative standard error above this is no measurement
constexpr double kLeastSigma_px = 0.01;   // no detector is better; judges views whose residuals happen to be tiny

class Fit {
  public:
    Fit(const std::vector<ChartView>& views, int width, int height, const GeometryOptions& options)
        : bundle_(make_bundle(views, options.disc_diameter_mm)), options_(options), width_(width), height_(height) {}

    // From nothing: an undistorted camera of the best focal length, then Brown and Conrady's or Kannala and Brandt's
    // model, and from there any other.
    GeometryFit run() {
        std::vector<ModelKind> first;
        if (is_perspective(empty_model(options_.model))) {
            first.push_back(ModelKind::brown_conrady);
        }
        if (first.empty() || options_.model == ModelKind::division) {  // which reaches beyond 90°
            first.push_back(ModelKind::kannala_brandt);
        }
        std::optional<BundleState> start;
        double least = std::numeric_limits<double>::infinity();
        for (const ModelKind model : first) {
            auto [cost, state] = best_start(model);
            if (cost < least) {
                least = cost;
                start = std::move(state);
            }
        }
        if (!start) {
            throw InputError("fitting a camera model: the views do not agree with any " +
                             kind_name(empty_model(first.front())) + " camera");
        }
        return run_from(*start);
    }

    GeometryFit run_from(const BundleState& start) {
        check_counts();
        BundleState state = start;
        state.model = kind(start.model) == options_.model ? without_held_terms(start.model) : start_model(start);
        if (kind(start.model) != options_.model || parameters(state.model) != parameters(start.model)) {
            Held all_but_terms = held();
            all_but_terms.poses = true;
            all_but_terms.heights = true;
            solve(bundle_, state, all_but_terms);
        }
        if (!options_.fit_board_shape) {
            state.heights = {};
        }
        solve(bundle_, state, held());
        for (int round = 0; round < kOutlierRounds && options_.outlier_sigmas > 0.0; ++round) {
            if (!drop_outliers(state, round == 0)) {
                break;
            }
            check_counts();
            solve(bundle_, state, held());
        }
        return result(state);
    }

  private:
    [[nodiscard]] Held held() const { return held_in(empty_model(options_.model)); }

    [[nodiscard]] Held held_in(const CameraModel& model) const {
        std::vector<bool> is_held(parameters(model).size(), true);
        is_held[0] = options_.known_focal_px.has_value();
        is_held[1] = is_held[2] = options_.fix_centre;
        const ModelTerms terms = model_terms(model);
        const int all = static_cast<int>(terms.radial.size());
        for (int i = 0; i < std::clamp(options_.radial_terms.value_or(all), 0, all); ++i) {
            is_held[static_cast<std::size_t>(terms.radial[static_cast<std::size_t>(i)])] = false;
        }
        is_held.back() = !options_.fit_stretch;
        for (const int i : terms.tangential) {
            is_held[static_cast<std::size_t>(i)] = !options_.fit_tangential;
        }
        Held held{.intrinsics = {}, .poses = false, .heights = !options_.fit_board_shape};
        for (std::size_t i = 0; i < is_held.size(); ++i) {
            if (is_held[i]) {
                held.intrinsics.push_back(static_cast<int>(i));
            }
        }
        return held;
    }

    [[nodiscard]] int unknown_count() const {
        const auto free = parameters(empty_model(options_.model)).size() - held().intrinsics.size();
        return std::accumulate(bundle_.views.begin(), bundle_.views.end(),
                               static_cast<int>(free) + (options_.fit_board_shape ? kBoardTerms : 0),
                               [](int sum, const ChartView& view) { return sum + view.pose_unknowns(); });
    }

    void check_counts() const {
        if (2 * count_used(bundle_) <= unknown_count()) {
            throw InputError("fitting a camera model: " + std::to_string(count_used(bundle_)) + " points in " +
                             std::to_string(bundle_.views.size()) + " views cannot determine " +
                             std::to_string(unknown_count()) + " unknowns: expected more points or views");
        }
    }

    // A term that is not fitted is 0, whatever the start has there.
    [[nodiscard]] CameraModel without_held_terms(const CameraModel& model) const {
        std::vector<double> values = parameters(model);
        const ModelTerms terms = model_terms(model);
        std::vector<int> distorting = terms.radial;
        distorting.insert(distorting.end(), terms.tangential.begin(), terms.tangential.end());
        distorting.push_back(static_cast<int>(values.size()) - 1);  // the stretch
        for (const int i : held().intrinsics) {
            if (std::ranges::find(distorting, i) != distorting.end()) {
                values[static_cast<std::size_t>(i)] = 0.0;
            }
        }
        return with_parameters(model, values);
    }

    // The model to fit, without distortion, with the start's first three parameters and its own constants.
    [[nodiscard]] CameraModel start_model(const BundleState& start) const {
        const CameraModel model = empty_model(options_.model);
        std::vector<double> values = parameters(model);
        std::copy_n(parameters(start.model).begin(), 3, values.begin());
        values.back() = stretch_y(start.model);
        const std::vector<std::string> names = parameter_names(model);
        for (std::size_t i = 3; i < names.size(); ++i) {
            if (names[i] == "normalisation_px") {
                values[i] = std::max(0.5 * (std::min(width_, height_) - 1), 0.5);
            } else if (names[i] == "spline_end_rad") {
                values[i] = largest_angle(start);
            }
        }
        return without_held_terms(with_parameters(model, values));
    }

    // The angle from the axis of the outermost feature.
    [[nodiscard]] double largest_angle(const BundleState& state) const {
        double largest = 0.0;
        for (std::size_t v = 0; v < bundle_.views.size(); ++v) {
            for (std::size_t i = 0; i < bundle_.views[v].image_px.size(); ++i) {
                const Vec3d at = in_camera(bundle_.views[v], i, to_pose(state.poses[v]));
                largest = std::max(largest, std::atan2(std::hypot(at.x, at.y), at.z));
            }
        }
        return largest;
    }

    struct Start {
        double cost = 0.0;
        BundleState state;
    };

    // Fits from the few best starts; the best of these fits wins.
    [[nodiscard]] Start best_start(ModelKind model) const {
        auto starts = bundle_starts(bundle_, model, width_, height_, options_.known_focal_px);
        starts.resize(std::min<std::size_t>(starts.size(), 3));
        Start best{.cost = std::numeric_limits<double>::infinity(), .state = {}};
        for (BundleStart& start : starts) {
            // Focal length and poses first, so that the distortion does not run after a wrong scale.
            Held all_but_focal;
            const int count = static_cast<int>(parameters(start.state.model).size());
            for (int i = options_.known_focal_px ? 0 : 1; i < count; ++i) {
                all_but_focal.intrinsics.push_back(i);
            }
            solve(bundle_, start.state, all_but_focal);
            Held flat = held_in(start.state.model);
            flat.heights = true;
            const double cost = solve(bundle_, start.state, flat);
            if (cost < best.cost) {
                best = {cost, start.state};
            }
        }
        return best;
    }

    // Standard deviation of a coordinate as the median magnitude tells it, and as the mean square does.
    struct Spread {
        double robust = 0.0;
        double plain = 0.0;
    };

    [[nodiscard]] Spread spread(const BundleState& state) const {
        std::vector<double> magnitudes;
        double sum = 0.0;
        for (std::size_t v = 0; v < bundle_.views.size(); ++v) {
            const double root_weight = std::sqrt(bundle_.views[v].weight);
            for (std::size_t i = 0; i < bundle_.used[v].size(); ++i) {
                if (!bundle_.used[v][i]) {
                    continue;
                }
                if (const auto r = residual(bundle_, state, v, i)) {
                    magnitudes.push_back(root_weight * std::abs(r->x));
                    magnitudes.push_back(root_weight * std::abs(r->y));
                    sum += bundle_.views[v].weight * (r->x * r->x + r->y * r->y);
                }
            }
        }
        if (magnitudes.empty()) {
            return {};
        }
        return {.robust = kSigmaPerMedian * median(magnitudes),
                .plain = std::sqrt(sum / static_cast<double>(magnitudes.size()))};
    }

    // True when the set of used points has changed. Looks through Cauchy's loss first if there is anything to drop.
    bool drop_outliers(BundleState& state, bool look_through) {
        bool changed = mark_outliers(state);
        if (look_through && (changed || spread(state).plain > kHeavyTails * spread(state).robust)) {
            for (auto& view : bundle_.used) {
                std::fill(view.begin(), view.end(), true);
            }
            // 2.385 standard deviations: 95 % as efficient as least squares on normal noise.
            solve(bundle_, state, held(), std::max(2.385 * spread(state).robust, kSmallestOutlier_px / 3.0));
            changed = mark_outliers(state);
        }
        return changed;
    }

    // How far a view's points are from the model, used or not.
    struct Departures {
        std::vector<double> distances;
        std::vector<double> magnitudes;  // of coordinates, where the model images the point
        int outliers = 0;
    };

    [[nodiscard]] Departures departures(const BundleState& state, std::size_t view, double limit) const {
        Departures result;
        for (std::size_t i = 0; i < bundle_.used[view].size(); ++i) {
            const auto r = residual(bundle_, state, view, i);
            result.distances.push_back(r ? std::hypot(r->x, r->y) : std::numeric_limits<double>::infinity());
            result.outliers += result.distances.back() > limit ? 1 : 0;
            if (r) {
                result.magnitudes.insert(result.magnitudes.end(), {std::abs(r->x), std::abs(r->y)});
            }
        }
        return result;
    }

    // The standard deviation that a view's points have of their own where the view is off as a whole; else none. Where
    // part of it is (a board that is bent at one end) the median does not show it, but the outermost tenth does.
    static std::optional<double> spread_if_off(Departures& own, int others_outliers, std::size_t others_points,
                                               double usual) {
        const auto points = static_cast<double>(own.distances.size());
        if (own.magnitudes.empty() || others_points == 0 || own.outliers < kOutliersByView * points || usual <= 0.0) {
            return std::nullopt;
        }
        const double middle = kSigmaPerMedian * median(own.magnitudes);
        if (middle >= kSpreadByView * usual) {
            return middle;
        }
        // Laplace's rule: others without an outlier do not have none for certain.
        const boost::math::binomial chance(points,
                                           (others_outliers + 1.0) / (static_cast<double>(others_points) + 2.0));
        if (own.outliers > 0 && cdf(complement(chance, own.outliers - 1.0)) < kImprobable) {
            return std::max({middle, quantile(own.magnitudes, 0.9) / kSigmasOfTenth, usual});
        }
        return std::nullopt;
    }

    bool mark_outliers(const BundleState& state) {
        const double usual = spread(state).robust;
        const double limit = std::max(options_.outlier_sigmas * usual, kSmallestOutlier_px);
        std::vector<Departures> views;
        int outliers = 0;
        std::size_t points = 0;
        for (std::size_t v = 0; v < bundle_.views.size(); ++v) {
            views.push_back(departures(state, v, limit));
            outliers += views[v].outliers;
            points += views[v].distances.size();
        }
        bool changed = false;
        for (std::size_t v = 0; v < bundle_.views.size(); ++v) {
            const auto own =
                spread_if_off(views[v], outliers - views[v].outliers, points - views[v].distances.size(), usual);
            double& weight = bundle_.views[v].weight;
            const double now = own ? std::pow(usual / *own, 2) : 1.0;
            changed = changed || std::abs(now - weight) > 0.05 * weight;
            weight = now;
            for (std::size_t i = 0; i < bundle_.used[v].size(); ++i) {
                const bool use = views[v].distances[i] * std::sqrt(weight) <= limit;
                changed = changed || use != bundle_.used[v][i];
                bundle_.used[v][i] = use;
            }
        }
        return changed;
    }

    [[nodiscard]] InputError undetermined(const std::string& what) const {
        const bool is_far = std::ranges::all_of(bundle_.views, &ChartView::is_far);
        std::string help = is_far ? "add directions that are seen in the corners"
                                  : "add views of the chart tilted by 20° or more and reaching into the corners";
        if (!options_.known_focal_px) {
            help += ", or state the focal length (--focal-length)";
        }
        if (!options_.fix_centre) {
            help += ", or hold the centre at the picture's middle (--fix-centre)";
        }
        return InputError("fitting a camera model: " + std::to_string(bundle_.views.size()) +
                          (bundle_.views.size() == 1 ? " view does" : " views do") + " not determine " + what + ": " +
                          help);
    }

    void check_determined(const BundleState& state, const BundleInformation& unit, double sigma) const {
        const double judged = std::max(sigma, kLeastSigma_px);
        const auto error = [&](std::size_t i) {
            return judged * std::sqrt(unit.shared_covariance[i * (static_cast<std::size_t>(unit.shared) + 1)]);
        };
        const double focal = focal_length_px(state.model);
        if (!(error(0) < kUndetermined * std::abs(focal))) {
            throw undetermined(fmt::format("the focal length ({:.3g} ± {:.2g} px)", focal, error(0)));
        }
        const double centre_error = std::max(error(1), error(2));
        if (!(centre_error < kUndetermined * 0.5 * std::hypot(width_, height_))) {
            throw undetermined(fmt::format("the principal point (± {:.2g} px)", centre_error));
        }
        if (!(focal > 0.0)) {
            throw undetermined("the focal length");
        }
    }

    // Poses, residuals and what they come to.
    void add_views(const BundleState& state, GeometryFit& fit) const {
        const Vec2d centre = centre_px(state.model);
        double sum = 0.0;
        double weighted = 0.0;
        for (std::size_t v = 0; v < bundle_.views.size(); ++v) {
            FittedView view{.pose = to_pose(state.poses[v]),
                            .residuals = {},
                            .weight = bundle_.views[v].weight,
                            .pose_covariance = {},
                            .pose_follows = {}};
            for (std::size_t i = 0; i < bundle_.used[v].size(); ++i) {
                const auto r = residual(bundle_, state, v, i);
                if (!r) {
                    continue;
                }
                view.residuals.push_back({static_cast<int>(i), *r, bundle_.used[v][i]});
                if (bundle_.used[v][i]) {
                    const double square = r->x * r->x + r->y * r->y;
                    sum += square;
                    weighted += view.weight * square;
                    const Vec2d& pixel = bundle_.views[v].image_px[i];
                    fit.covered_radius_px =
                        std::max(fit.covered_radius_px, std::hypot(pixel.x - centre.x, pixel.y - centre.y));
                }
            }
            fit.views.push_back(std::move(view));
        }
        fit.points_used = count_used(bundle_);
        fit.rms_px = std::sqrt(sum / fit.points_used);
        fit.sigma_px = std::sqrt(weighted / (2 * fit.points_used - unknown_count()));
    }

    [[nodiscard]] GeometryFit result(const BundleState& state) const {
        GeometryFit fit;
        fit.model = state.model;
        add_views(state, fit);
        const auto unit = information(bundle_, state, held());
        if (!unit) {
            throw undetermined("at least one parameter");
        }
        check_determined(state, *unit, fit.sigma_px);
        add_covariance(state, *unit, fit);
        return fit;
    }

    void add_covariance(const BundleState& state, const BundleInformation& unit, GeometryFit& fit) const {
        const double variance = fit.sigma_px * fit.sigma_px;
        const auto all = static_cast<std::size_t>(unit.shared);
        const std::size_t own = all - kBoardTerms;
        fit.shared_covariance = unit.shared_covariance;
        for (double& value : fit.shared_covariance) {
            value *= variance;
        }
        fit.covariance.resize(own * own);
        for (std::size_t i = 0; i < own * own; ++i) {
            fit.covariance[i] = fit.shared_covariance[i / own * all + i % own];
        }
        for (std::size_t i = 0; i < own && !unit.view_covariance.empty(); ++i) {
            fit.view_standard_error.push_back(std::sqrt(std::max(unit.view_covariance[i * (all + 1)], 0.0)));
        }
        if (options_.fit_board_shape) {
            fit.board = BoardShape{.frame = bundle_.frame, .height_mm = state.heights, .covariance = {}};
            for (std::size_t i = 0; i < fit.board->covariance.size(); ++i) {
                fit.board->covariance[i] = fit.shared_covariance[(own + i / kBoardTerms) * all + own + i % kBoardTerms];
            }
        }
        for (std::size_t v = 0; v < fit.views.size(); ++v) {
            fit.views[v].pose_follows = unit.views[v].pose_follows;
            for (std::size_t i = 0; i < 36; ++i) {
                fit.views[v].pose_covariance[i] = variance * unit.views[v].pose_covariance[i];
            }
        }
    }

    PointBundle bundle_;
    const GeometryOptions& options_;
    int width_;
    int height_;
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
        const std::size_t features = view.chart_mm.size() + view.directions.size();
        if (features != view.image_px.size() || features < 4 || (view.is_far() && !view.chart_mm.empty())) {
            throw InputError(view.name + ": " + std::to_string(view.chart_mm.size()) + " chart points, " +
                             std::to_string(view.directions.size()) + " directions and " +
                             std::to_string(view.image_px.size()) +
                             " image points: expected as many as of one of the others, and at least 4");
        }
        for (std::size_t i = 0; i < features; ++i) {
            const Vec3d at = in_camera(view, i, {});
            if (!std::isfinite(at.x + at.y + at.z + view.image_px[i].x + view.image_px[i].y)) {
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
    return Fit(views, width_px, height_px, options).run();
}

GeometryFit refit_geometry(const std::vector<ChartView>& views, int width_px, int height_px,
                           const GeometryOptions& options, const BundleState& start) {
    check_input(views, width_px, height_px, options);
    return Fit(views, width_px, height_px, options).run_from(start);
}

BundleState state_of(const GeometryFit& fit) {
    BundleState state{.model = fit.model, .poses = {}, .heights = {}};
    for (const FittedView& view : fit.views) {
        state.poses.push_back(pose_parameters(view.pose));
    }
    if (fit.board) {
        state.heights = fit.board->height_mm;
    }
    return state;
}

}  // namespace lensproof::calibration
