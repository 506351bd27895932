// calibration/camera_model.h — where a camera images a direction: two classical lens models over any number type.
#pragma once
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/optics/vec.h"

namespace lensproof {

// Frames. Camera: x to the right, y down, z into the scene, origin at the centre of projection (OpenCV's frame).
// Pixels: the centre of the top-left pixel is (0, 0). Angles are in radians and measured from the z axis.
//
// A model is a flat array of parameters, so that one template serves double and ceres::Jet. The first three are alike
// in every model: focal length (the slope of r(θ) on the axis; square pixels) and principal point, px.

/// Perspective projection with radial and tangential distortion (Brown 1971, "Close-range camera calibration"):
///     (x, y) = (X, Y) / Z,   ρ² = x² + y²,   L = 1 + k1 ρ² + k2 ρ⁴ + k3 ρ⁶,
///     u = cx + f (x L + 2 p1 x y + p2 (ρ² + 2 x²)),   v = cy + f (y L + p1 (ρ² + 2 y²) + 2 p2 x y).
/// Signs and order of the terms are OpenCV's. Images nothing at or beyond 90°.
struct BrownConrady {
    static constexpr int count = 8;
    static constexpr int max_radial_terms = 3;
    static constexpr std::array<std::string_view, count> names = {
        "focal_length_px", "centre_x_px", "centre_y_px", "k1", "k2", "k3", "p1", "p2"};
    static constexpr std::string_view kind = "brown-conrady";
    std::array<double, count> parameters{};

    template <class T>
    static T radial_factor(const T* p, const T& rho2) {
        return T(1) + rho2 * (p[3] + rho2 * (p[4] + rho2 * p[5]));
    }

    /// False, and `pixel` untouched, for a point that is not in front of the camera.
    template <class T>
    static bool project(const T* p, const Vec3<T>& point, Vec2<T>& pixel) {
        if (!(point.z > T(0))) {
            return false;
        }
        const T x = point.x / point.z;
        const T y = point.y / point.z;
        const T rho2 = x * x + y * y;
        const T radial = radial_factor(p, rho2);
        pixel.x = p[1] + p[0] * (x * radial + T(2) * p[6] * x * y + p[7] * (rho2 + T(2) * x * x));
        pixel.y = p[2] + p[0] * (y * radial + p[6] * (rho2 + T(2) * y * y) + T(2) * p[7] * x * y);
        return true;
    }

    /// The angle imaged at `radius` by the model without distortion; always in its range.
    static double undistorted_angle(double focal_px, double radius_px) { return std::atan(radius_px / focal_px); }

    /// Distance from the principal point (px) at which `angle` (0 ≤ angle < π/2) is imaged; tangential terms left out.
    template <class T>
    static T radius(const T* p, const T& angle) {
        using std::tan;
        const T rho = tan(angle);
        return p[0] * rho * radial_factor(p, T(rho * rho));
    }
};

/// Fisheye projection (Kannala & Brandt 2006, "A generic camera model", eq. 6, radially symmetric part):
///     r(θ) = f (θ + k1 θ³ + k2 θ⁵ + k3 θ⁷ + k4 θ⁹),
/// along the point's azimuth. Nothing divides by Z or cos θ: angles beyond 90° are as good as any.
struct KannalaBrandt {
    static constexpr int count = 7;
    static constexpr int max_radial_terms = 4;
    static constexpr std::array<std::string_view, count> names = {
        "focal_length_px", "centre_x_px", "centre_y_px", "k1", "k2", "k3", "k4"};
    static constexpr std::string_view kind = "kannala-brandt";
    std::array<double, count> parameters{};

    /// False only for the camera's own position and the direction straight backwards, which has no azimuth.
    template <class T>
    static bool project(const T* p, const Vec3<T>& point, Vec2<T>& pixel) {
        using std::atan2;
        using std::sqrt;
        const T lateral2 = point.x * point.x + point.y * point.y;
        T scale;  // r / lateral distance
        if (lateral2 > T(1e-24) * point.z * point.z) {
            const T lateral = sqrt(lateral2);
            scale = radius(p, T(atan2(lateral, point.z))) / lateral;
        } else if (point.z > T(0)) {
            scale = p[0] / point.z;
        } else {
            return false;
        }
        pixel.x = p[1] + scale * point.x;
        pixel.y = p[2] + scale * point.y;
        return true;
    }

    /// The angle imaged at `radius` by the model without distortion; beyond π there is none.
    static double undistorted_angle(double focal_px, double radius_px) { return radius_px / focal_px; }

    /// Distance from the principal point (px) at which `angle` (0 ≤ angle ≤ π) is imaged.
    template <class T>
    static T radius(const T* p, const T& angle) {
        const T a2 = angle * angle;
        return p[0] * angle * (T(1) + a2 * (p[3] + a2 * (p[4] + a2 * (p[5] + a2 * p[6]))));
    }
};

using CameraModel = std::variant<BrownConrady, KannalaBrandt>;

enum class ModelKind { brown_conrady, kannala_brandt };

/// "brown-conrady" or "kannala-brandt".
std::string kind_name(const CameraModel& model);
std::vector<std::string> parameter_names(const CameraModel& model);
std::vector<double> parameters(const CameraModel& model);
/// The model with other parameters; `values` has as many as `parameters(model)`.
CameraModel with_parameters(const CameraModel& model, const std::vector<double>& values);

double focal_length_px(const CameraModel& model);
Vec2d centre_px(const CameraModel& model);

/// The pixel that shows `point` (camera frame, any unit), if the model images it.
std::optional<Vec2d> project(const CameraModel& model, const Vec3d& point);

/// The radial function r(θ), px.
double radius_px(const CameraModel& model, double angle_rad);

/// Its inverse on the branch that starts on the axis: the angle imaged at `radius_px`, to machine precision. None
/// beyond the first maximum of r(θ), where the model folds back, and beyond 90° (perspective) or 180° (fisheye).
std::optional<double> field_angle_rad(const CameraModel& model, double radius_px);

/// The unit direction that `pixel` shows, on the same branch as `field_angle_rad`.
std::optional<Vec3d> unproject(const CameraModel& model, const Vec2d& pixel);

}  // namespace lensproof
