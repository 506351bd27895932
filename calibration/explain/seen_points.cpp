#include "calibration/explain/seen_points.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calibration/statistics/dense_solvers.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {

namespace {

constexpr double kLeastNoise_px = 1e-3;  // below which no picture is measured
constexpr int kShiftTermCount = 7;

double pitch_mm(const NamedProfile& named) {
    if (!named.profile.pixel_pitch_um) {
        throw InputError(fmt::format(
            "{} has no pixel_pitch_um, which a lens needs to be fitted to it: measure with --pixel-pitch", named.file));
    }
    return *named.profile.pixel_pitch_um * 1e-3;
}

/// The points that the profile's own fit used.
SeenView seen_view(const ProfileView& from, const ProfileGeometry& geometry, int profile) {
    SeenView view{.image = from.image, .profile = profile, .pose = pose_parameters(*from.pose), .points = {}};
    for (const ProfilePoint& point : from.points) {
        const auto ideal = predict(geometry.model, *from.pose, point.chart_mm, 0.0, geometry.board);
        if (point.used && ideal) {
            const double height = geometry.board ? board_height(geometry.board->frame, geometry.board->height_mm.data(),
                                                                point.chart_mm.x, point.chart_mm.y)
                                                 : 0.0;
            view.points.push_back({{point.chart_mm.x, point.chart_mm.y, height}, *ideal + point.residual_px});
        }
    }
    return view;
}

/// Of one coordinate, from the residuals of the points used.
double noise_px(const Profile& profile) {
    double squares = 0.0;
    int count = 0;
    int views = 0;
    for (const ProfileView& view : profile.views) {
        const int before = count;
        for (const ProfilePoint& point : view.points) {
            squares += point.used ? dot(point.residual_px, point.residual_px) : 0.0;
            count += point.used ? 2 : 0;
        }
        views += count > before ? 1 : 0;
    }
    const int unknowns = 6 * views + static_cast<int>(parameters(profile.geometry->model).size());
    return std::max(kLeastNoise_px, std::sqrt(squares / std::max(1, count - unknowns)));
}

/// Every so many of them, evenly, so that at most `most` are left.
template <class T>
void thin_out(std::vector<T>& of, std::size_t most) {
    const std::size_t count = of.size();
    if (count > most) {
        for (std::size_t i = 0; i < most; ++i) {
            of[i] = of[i * count / most];
        }
        of.resize(most);
    }
}

/// The terms' parts of a shift at `q` (calibration/chromatic/chromatic_shift.h), along x and y.
Eigen::Matrix<double, 2, kShiftTermCount> shift_design(const Vec2d& q) {
    const double rho2 = dot(q, q);
    Eigen::Matrix<double, 2, kShiftTermCount> design;
    design << q.x, q.x * rho2, q.x * rho2 * rho2, -q.y, -q.y * rho2, 1.0, 0.0,  //
        q.y, q.y * rho2, q.y * rho2 * rho2, q.x, q.x * rho2, 0.0, 1.0;
    return design;
}

void add_shift(const Profile& profile, int index, int channel, double distance_mm, std::vector<SeenShift>& shifts) {
    const auto found = profile.terms.find(kShiftTerms(channel == 0 ? "R" : "B"));
    if (found == profile.terms.end() || found->second.values.size() != kShiftTermCount ||
        found->second.covariance.size() != std::size_t{kShiftTermCount} * kShiftTermCount) {
        return;
    }
    SeenShift shift{.profile = index, .channel = channel};
    const Vec2d centre = centre_px(profile.geometry->model);
    const double unit = half_diagonal_px(profile);
    const double reach = std::min(1.0, profile.geometry->covered_image_height);
    std::vector<Eigen::Matrix<double, 2, kShiftTermCount>> designs;
    constexpr int kAcross = 7;
    for (int i = 0; i < kAcross * kAcross; ++i) {
        const int row = i / kAcross;
        const Vec2d pixel{1.0 * (profile.width_px - 1) * (i % kAcross) / (kAcross - 1),
                          1.0 * (profile.height_px - 1) * row / (kAcross - 1)};
        const Vec2d q = (1.0 / unit) * (pixel - centre);
        const auto ray = length(q) <= reach ? unproject(profile.geometry->model, pixel) : std::nullopt;
        if (ray) {
            shift.objects.push_back(distance_mm * *ray);
            designs.push_back(shift_design(q));
        }
    }
    Eigen::MatrixXd design(2 * designs.size(), kShiftTermCount);
    for (std::size_t i = 0; i < designs.size(); ++i) {
        design.middleRows<2>(2 * static_cast<Eigen::Index>(i)) = designs[i];
    }
    shift.terms_of_shifts = least_norm_solution(design, Eigen::MatrixXd::Identity(design.rows(), design.rows()));
    shift.terms = Eigen::Map<const Eigen::VectorXd>(found->second.values.data(), kShiftTermCount);
    const Eigen::Map<const Eigen::Matrix<double, kShiftTermCount, kShiftTermCount>> stated(
        found->second.covariance.data());
    // What seven terms leave of a shift goes into them by where the points were, which the profile does not say.
    constexpr double kUnknownPlaces_px = 0.02;
    const Eigen::MatrixXd covariance =
        stated + kUnknownPlaces_px * kUnknownPlaces_px * Eigen::MatrixXd::Identity(kShiftTermCount, kShiftTermCount);
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    if (factor.info() == Eigen::Success && shift.objects.size() > kShiftTermCount) {
        shift.whitening = Eigen::MatrixXd(factor.matrixL())
                              .triangularView<Eigen::Lower>()
                              .solve(Eigen::MatrixXd::Identity(kShiftTermCount, kShiftTermCount));
        shifts.push_back(std::move(shift));
    }
}

void require_same_camera(const NamedProfile& first, const NamedProfile& other) {
    if (other.profile.width_px != first.profile.width_px || other.profile.height_px != first.profile.height_px ||
        other.profile.pixel_pitch_um != first.profile.pixel_pitch_um) {
        throw InputError(fmt::format(
            "{} is of another camera than {}: {} × {} pixels of {} µm, expected {} × {} of {} µm", other.file,
            first.file, other.profile.width_px, other.profile.height_px, *other.profile.pixel_pitch_um,
            first.profile.width_px, first.profile.height_px, *first.profile.pixel_pitch_um));
    }
}

double mean_distance(const std::vector<SeenView>& views) {
    double sum = 0.0;
    double count = 0.0;
    for (const SeenView& view : views) {
        for (const SeenPoint& point : view.points) {
            sum += to_camera(to_pose(view.pose), {point.board_mm.x, point.board_mm.y}).z;
            count += 1.0;
        }
    }
    return sum / count;
}

}  // namespace

int SeenPoints::count() const {
    int sum = 0;
    for (const SeenView& view : views) {
        sum += static_cast<int>(view.points.size());
    }
    return sum;
}

SeenPoints seen_points(const std::vector<NamedProfile>& profiles) {
    if (profiles.size() > kMostViews) {
        throw InputError(
            fmt::format("{} profiles, expected {} at most: no more views are used", profiles.size(), kMostViews));
    }
    const NamedProfile& first = profiles.front();
    SeenPoints seen;
    seen.camera = {.width_px = first.profile.width_px,
                   .height_px = first.profile.height_px,
                   .pitch_mm = pitch_mm(first),
                   .noise_px = {},
                   .chart_mm = {}};
    for (std::size_t p = 0; p < profiles.size(); ++p) {
        const NamedProfile& named = profiles[p];
        const int index = static_cast<int>(p);
        pitch_mm(named);
        require_same_camera(first, named);
        std::vector<SeenView> views;
        for (const ProfileView& view : named.profile.views) {
            if (named.profile.geometry && has_posed_chart(view)) {
                views.push_back(seen_view(view, *named.profile.geometry, index));
            }
        }
        constexpr std::size_t kLeastPoints = 6;  // a pose has six unknowns
        std::erase_if(views, [](const SeenView& view) { return view.points.size() < kLeastPoints; });
        if (views.empty()) {
            throw InputError(
                fmt::format("{}: no views with points that its camera model explains, expected what measure "
                            "makes of a chart's pictures",
                            named.file));
        }
        thin_out(views, kMostViews / profiles.size());
        for (SeenView& view : views) {
            thin_out(view.points, kMostPoints / (views.size() * profiles.size()));
        }
        seen.camera.noise_px.push_back(noise_px(named.profile));
        seen.camera.chart_mm.push_back(mean_distance(views));
        for (const int channel : {0, 2}) {
            add_shift(named.profile, index, channel, seen.camera.chart_mm.back(), seen.shifts);
        }
        std::ranges::move(views, std::back_inserter(seen.views));
    }
    return seen;
}

}  // namespace lensproof::calibration
