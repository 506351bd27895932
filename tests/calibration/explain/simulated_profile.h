// tests/calibration/explain/simulated_profile.h — what `measure` would say of a lens whose faults are known.
#pragma once
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "calibration/chromatic/chromatic_shift.h"
#include "calibration/explain/changed_lens.h"
#include "calibration/explain/explanation.h"
#include "calibration/geometry/fit_geometry.h"
#include "engine/formats/prescription/load_lens.h"
#include "tests/calibration/synthetic.h"

namespace lensproof::calibration::explain_test {

/// A camera of 36 × 24 mm in front of a chart, in which points are found to 0.05 px, as on good photographs.
struct Studio {
    std::string lens = "tessar";
    double distance_mm = 2000.0;
    double frame_mm = 720.0;  // what it sees there, across
    double noise_px = 0.05;
    int columns = 9;
    int rows = 6;
    std::vector<std::string> free{kFreeKinds.begin(), kFreeKinds.end()};
};

inline constexpr int kWidth_px = 6000;
inline constexpr int kHeight_px = 4000;
inline constexpr double kPitch_mm = 0.006;

/// The changes that differ from 0, by name.
using Faults = std::vector<std::pair<std::string, double>>;

inline std::vector<Pose> studio_poses(const Studio& studio) {
    std::vector<Pose> poses;
    for (const auto& [x, y, z, farther] : std::vector<std::array<double, 4>>{{0.02, -0.03, 0.0, 1.0},
                                                                             {0.45, 0.0, 0.05, 1.1},
                                                                             {-0.45, 0.05, 0.0, 1.1},
                                                                             {0.0, 0.45, -0.05, 1.1},
                                                                             {0.03, -0.45, 0.0, 1.1},
                                                                             {0.3, 0.3, 1.57, 1.3},
                                                                             {-0.3, 0.3, -1.57, 1.3},
                                                                             {0.0, 0.03, 3.1, 1.05}}) {
        poses.push_back({{x, y, z}, {0.0, 0.0, farther * studio.distance_mm}});
    }
    return poses;
}

/// The studio's points, imaged nowhere as yet.
inline SeenPoints studio_points(const Studio& studio) {
    SeenPoints seen;
    seen.camera = {.width_px = kWidth_px,
                   .height_px = kHeight_px,
                   .pitch_mm = kPitch_mm,
                   .noise_px = {studio.noise_px},
                   .chart_mm = {1.08 * studio.distance_mm}};
    for (const Pose& pose : studio_poses(studio)) {
        SeenView view{.image = "simulated", .profile = 0, .pose = pose_parameters(pose), .points = {}};
        for (int i = 0; i < studio.columns * studio.rows; ++i) {
            const int row = i / studio.columns;
            const double across = studio.frame_mm * ((i % studio.columns + 0.5) / studio.columns - 0.5);
            const double down = studio.frame_mm / 1.5 * ((row + 0.5) / studio.rows - 0.5);
            view.points.push_back({{across, down, 0.0}, {}});
        }
        seen.views.push_back(std::move(view));
    }
    return seen;
}

/// Images the points by the lens with these values of its changes, with noise. Points beyond the frame stay.
inline void image_points(const ExplainedLens& lens, const Eigen::VectorXd& values, unsigned seed, SeenPoints& seen) {
    for (SeenView& view : seen.views) {
        for (SeenPoint& point : view.points) {
            point.image_px = {};
        }
    }
    LensState state = start_of(lens, seen);
    state.changes = values;
    const Eigen::VectorXd residuals = ResidualTracer(lens, seen).residuals(state, false)->values;
    const double sigma = seen.camera.noise_px.front();
    synthetic::Noise noise(seed);
    Eigen::Index row = 0;
    for (SeenView& view : seen.views) {
        for (SeenPoint& point : view.points) {
            point.image_px.x = sigma * (noise() - residuals[row]);
            point.image_px.y = sigma * (noise() - residuals[row + 1]);
            row += 2;
        }
    }
}

inline Eigen::VectorXd values_of(const std::vector<LensChange>& changes, const Faults& faults) {
    Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(changes.size()));
    for (const auto& [name, value] : faults) {
        const auto change = std::ranges::find(changes, name, &LensChange::name);
        if (change == changes.end()) {
            throw std::invalid_argument(name + ": no such change");
        }
        values[change - changes.begin()] = value;
    }
    return values;
}

/// Red's and blue's shift against green, as it is measured of as many points.
inline void add_shifts(const ExplainedLens& lens, const Eigen::VectorXd& values, const Studio& studio, unsigned seed,
                       Profile& profile) {
    synthetic::Noise noise(seed + 1000);
    const CameraModel& model = profile.geometry->model;
    const double distance_mm = seen_points({{"", profile}}).camera.chart_mm.front();
    for (const std::size_t channel : {0, 2}) {
        std::vector<ChromaticPair> pairs;
        for (int i = 0; i < 12 * 12; ++i) {
            const int row = i / 12;
            const Vec2d pixel{(kWidth_px - 1) * (0.02 + 0.96 * (i % 12) / 11.0),
                              (kHeight_px - 1) * (0.02 + 0.96 * row / 11.0)};
            const Vec3d camera = distance_mm * *unproject(model, pixel);
            const Vec3d object{camera.x, -camera.y, lens.entrance_pupil_z - camera.z};
            std::array<Vec2d, 2> image{};
            for (const auto& [c, at] : {std::pair{std::size_t{1}, 0}, {channel, 1}}) {
                for (const double nm : lens.wavelengths_nm[c]) {
                    const Vec2d mm = ChangedLens(lens.focused.front(), nm, lens.changes, values, 0)
                                         .image_of(object, std::nullopt, false)
                                         ->image_mm;
                    image[static_cast<std::size_t>(at)].x -= 0.5 * mm.x / kPitch_mm;
                    image[static_cast<std::size_t>(at)].y += 0.5 * mm.y / kPitch_mm;
                }
            }
            const Vec2d shift = image[1] - image[0];
            const double sigma = studio.noise_px;
            pairs.push_back({pixel, {pixel.x + shift.x + sigma * noise(), pixel.y + shift.y + sigma * noise()}});
        }
        const ChromaticShift fitted = fit_chromatic_shift(pairs, centre_px(model), half_diagonal_px(profile));
        const auto& [c1, c3, c5] = fitted.radial_px;
        const auto& [s1, s3] = fitted.tangential_px;
        profile.terms[kShiftTerms(channel == 0 ? "R" : "B")] = {
            .names = {"c1_px", "c3_px", "c5_px", "s1_px", "s3_px", "translation_x_px", "translation_y_px"},
            .values = {c1, c3, c5, s1, s3, fitted.translation_px.x, fitted.translation_px.y},
            .covariance = {fitted.covariance.begin(), fitted.covariance.end()}};
    }
}

/// A profile with the model that `model` says, fitted to noisy images of the charts by `lens` with its faults.
inline Profile simulated_profile(const Studio& studio, const Faults& faults, unsigned seed,
                                 ModelKind model = ModelKind::brown_conrady) {
    SeenPoints seen = studio_points(studio);
    const ExplainedLens lens = explained_lens(formats::load_lens(studio.lens), seen,
                                              {kFreeKinds.begin(), kFreeKinds.end()}, studio.distance_mm);
    const Eigen::VectorXd values = values_of(lens.changes, faults);
    image_points(lens, values, seed, seen);
    std::vector<ChartView> views;
    for (const SeenView& from : seen.views) {
        ChartView view{.name = from.image, .chart_mm = {}, .image_px = {}};
        for (const SeenPoint& point : from.points) {
            const Vec2d& at = point.image_px;
            if (at.x > 0.0 && at.y > 0.0 && at.x < kWidth_px - 1 && at.y < kHeight_px - 1) {
                view.chart_mm.push_back({point.board_mm.x, point.board_mm.y});
                view.image_px.push_back(at);
            }
        }
        views.push_back(std::move(view));
    }
    const GeometryFit fit =
        fit_geometry(views, kWidth_px, kHeight_px, {.model = model, .radial_terms = {}, .known_focal_px = {}});
    Profile profile;
    profile.name = studio.lens;
    profile.source = {.kind = "render", .images = {}, .camera = "simulated", .lens = studio.lens};
    profile.width_px = kWidth_px;
    profile.height_px = kHeight_px;
    profile.channels = {"G"};
    profile.pixel_pitch_um = 1e3 * kPitch_mm;
    profile.geometry = ProfileGeometry{.model = fit.model, .covariance = fit.covariance};
    profile.geometry->reprojection_rms_px = fit.rms_px;
    profile.geometry->views_used = static_cast<int>(views.size());
    profile.geometry->points_used = fit.points_used;
    profile.geometry->covered_image_height = fit.covered_radius_px / half_diagonal_px(profile);
    for (std::size_t v = 0; v < views.size(); ++v) {
        ProfileView view{.image = "view" + std::to_string(v),
                         .found = true,
                         .reason = {},
                         .traits = {},
                         .pose = fit.views[v].pose,
                         .points = {}};
        for (const PointResidual& residual : fit.views[v].residuals) {
            const auto i = static_cast<std::size_t>(residual.index);
            view.points.push_back(
                {views[v].chart_mm[i], views[v].image_px[i], residual.measured_minus_model_px, residual.used});
        }
        profile.views.push_back(std::move(view));
    }
    add_shifts(lens, values, studio, seed, profile);
    return profile;
}

}  // namespace lensproof::calibration::explain_test
