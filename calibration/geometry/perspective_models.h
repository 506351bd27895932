// calibration/geometry/perspective_models.h — lens models whose undistorted picture is the pinhole's, r = f tan θ.
#pragma once
#include <limits>

#include "calibration/geometry/radial_model.h"

namespace lensproof::calibration {

/// Perspective projection with radial and tangential distortion (Brown 1971, "Close-range camera calibration"):
///     (x, y) = (X, Y) / Z,   ρ² = x² + y²,   L = 1 + k1 ρ² + k2 ρ⁴ + k3 ρ⁶,
///     u = cx + f (x L + 2 p1 x y + p2 (ρ² + 2 x²)),   v = cy + f (1 + stretch_y) (y L + p1 (ρ² + 2 y²) + 2 p2 x y).
/// The rational kind divides L by 1 + k4 ρ² + k5 ρ⁴ + k6 ρ⁶ (Claus & Fitzgibbon 2005; OpenCV's 8 coefficients).
/// Signs and order of the terms are OpenCV's. Images nothing at or beyond 90°.
template <bool rational>
struct BrownConradyModel {
    static constexpr int count = rational ? 12 : 9;
    static constexpr std::string_view kind = rational ? "brown-conrady-rational" : "brown-conrady";
    static constexpr double largest_angle = kRightAngle;
    static constexpr auto names = [] {
        if constexpr (rational) {
            return std::array<std::string_view, count>{
                "focal_length_px", "centre_x_px", "centre_y_px", "k1", "k2", "k3", "p1", "p2", "k4", "k5", "k6",
                kStretchY};
        } else {
            return std::array<std::string_view, count>{
                "focal_length_px", "centre_x_px", "centre_y_px", "k1", "k2", "k3", "p1", "p2", kStretchY};
        }
    }();
    static constexpr auto radial_terms = [] {
        if constexpr (rational) {
            return std::array<int, 6>{3, 4, 5, 8, 9, 10};
        } else {
            return std::array<int, 3>{3, 4, 5};
        }
    }();
    static constexpr std::array<int, 2> tangential_terms{6, 7};
    std::array<double, count> parameters{};

    template <class T>
    static T radial_factor(const T* p, const T& rho2) {
        T factor = T(1) + rho2 * (p[3] + rho2 * (p[4] + rho2 * p[5]));
        if constexpr (rational) {
            factor = factor / (T(1) + rho2 * (p[8] + rho2 * (p[9] + rho2 * p[10])));
        }
        return factor;
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
        pixel.y =
            p[2] + p[0] * (T(1) + p[count - 1]) * (y * radial + p[6] * (rho2 + T(2) * y * y) + T(2) * p[7] * x * y);
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

using BrownConrady = BrownConradyModel<false>;
using RationalBrownConrady = BrownConradyModel<true>;

/// The division model (Fitzgibbon 2001, "Simultaneous linear estimation of multiple view geometry and lens
/// distortion"): tan θ = ρ / (1 + λ ρ²) with ρ = r / f, solved for
///     ρ = 2 sin θ / (cos θ + √(cos² θ − 4 λ sin² θ)).
/// Barrel distortion (λ < 0) reaches beyond 90°; λ = −1/4 is the stereographic fisheye. With λ > 0 there is an angle,
/// tan θ = 1 / (2 √λ), that nothing beyond is imaged.
struct DivisionRadial {
    static constexpr std::string_view kind = "division";
    static constexpr std::array<std::string_view, 1> names{"lambda"};
    static constexpr int coefficients = 1;
    static constexpr double largest_angle = std::numbers::pi - 1e-6;

    /// Not a number where nothing is imaged.
    template <class T>
    static T radius(const T* p, const T& angle) {
        using std::cos;
        using std::sin;
        using std::sqrt;
        const T s = sin(angle);
        const T c = cos(angle);
        if (!(p[3] < T(0)) && !(c > T(0))) {
            return T(std::numeric_limits<double>::quiet_NaN());
        }
        return T(2) * p[0] * s / (c + sqrt(c * c - T(4) * p[3] * s * s));
    }
    static double undistorted_angle(double radius) { return std::atan(radius); }
};
using Division = RadialModel<DivisionRadial>;

// lensfun's three models (lensfun 0.3, "Lens distortion"). There u is the undistorted and d the distorted radius, both
// in units of R, and R is half the shorter side of the picture between the centres of the outermost pixels,
//     R = (min(width, height) − 1) / 2 px  (the parameter `normalisation_px`),   u = F tan θ / R,   r = R d.
// lensfun's nominal focal length F leaves the magnification at u = 1 alone, not that on the axis. Here the first
// parameter f is the slope on the axis, as in every model: f = F d'(0). The coefficients are lensfun's own.

/// d = u (1 − k1 + k1 u²);   F = f / (1 − k1).
struct Poly3Radial {
    static constexpr std::string_view kind = "poly3";
    static constexpr std::array<std::string_view, 2> names{"k1", "normalisation_px"};
    static constexpr int coefficients = 1;
    static constexpr double largest_angle = kRightAngle;

    template <class T>
    static T radius(const T* p, const T& angle) {
        using std::tan;
        const T slope = T(1) - p[3];
        const T pinhole = p[0] / slope * tan(angle);
        const T u = pinhole / p[4];
        return pinhole * (slope + p[3] * u * u);
    }
    static double undistorted_angle(double radius) { return std::atan(radius); }
};
using Poly3 = RadialModel<Poly3Radial>;

/// d = u (1 + k1 u² + k2 u⁴);   F = f.
struct Poly5Radial {
    static constexpr std::string_view kind = "poly5";
    static constexpr std::array<std::string_view, 3> names{"k1", "k2", "normalisation_px"};
    static constexpr int coefficients = 2;
    static constexpr double largest_angle = kRightAngle;

    template <class T>
    static T radius(const T* p, const T& angle) {
        using std::tan;
        const T pinhole = p[0] * tan(angle);
        const T u2 = pinhole * pinhole / (p[5] * p[5]);
        return pinhole * (T(1) + u2 * (p[3] + u2 * p[4]));
    }
    static double undistorted_angle(double radius) { return std::atan(radius); }
};
using Poly5 = RadialModel<Poly5Radial>;

/// d = u (a u³ + b u² + c u + 1 − a − b − c);   F = f / (1 − a − b − c). The parameters' order is b, a, c: what a fit
/// with fewer terms leaves out first stands last.
struct PtLensRadial {
    static constexpr std::string_view kind = "ptlens";
    static constexpr std::array<std::string_view, 4> names{"b", "a", "c", "normalisation_px"};
    static constexpr int coefficients = 3;
    static constexpr double largest_angle = kRightAngle;

    template <class T>
    static T radius(const T* p, const T& angle) {
        using std::tan;
        const T slope = T(1) - p[3] - p[4] - p[5];
        const T pinhole = p[0] / slope * tan(angle);
        const T u = pinhole / p[6];
        return pinhole * (slope + u * (p[5] + u * (p[3] + u * p[4])));
    }
    static double undistorted_angle(double radius) { return std::atan(radius); }
};
using PtLens = RadialModel<PtLensRadial>;

}  // namespace lensproof::calibration
