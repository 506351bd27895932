#include "calibration/explain/lens_residuals.h"

#include <ceres/jet.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <cmath>

#include "calibration/explain/changed_lens.h"
#include "calibration/photographed/imaged_field.h"
#include "engine/optics/focus.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::calibration {

namespace {

constexpr std::size_t kGreen = 1;

/// Two wavelengths that have the mean and the variance of a channel's light: what is quadratic in the wavelength has
/// its mean at them (Gauss's rule of two points, of a symmetric weight).
std::array<std::array<double, 2>, 3> channel_wavelengths(const optics::Lens& lens) {
    const std::vector<SeenWavelength> light = camera_wavelengths(lens);
    std::array<std::array<double, 2>, 3> pairs{};
    for (std::size_t c = 0; c < 3; ++c) {
        double weight = 0.0;
        double mean = 0.0;
        double square = 0.0;
        for (const SeenWavelength& of : light) {
            weight += of.weight[c];
            mean += of.weight[c] * of.wavelength_nm;
            square += of.weight[c] * of.wavelength_nm * of.wavelength_nm;
        }
        mean /= weight;
        const double spread = std::sqrt(std::max(0.0, square / weight - mean * mean));
        pairs[c] = {mean - spread, mean + spread};
    }
    return pairs;
}

/// A point of a posed chart in lens space, and its derivatives by the pose.
struct PosedPoint {
    Vec3d place;
    Eigen::Matrix<double, 3, kPoseUnknowns> by_pose;
};

/// The camera's x to the right, y down, z into the scene; lens space: y up, z to the sensor.
Vec3d in_lens_space(const Vec3d& camera, double origin_z) {
    return {camera.x, -camera.y, origin_z - camera.z};
}

PosedPoint posed(const PoseParameters& pose, const Vec3d& board, double origin_z) {
    using Number = ceres::Jet<double, kPoseUnknowns>;
    std::array<Number, kPoseUnknowns> p;
    for (int i = 0; i < kPoseUnknowns; ++i) {
        p[static_cast<std::size_t>(i)] = Number(pose[static_cast<std::size_t>(i)], i);
    }
    const std::array<Number, 3> on_board{Number(board.x), Number(board.y), Number(board.z)};
    std::array<Number, 3> camera;
    ceres::AngleAxisRotatePoint(p.data(), on_board.data(), camera.data());
    PosedPoint point;
    for (std::size_t i = 0; i < 3; ++i) {
        camera[i] += p[3 + i];
        point.by_pose.row(static_cast<Eigen::Index>(i)) = (i == 0 ? 1.0 : -1.0) * camera[i].v.transpose();
    }
    point.place = in_lens_space({camera[0].a, camera[1].a, camera[2].a}, origin_z);
    return point;
}

}  // namespace

ExplainedLens explained_lens(const optics::Lens& lens, const SeenPoints& seen, const std::vector<std::string>& free,
                             const std::optional<double>& focus_mm) {
    const int profiles = static_cast<int>(seen.camera.chart_mm.size());
    ExplainedLens explained{
        .focused = {}, .changes = lens_changes(lens, free, profiles), .wavelengths_nm = channel_wavelengths(lens)};
    const auto at_d = optics::at_wavelength<double>(lens, spectral::kLineD);
    explained.entrance_pupil_z = optics::paraxial_data(at_d).entrance_pupil_z;
    for (const double distance : seen.camera.chart_mm) {
        explained.focused.push_back(optics::focused_at(lens, focus_mm.value_or(distance - explained.entrance_pupil_z)));
    }
    return explained;
}

LensState start_of(const ExplainedLens& lens, const SeenPoints& seen) {
    LensState state{.changes = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(lens.changes.size())), .poses = {}};
    for (const SeenView& view : seen.views) {
        state.poses.push_back(view.pose);
    }
    return state;
}

/// A channel's image of a point, px.
struct ResidualTracer::Image {
    Vec2d px;
    Eigen::MatrixXd by_change;
    Eigen::Matrix<double, 2, 3> by_point = Eigen::Matrix<double, 2, 3>::Zero();
};

/// The changed lens of each profile at each wavelength.
class ResidualTracer::Rays {
  public:
    Rays(const ExplainedLens& lens, const SeenCamera& camera, const Eigen::VectorXd& changes, bool with_colours)
        : camera_(camera) {
        for (std::size_t p = 0; p < lens.focused.size(); ++p) {
            for (std::size_t c = 0; c < 3; ++c) {
                for (const double nm : lens.wavelengths_nm[c]) {
                    const bool is_needed = with_colours || c == kGreen;
                    rays_.push_back(is_needed ? std::make_unique<ChangedLens>(lens.focused[p], nm, lens.changes,
                                                                              changes, static_cast<int>(p))
                                              : nullptr);
                }
            }
        }
    }

    [[nodiscard]] std::optional<Image> image(int profile, std::size_t channel, const Vec3d& object,
                                             std::array<std::optional<Vec2d>, 2>& slopes, bool with_derivatives) const {
        Image mean;
        for (std::size_t k = 0; k < 2; ++k) {
            const auto& rays = rays_[static_cast<std::size_t>(profile) * 6 + 2 * channel + k];
            const auto landed = rays->image_of(object, slopes[k], with_derivatives);
            if (!landed) {
                return std::nullopt;
            }
            slopes[k] = landed->stop_slopes;
            // What lies right is imaged left; what lies up is imaged down, and rows run down.
            const Eigen::Vector2d to_px = Eigen::Vector2d(-0.5, 0.5) / camera_.pitch_mm;
            mean.px = mean.px + Vec2d{to_px.x() * landed->image_mm.x, to_px.y() * landed->image_mm.y};
            if (with_derivatives) {
                const Eigen::MatrixXd by_change = to_px.asDiagonal() * landed->by_change;
                mean.by_change = k == 0 ? by_change : mean.by_change + by_change;
                mean.by_point += to_px.asDiagonal() * landed->by_point;
            }
        }
        mean.px = mean.px + Vec2d{0.5 * (camera_.width_px - 1), 0.5 * (camera_.height_px - 1)};
        return mean;
    }

  private:
    const SeenCamera& camera_;
    std::vector<std::unique_ptr<ChangedLens>> rays_;
};

std::optional<LensResiduals> ResidualTracer::residuals(const LensState& state, bool with_derivatives) {
    const Rays rays(lens_, seen_.camera, state.changes, !seen_.shifts.empty());
    Eigen::Index rows = 2 * static_cast<Eigen::Index>(seen_.count());
    for (const SeenShift& shift : seen_.shifts) {
        rows += shift.terms.size();
    }
    const Eigen::Index columns = state.changes.size();
    LensResiduals result{.values = Eigen::VectorXd(rows), .by_change = {}, .by_pose = {}};
    if (with_derivatives) {
        result.by_change.resize(rows, columns);
        result.by_pose.setZero(rows, kPoseUnknowns * static_cast<Eigen::Index>(seen_.views.size()));
    }
    slopes_.resize(static_cast<std::size_t>(seen_.count()));
    if (!add_points(rays, state, with_derivatives, result) || !add_shifts(rays, with_derivatives, result)) {
        return std::nullopt;
    }
    return result;
}

bool ResidualTracer::add_points(const Rays& rays, const LensState& state, bool with_derivatives,
                                LensResiduals& result) {
    Eigen::Index row = 0;
    for (std::size_t v = 0; v < seen_.views.size(); ++v) {
        const SeenView& view = seen_.views[v];
        const double sigma = seen_.camera.noise_px[static_cast<std::size_t>(view.profile)];
        for (const SeenPoint& point : view.points) {
            const PosedPoint object = posed(state.poses[v], point.board_mm, lens_.entrance_pupil_z);
            const auto image = rays.image(view.profile, kGreen, object.place,
                                          slopes_[static_cast<std::size_t>(row / 2)], with_derivatives);
            if (!image) {
                return false;
            }
            result.values.segment<2>(row) << (point.image_px.x - image->px.x) / sigma,
                (point.image_px.y - image->px.y) / sigma;
            if (with_derivatives) {
                result.by_change.middleRows<2>(row) = -image->by_change / sigma;
                result.by_pose.block<2, kPoseUnknowns>(row, kPoseUnknowns * static_cast<Eigen::Index>(v)) =
                    -image->by_point * object.by_pose / sigma;
            }
            row += 2;
        }
    }
    return true;
}

bool ResidualTracer::add_shifts(const Rays& rays, bool with_derivatives, LensResiduals& result) const {
    Eigen::Index row = 2 * static_cast<Eigen::Index>(seen_.count());
    for (const SeenShift& shift : seen_.shifts) {
        const Eigen::Index n = static_cast<Eigen::Index>(shift.objects.size());
        Eigen::VectorXd shifts(2 * n);
        Eigen::MatrixXd by_change(2 * n, result.by_change.cols());
        for (Eigen::Index i = 0; i < n; ++i) {
            const Vec3d object = in_lens_space(shift.objects[static_cast<std::size_t>(i)], lens_.entrance_pupil_z);
            std::array<std::optional<Vec2d>, 2> start;
            const auto green = rays.image(shift.profile, kGreen, object, start, with_derivatives);
            const auto other =
                rays.image(shift.profile, static_cast<std::size_t>(shift.channel), object, start, with_derivatives);
            if (!green || !other) {
                return false;
            }
            shifts.segment<2>(2 * i) << other->px.x - green->px.x, other->px.y - green->px.y;
            if (with_derivatives) {
                by_change.middleRows<2>(2 * i) = other->by_change - green->by_change;
            }
        }
        const Eigen::Index terms = shift.terms.size();
        result.values.segment(row, terms) = shift.whitening * (shift.terms - shift.terms_of_shifts * shifts);
        if (with_derivatives) {
            result.by_change.middleRows(row, terms) = -shift.whitening * (shift.terms_of_shifts * by_change);
        }
        row += terms;
    }
    return true;
}

std::vector<std::vector<bool>> ResidualTracer::imaged(const LensState& state) {
    const Rays rays(lens_, seen_.camera, state.changes, false);
    std::vector<std::vector<bool>> imaged;
    for (std::size_t v = 0; v < seen_.views.size(); ++v) {
        imaged.emplace_back();
        for (const SeenPoint& point : seen_.views[v].points) {
            std::array<std::optional<Vec2d>, 2> start;
            const Vec3d object = posed(state.poses[v], point.board_mm, lens_.entrance_pupil_z).place;
            imaged.back().push_back(rays.image(seen_.views[v].profile, kGreen, object, start, false).has_value());
        }
    }
    return imaged;
}

int keep_imaged(const ExplainedLens& lens, SeenPoints& seen) {
    const auto imaged = ResidualTracer(lens, seen).imaged(start_of(lens, seen));
    int dropped = 0;
    for (std::size_t v = 0; v < seen.views.size(); ++v) {
        std::vector<SeenPoint>& points = seen.views[v].points;
        std::vector<SeenPoint> kept;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (imaged[v][i]) {
                kept.push_back(points[i]);
            }
        }
        dropped += static_cast<int>(points.size() - kept.size());
        points = std::move(kept);
    }
    constexpr std::size_t kLeastPoints = 6;
    std::erase_if(seen.views, [](const SeenView& view) { return view.points.size() < kLeastPoints; });
    return dropped;
}

}  // namespace lensproof::calibration
