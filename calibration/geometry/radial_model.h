// calibration/geometry/radial_model.h — cameras that are round about their axis: one projection, many radial functions.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "engine/base/angle.h"
#include "engine/base/vec.h"

namespace lensproof::calibration {

inline constexpr double kRightAngle = kPi / 2 - 1e-6;  // where a perspective picture ends

/// The last parameter of every model: what heights in the picture are stretched by, less 1. With it the vertical focal
/// length is f (1 + stretch_y), f being the horizontal one: pixels that are not square, or a picture that was scaled.
inline constexpr std::string_view kStretchY = "stretch_y";

/// A camera that images a point along its azimuth at the distance r(θ) from the principal point (then stretched).
///
/// `Radial` says r(θ). It has `kind`; `names` of its own parameters, which stand behind the first three; how many of
/// them are coefficients of the distortion, lowest order first (`coefficients`; the rest are constants of the model,
/// never fitted); `largest_angle`; `radius(p, angle)`, px, of all parameters p; and `undistorted_angle(radius)`, the
/// inverse of the function without distortion, both in focal lengths.
template <class Radial>
struct RadialModel {
    static constexpr int count = 4 + static_cast<int>(Radial::names.size());
    static constexpr std::string_view kind = Radial::kind;
    static constexpr double largest_angle = Radial::largest_angle;

    static constexpr std::array<std::string_view, count> make_names() {
        std::array<std::string_view, count> result{"focal_length_px", "centre_x_px", "centre_y_px"};
        for (std::size_t i = 0; i < Radial::names.size(); ++i) {
            result[3 + i] = Radial::names[i];
        }
        result[count - 1] = kStretchY;
        return result;
    }
    static constexpr std::array<std::string_view, count> names = make_names();

    static constexpr std::array<int, Radial::coefficients> make_radial_terms() {
        std::array<int, Radial::coefficients> result{};
        for (int i = 0; i < Radial::coefficients; ++i) {
            result[static_cast<std::size_t>(i)] = 3 + i;
        }
        return result;
    }
    static constexpr std::array<int, Radial::coefficients> radial_terms = make_radial_terms();
    static constexpr std::array<int, 0> tangential_terms{};

    std::array<double, count> parameters{};

    /// False for a point at or beyond the model's largest angle, and for the camera's own position.
    template <class T>
    static bool project(const T* p, const Vec3<T>& point, Vec2<T>& pixel) {
        using std::atan2;
        using std::isfinite;
        using std::sqrt;
        const T lateral2 = point.x * point.x + point.y * point.y;
        T scale;  // r / lateral distance
        if (lateral2 > T(1e-24) * point.z * point.z) {
            const T lateral = sqrt(lateral2);
            const T angle = atan2(lateral, point.z);
            if (!(angle < T(largest_angle))) {
                return false;
            }
            const T r = Radial::radius(p, angle);
            if (!isfinite(r)) {
                return false;
            }
            scale = r / lateral;
        } else if (point.z > T(0)) {
            scale = p[0] / point.z;
        } else {
            return false;
        }
        pixel.x = p[1] + scale * point.x;
        pixel.y = p[2] + (T(1) + p[count - 1]) * scale * point.y;
        return true;
    }

    template <class T>
    static T radius(const T* p, const T& angle) {
        return Radial::radius(p, angle);
    }

    static double undistorted_angle(double focal_px, double radius_px) {
        return Radial::undistorted_angle(radius_px / focal_px);
    }
};

}  // namespace lensproof::calibration
