// calibration/geometry/fisheye_models.h — lens models about a fisheye's own projections, and one without a formula.
#pragma once
#include "calibration/geometry/radial_model.h"
#include "engine/optics/projection.h"

namespace lensproof::calibration {

/// Fisheye projection (Kannala & Brandt 2006, "A generic camera model", eq. 6, radially symmetric part):
///     r(θ) = f (θ + k1 θ³ + k2 θ⁵ + k3 θ⁷ + k4 θ⁹).
/// Nothing divides by Z or cos θ: angles beyond 90° are as good as any.
struct KannalaBrandtRadial {
    static constexpr std::string_view kind = "kannala-brandt";
    static constexpr std::array<std::string_view, 4> names{"k1", "k2", "k3", "k4"};
    static constexpr int coefficients = 4;
    static constexpr double largest_angle = kPi;

    template <class T>
    static T radius(const T* p, const T& angle) {
        const T a2 = angle * angle;
        return p[0] * angle * (T(1) + a2 * (p[3] + a2 * (p[4] + a2 * (p[5] + a2 * p[6]))));
    }
    static double undistorted_angle(double radius) { return radius; }
};
using KannalaBrandt = RadialModel<KannalaBrandtRadial>;

/// A classical projection g(θ) with a polynomial in its own radius:
///     r(θ) = f g (1 + k1 g² + k2 g⁴),
/// which is to the projection what k1 and k2 are to the pinhole: a lens that is centred on its axis has an r(θ) that is
/// odd in θ, and so only even powers of g in the bracket. Without terms (`radial_terms` 0) it is the projection itself.
template <optics::Projection projection>
struct PolynomialRadial {
    static constexpr std::string_view kind = optics::projection_name(projection);
    static constexpr std::array<std::string_view, 2> names{"k1", "k2"};
    static constexpr int coefficients = 2;
    static constexpr double largest_angle = projection == optics::Projection::orthographic    ? kRightAngle
                                            : projection == optics::Projection::stereographic ? kPi - 1e-6
                                                                                              : kPi;

    template <class T>
    static T radius(const T* p, const T& angle) {
        const T g = optics::projected_radius(projection, angle);
        const T g2 = g * g;
        return p[0] * g * (T(1) + g2 * (p[3] + g2 * p[4]));
    }
    static double undistorted_angle(double radius) { return optics::projected_angle(projection, radius); }
};

using Equidistant = RadialModel<PolynomialRadial<optics::Projection::equidistant>>;
using Equisolid = RadialModel<PolynomialRadial<optics::Projection::equisolid>>;
using Stereographic = RadialModel<PolynomialRadial<optics::Projection::stereographic>>;
using Orthographic = RadialModel<PolynomialRadial<optics::Projection::orthographic>>;

/// No formula: r(θ) = f θ (1 + S(θ)), S a uniform cubic B-spline of 10 intervals over 0 … `spline_end_rad`,
///     S(θ) = Σ_j c_j B₃(10 θ / end − j),   j = −1 … 11,   B₃ the cardinal cubic B-spline about 0,
/// with c₋₁ = c₁ (an r that is odd in θ is smooth on the axis) and c₀ = −c₁ / 2 (S(0) = 0, so that f is the slope
/// there). The parameters are c₁ … c₁₁. Twice continuously differentiable; beyond the end the last cubic goes on.
/// (After Schops et al. 2020, "Why having 10,000 parameters in your camera model is better than twelve", and mrcal's
/// splined models, in one dimension.)
struct SplineRadial {
    static constexpr int intervals = 10;
    static constexpr std::string_view kind = "spline";
    static constexpr std::array<std::string_view, intervals + 2> names{
        "c1", "c2", "c3", "c4", "c5", "c6", "c7", "c8", "c9", "c10", "c11", "spline_end_rad"};
    static constexpr int coefficients = intervals + 1;
    static constexpr double largest_angle = kPi;

    template <class T>
    static T coefficient(const T* p, int j) {
        return j == 0 ? T(-0.5) * p[3] : p[2 + (j < 0 ? -j : j)];
    }

    template <class T>
    static T radius(const T* p, const T& angle) {
        const T place = T(intervals) * angle / p[3 + coefficients];
        int interval = 0;
        while (interval < intervals - 1 && !(place < T(interval + 1))) {
            ++interval;
        }
        const T t = place - T(interval);
        const T s = T(1) - t;
        const T t2 = t * t;
        const T sum =
            s * s * s * coefficient(p, interval - 1) + (T(4) - T(6) * t2 + T(3) * t2 * t) * coefficient(p, interval) +
            (T(1) + T(3) * (t + t2 - t2 * t)) * coefficient(p, interval + 1) + t2 * t * coefficient(p, interval + 2);
        return p[0] * angle * (T(1) + sum / T(6));
    }
    static double undistorted_angle(double radius) { return radius; }
};
using Spline = RadialModel<SplineRadial>;

}  // namespace lensproof::calibration
