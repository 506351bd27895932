#include "calibration/geometry/reprojection.h"

#include <ceres/cost_function.h>
#include <ceres/jet.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <utility>

#include "calibration/detection/disc_centroid.h"

namespace lensproof::calibration {
namespace {

template <class T>
using Project = bool (*)(const T*, const Vec3<T>&, Vec2<T>&);

template <class T, std::size_t... kind>
constexpr std::array<Project<T>, sizeof...(kind)> projections(std::index_sequence<kind...> /*kinds*/) {
    return {&std::variant_alternative_t<kind, CameraModel>::template project<T>...};
}

// Every model's projection, in the order of ModelKind.
template <class T>
constexpr auto kProjections = projections<T>(std::make_index_sequence<std::variant_size_v<CameraModel>>());

template <std::size_t... kind>
constexpr std::array<int, sizeof...(kind)> counts(std::index_sequence<kind...> /*kinds*/) {
    return {std::variant_alternative_t<kind, CameraModel>::count...};
}

// How many parameters every model has.
constexpr auto kCounts = counts(std::make_index_sequence<std::variant_size_v<CameraModel>>());

constexpr int kLargestModel = Spline::count;
constexpr int kSmallModel = BrownConrady::count;  // most are no larger

class ReprojectionCost final : public ceres::CostFunction {
  public:
    ReprojectionCost(ModelKind kind, int parameters, const Feature& feature, const BoardFrame& frame)
        : kind_(kind), feature_(feature), frame_(frame) {
        set_num_residuals(2);
        *mutable_parameter_block_sizes() = {parameters, 6, kBoardTerms};
    }

    bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override {
        const std::array<double*, 3> wanted = jacobians != nullptr
                                                  ? std::array<double*, 3>{jacobians[0], jacobians[1], jacobians[2]}
                                                  : std::array<double*, 3>{};
        int derivatives = 0;
        for (std::size_t b = 0; b < wanted.size(); ++b) {
            derivatives += wanted[b] != nullptr ? parameter_block_sizes()[b] : 0;
        }
        if (derivatives == 0) {
            return evaluate_plain(blocks, residuals);
        }
        // The fewer derivatives are carried, the faster: a pose alone, a small model, the largest.
        if (feature_.disc_diameter_mm > 0.0) {
            return derivatives <= 6 ? evaluate<6>(blocks, residuals, wanted)
                                    : evaluate<kLargestModel + 6 + kBoardTerms>(blocks, residuals, wanted);
        }
        if (wanted[0] == nullptr) {
            return evaluate_point<3>(blocks, residuals, wanted);
        }
        return parameter_block_sizes()[0] <= kSmallModel ? evaluate_point<3 + kSmallModel>(blocks, residuals, wanted)
                                                         : evaluate_point<3 + kLargestModel>(blocks, residuals, wanted);
    }

  private:
    template <class T>
    Vec3<T> in_camera(const T* pose, const Vec3<T>& point) const {
        const T from[3] = {point.x, point.y, point.z};
        T turned[3];
        ceres::AngleAxisRotatePoint(pose, from, turned);
        if (feature_.direction) {
            return {turned[0], turned[1], turned[2]};
        }
        return {turned[0] + pose[3], turned[1] + pose[4], turned[2] + pose[5]};
    }

    template <class T>
    bool predict(const T* intrinsics, const T* pose, const T* heights, Vec2<T>& predicted) const {
        const auto image_of = [&](const Vec3<T>& point, Vec2<T>& pixel) {
            return kProjections<T>[static_cast<std::size_t>(kind_)](intrinsics, in_camera(pose, point), pixel);
        };
        if (const auto& far = feature_.direction) {
            return image_of({T(far->x), T(far->y), T(far->z)}, predicted);
        }
        const auto map = [&](double x, double y, Vec2<T>& pixel) {
            return image_of({T(x), T(y), board_height(frame_, heights, x, y)}, pixel);
        };
        const Vec2d& at = feature_.chart_mm;
        return feature_.disc_diameter_mm > 0.0 ? disc_centroid(map, at.x, at.y, feature_.disc_diameter_mm, predicted)
                                               : map(at.x, at.y, predicted);
    }

    bool evaluate_plain(const double* const* blocks, double* residuals) const {
        Vec2d predicted;
        if (!predict(blocks[0], blocks[1], blocks[2], predicted)) {
            return false;
        }
        residuals[0] = feature_.image_px.x - predicted.x;
        residuals[1] = feature_.image_px.y - predicted.y;
        return true;
    }

    // By the chain rule: a point of the chart moves in the camera's frame with the pose and its height, and its image
    // with that point and the model. (Derivatives by all parameters at once are up to four times as long.)
    template <int stride>
    bool evaluate_point(const double* const* blocks, double* residuals, const std::array<double*, 3>& jacobians) const {
        using PointJet = ceres::Jet<double, 7>;  // by the pose, and by the height
        const Vec2d& at = feature_.chart_mm;
        std::array<PointJet, 6> pose;
        for (int i = 0; i < 6; ++i) {
            pose[i] = PointJet(blocks[1][i], i);
        }
        const auto& far = feature_.direction;
        const Vec3<PointJet> point = far ? Vec3<PointJet>{PointJet(far->x), PointJet(far->y), PointJet(far->z)}
                                         : Vec3<PointJet>{PointJet(at.x), PointJet(at.y),
                                                          PointJet(board_height(frame_, blocks[2], at.x, at.y), 6)};
        const Vec3<PointJet> put = in_camera(pose.data(), point);
        using Jet = ceres::Jet<double, stride>;  // by the point, and by the model
        const int count = parameter_block_sizes()[0];
        std::array<Jet, kLargestModel> intrinsics;
        for (int i = 0; i < count; ++i) {
            intrinsics[i] = jacobians[0] != nullptr && i < stride - 3 ? Jet(blocks[0][i], 3 + i) : Jet(blocks[0][i]);
        }
        Vec2<Jet> image;
        if (!kProjections<Jet>[static_cast<std::size_t>(kind_)](
                intrinsics.data(), Vec3<Jet>{Jet(put.x.a, 0), Jet(put.y.a, 1), Jet(put.z.a, 2)}, image)) {
            return false;
        }
        residuals[0] = feature_.image_px.x - image.x.a;
        residuals[1] = feature_.image_px.y - image.y.a;
        for (int row = 0; row < 2; ++row) {
            const Jet& own = row == 0 ? image.x : image.y;
            const auto chained = [&](int i) {
                return own.v[0] * put.x.v[i] + own.v[1] * put.y.v[i] + own.v[2] * put.z.v[i];
            };
            for (int i = 0; jacobians[0] != nullptr && i < std::min(count, stride - 3); ++i) {
                jacobians[0][row * count + i] = -own.v[3 + i];
            }
            for (int i = 0; jacobians[1] != nullptr && i < 6; ++i) {
                jacobians[1][row * 6 + i] = -chained(i);
            }
            for (int i = 0; jacobians[2] != nullptr && i < kBoardTerms; ++i) {
                BoardHeights unit{};
                unit[i] = 1.0;
                jacobians[2][row * kBoardTerms + i] = -chained(6) * board_height(frame_, unit.data(), at.x, at.y);
            }
        }
        return true;
    }

    template <int stride>
    bool evaluate(const double* const* blocks, double* residuals, const std::array<double*, 3>& jacobians) const {
        using Jet = ceres::Jet<double, stride>;
        std::array<Jet, kLargestModel> intrinsics;
        std::array<Jet, 6> pose;
        std::array<Jet, kBoardTerms> heights;
        const std::array<Jet*, 3> jets{intrinsics.data(), pose.data(), heights.data()};
        int next = 0;
        for (std::size_t b = 0; b < jets.size(); ++b) {
            for (int i = 0; i < parameter_block_sizes()[b]; ++i) {
                jets[b][i] = jacobians[b] != nullptr ? Jet(blocks[b][i], next++) : Jet(blocks[b][i]);
            }
        }
        Vec2<Jet> predicted;
        if (!predict(jets[0], jets[1], jets[2], predicted)) {
            return false;
        }
        residuals[0] = feature_.image_px.x - predicted.x.a;
        residuals[1] = feature_.image_px.y - predicted.y.a;
        next = 0;
        for (std::size_t b = 0; b < jets.size(); ++b) {
            if (jacobians[b] == nullptr) {
                continue;
            }
            const int size = parameter_block_sizes()[b];
            for (int i = 0; i < size; ++i, ++next) {
                jacobians[b][i] = -predicted.x.v[next];
                jacobians[b][size + i] = -predicted.y.v[next];
            }
        }
        return true;
    }

    ModelKind kind_;
    Feature feature_;
    BoardFrame frame_;
};

}  // namespace

PoseParameters pose_parameters(const Pose& pose) {
    const auto& [r, t] = pose;
    return {r.x, r.y, r.z, t.x, t.y, t.z};
}

Pose to_pose(const PoseParameters& p) {
    return {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}};
}

std::optional<Vec2d> predict(const CameraModel& model, const Pose& pose, const Vec2d& chart_mm, double disc_diameter_mm,
                             const std::optional<BoardShape>& board) {
    const Vec3d origin = to_camera(pose, {0.0, 0.0});
    const Vec3d normal = cross(to_camera(pose, {1.0, 0.0}) - origin, to_camera(pose, {0.0, 1.0}) - origin);
    const auto map = [&](double x, double y, Vec2d& pixel) {
        const double height_mm = board ? board_height(board->frame, board->height_mm.data(), x, y) : 0.0;
        const auto imaged = project(model, to_camera(pose, {x, y}) + height_mm * normal);
        pixel = imaged.value_or(Vec2d{});
        return imaged.has_value();
    };
    Vec2d predicted;
    const bool imaged = disc_diameter_mm > 0.0 ? disc_centroid(map, chart_mm.x, chart_mm.y, disc_diameter_mm, predicted)
                                               : map(chart_mm.x, chart_mm.y, predicted);
    return imaged ? std::optional(predicted) : std::nullopt;
}

std::unique_ptr<ceres::CostFunction> reprojection_cost(ModelKind kind, const Feature& feature,
                                                       const BoardFrame& frame) {
    return std::make_unique<ReprojectionCost>(kind, kCounts[static_cast<std::size_t>(kind)], feature, frame);
}

}  // namespace lensproof::calibration
