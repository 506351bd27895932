// engine/optics/polarisation.h — what a path through coated surfaces does to polarised light.
#pragma once
#include <array>
#include <cmath>
#include <complex>

#include "engine/base/vec.h"
#include "engine/optics/coating_amplitudes.h"

namespace lensproof::optics {

/// The field after a path as a linear function of the field before it: a complex 3 × 3 matrix in lens space, so that
/// planes of incidence at any angle to each other need no frames (three-dimensional polarisation ray tracing: Yun,
/// Crabtree, Chipman, Appl. Opt. 50, 2855, 2011). At each surface
///     P = a_s s sᵀ + a_p p′ pᵀ + k′ kᵀ,   s along k × n, p = s × k, p′ = s × k′,
/// with k and k′ the directions before and after it and n its normal. The amplitudes a are such that |E|² is the ray's
/// power, that is, with √(n′ cos θ′ / (n cos θ)) in those of transmission.
///
/// T: float, double, long double or a multiprecision number. Built beside a tracer, surface by surface; directions of
/// unit length.
template <class T>
class PolarisedPath {
  public:
    using Complex = std::complex<T>;
    using Field = std::array<Complex, 3>;

    explicit PolarisedPath(const Vec3<T>& direction) : start_(direction), direction_(direction) {
        for (std::size_t i = 0; i < 3; ++i) {
            matrix_[i][i] = T(1);
        }
    }

    /// Passes a surface between `n1` on the scene's side and `n2` on the sensor's, and goes on along `after`, which
    /// Snell's law gives. `normal` is the surface's, of either sign and any length.
    void refract(const TraceCoating<T>& coating, const T& n1, const T& n2, bool from_scene_side, const Vec3<T>& normal,
                 const Vec3<T>& after) {
        using std::abs;
        using std::sqrt;
        const T cos_before = cosine(direction_, normal);
        const CoatedAmplitudes<T> amplitudes = coating_amplitudes(coating, n1, n2, cos_before, from_scene_side);
        const T near = abs(from_scene_side ? n1 : n2);
        const T far = abs(from_scene_side ? n2 : n1);
        const T to_power = sqrt(far * cosine(after, normal) / (near * cos_before));
        pass(to_power * amplitudes.t_s, to_power * amplitudes.t_p, normal, after);
    }

    /// Is reflected at it.
    void reflect(const TraceCoating<T>& coating, const T& n1, const T& n2, bool from_scene_side,
                 const Vec3<T>& normal) {
        const CoatedAmplitudes<T> amplitudes =
            coating_amplitudes(coating, n1, n2, cosine(direction_, normal), from_scene_side);
        const T twice = T(2) * dot(direction_, normal) / dot(normal, normal);
        pass(amplitudes.r_s, amplitudes.r_p, normal, direction_ - twice * normal);
    }

    [[nodiscard]] const Vec3<T>& direction() const { return direction_; }

    /// The field that a field at right angles to the first direction becomes.
    [[nodiscard]] Field field(const Field& before) const {
        Field after{};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                after[i] += times(matrix_[i][k], before[k]);
            }
        }
        return after;
    }

    /// The fraction of power that arrives of light polarised linearly along the unit vector `axis`.
    [[nodiscard]] T transmittance(const Vec3<T>& axis) const {
        return power(field({Complex(axis.x), Complex(axis.y), Complex(axis.z)}));
    }

    /// Of unpolarised light: the mean over any two polarisations at right angles. All columns of P hold both of these
    /// and the image of k, which is k′.
    [[nodiscard]] T transmittance() const {
        T sum = T(0);
        for (const Field& row : matrix_) {
            sum = sum + power(row);
        }
        return (sum - transmittance(start_)) / T(2);
    }

  private:
    static T power(const Field& of) { return std::norm(of[0]) + std::norm(of[1]) + std::norm(of[2]); }

    static T cosine(const Vec3<T>& direction, const Vec3<T>& normal) {
        using std::abs;
        return abs(dot(direction, normal)) / length(normal);
    }

    /// A unit vector along k × n; at normal incidence, where every s will do, one at right angles to k.
    static Vec3<T> s_axis(const Vec3<T>& k, const Vec3<T>& normal) {
        using std::abs;
        const Vec3<T> across = cross(k, normal);
        if (dot(across, across) > T(0)) {
            // Once more at right angles to k: near normal incidence the product's direction has lost digits.
            const Vec3<T> unit = normalized(across);
            return normalized(unit - dot(unit, k) * k);
        }
        return normalized(cross(k, abs(k.x) < T(0.5) ? Vec3<T>{T(1), T(0), T(0)} : Vec3<T>{T(0), T(1), T(0)}));
    }

    void pass(const Complex& a_s, const Complex& a_p, const Vec3<T>& normal, const Vec3<T>& after) {
        const Vec3<T> s = s_axis(direction_, normal);
        const Vec3<T> p = cross(s, direction_);
        const Vec3<T> s_after = normalized(s - dot(s, after) * after);
        const Vec3<T> p_after = cross(s_after, after);
        const Field of_s = seen_along(s);
        const Field of_p = seen_along(p);
        const Field of_k = seen_along(direction_);
        const std::array<std::array<T, 3>, 3> to = {std::array{s_after.x, p_after.x, after.x},
                                                    {s_after.y, p_after.y, after.y},
                                                    {s_after.z, p_after.z, after.z}};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                matrix_[i][k] = to[i][0] * times(a_s, of_s[k]) + to[i][1] * times(a_p, of_p[k]) + to[i][2] * of_k[k];
            }
        }
        direction_ = after;
    }

    /// axisᵀ P.
    [[nodiscard]] Field seen_along(const Vec3<T>& axis) const {
        Field row{};
        for (std::size_t k = 0; k < 3; ++k) {
            row[k] = axis.x * matrix_[0][k] + axis.y * matrix_[1][k] + axis.z * matrix_[2][k];
        }
        return row;
    }

    std::array<Field, 3> matrix_{};
    Vec3<T> start_;
    Vec3<T> direction_;
};

}  // namespace lensproof::optics
