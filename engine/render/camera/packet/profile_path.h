// engine/render/camera/packet/profile_path.h — from the film through a camera that has a lens's radial profile.
#pragma once
#include <cmath>
#include <numbers>

#include "engine/base/disc.h"
#include "engine/base/elementary.h"
#include "engine/base/look_up.h"
#include "engine/base/ray.h"
#include "engine/base/select.h"

namespace lensproof::render {

/// Rays that were made through a pupil's edge lie in it, wherever rounding may see them.
inline constexpr double kPupilEdge = 1.0 + 1e-9;

/// Curves over a number, one a wavelength, as plain arrays (RadialCurve).
struct RadialCurves {
    const double* pieces = nullptr;  // of each curve's steps, and of the end itself: a, b, c, d
    double pieces_each = 0.0;
    const double* per_step = nullptr;
    const double* end = nullptr;
};

/// What a ProfileCamera is made of (profile_camera.h), as plain arrays.
struct ProfileTables {
    RadialCurves field_angle;  // of a film radius
    RadialCurves radius;       // and back: to 1e-6 of it
    RadialCurves illumination;
    RadialCurves pupil_z;  // of a field angle; the same for all wavelengths: one curve
    const double* transmittance = nullptr;
    const double* axial_radius = nullptr;  // of the pupil, mm
    bool is_pinhole = false;
    double focus_z = 0.0;
    double lead_mm = 0.0;
};

/// Everything below: T is double, or a packet of them; every lane has the bits of the double.
template <class T>
struct CurvePoint {
    T value;
    T slope;
};

/// Beyond the end as a line.
template <class T>
CurvePoint<T> curve_at(const RadialCurves& curves, const T& curve, const T& x) {
    const T per_step = look_up(curves.per_step, curve);
    const T step = x * per_step;
    const T last(curves.pieces_each - 1.0);
    const T i = whole(select(step < last, step, last));
    const T t = step - i;
    const Index<T> piece(T(4.0) * (curve * T(curves.pieces_each) + i));
    const T b = piece.look_up(curves.pieces + 1);
    const T c = piece.look_up(curves.pieces + 2);
    const T d = piece.look_up(curves.pieces + 3);
    return {piece.look_up(curves.pieces) + t * (b + t * (c + t * d)),
            (b + t * (T(2.0) * c + t * T(3.0) * d)) * per_step};
}

/// A chief ray, seen from its pupil's centre.
template <class T>
struct ProfileChief {
    Vec2<T> azimuth;  // of the film point, of unit length
    T angle;
    T sine;
    T cosine;
    T pupil_z;
    T pupil_slope;  // dz_e/dθ

    [[nodiscard]] Vec3<T> centre() const { return {T(0.0), T(0.0), pupil_z}; }
    [[nodiscard]] Vec3<T> outwards() const { return {-sine * azimuth.x, -sine * azimuth.y, -cosine}; }
    /// From coordinates across the ray, sagittal and tangential, and back.
    [[nodiscard]] Vec3<T> across(const Vec2<T>& q) const {
        return {cosine * azimuth.x * q.y - azimuth.y * q.x, azimuth.x * q.x + cosine * azimuth.y * q.y, -sine * q.y};
    }
    [[nodiscard]] Vec2<T> across(const Vec3<T>& from_centre) const {
        return {azimuth.x * from_centre.y - azimuth.y * from_centre.x,
                cosine * (azimuth.x * from_centre.x + azimuth.y * from_centre.y) - sine * from_centre.z};
    }
};

/// κ; 0 from 90° on.
template <class T>
T profile_focus_vergence(const ProfileTables& tables, const ProfileChief<T>& chief) {
    const auto is_seen = chief.cosine > T(tables.is_pinhole ? 2.0 : 0.0);
    return select(is_seen, T(1.0) / select(is_seen, chief.pupil_z - T(tables.focus_z), T(1.0)), T(0.0));
}

/// g of a point of the pupil.
template <class T>
T profile_per_etendue(const ProfileTables& tables, const ProfileChief<T>& chief, const Vec2<T>& q) {
    const T k = profile_focus_vergence(tables, chief);
    const T v = k * chief.cosine;
    const T spread = T(1.0) + v * v * dot(q, q);
    return spread * spread / ((T(1.0) + v * chief.pupil_slope * chief.sine) * (T(1.0) - k * chief.sine * q.y));
}

/// A, mm², of a film point at this radius, whose chief ray's angle grows by `angle_slope` a mm.
template <class T>
T profile_pupil_area(const T& radius, const T& angle_slope, const T& sine, const T& illumination,
                     const T& transmittance) {
    const auto is_off_axis = radius > T(0.0);
    const T sine_per_mm = select(is_off_axis, sine / select(is_off_axis, radius, T(1.0)), angle_slope);
    return illumination / (transmittance * sine_per_mm * angle_slope);
}

/// Sagittal and tangential, of a pupil of that area.
template <class T>
Vec2<T> profile_semi_axes(const T& axial_radius, const T& area) {
    return {axial_radius, area / (T(std::numbers::pi) * axial_radius)};
}

template <class T>
struct ProfilePath {
    Ray<T> ray;      // lens space, away from the camera, of unit length
    T illumination;  // what the path counts, sr; 0: no path
    T etendue;       // that over what the ray's etendue brings
};

/// Paths of film points, a wavelength each.
template <class T>
class ProfilePaths {
  public:
    ProfilePaths(const ProfileTables& tables, const Vec2<T>& film, const T& wavelength)
        : of_wavelength_(wavelength), wavelength_(wavelength), tables_(tables) {
        using std::sqrt;
        const T radius = sqrt(dot(film, film));
        is_lit_ = radius < of_wavelength_.look_up(tables.field_angle.end);
        radius_ = select(is_lit_, radius, T(0.0));
        const CurvePoint<T> angle = curve_at(tables.field_angle, wavelength_, radius_);
        angle_slope_ = angle.slope;
        const auto is_off_axis = radius_ > T(0.0);
        const T per_radius = T(1.0) / select(is_off_axis, radius_, T(1.0));
        chief_ = chief_at(angle.value, {select(is_off_axis, film.x * per_radius, T(1.0)),
                                        select(is_off_axis, film.y * per_radius, T(0.0))});
    }

    /// The one that two numbers in [0, 1) draw.
    [[nodiscard]] ProfilePath<T> draw(const T& u, const T& v) const {
        using std::sqrt;
        const T found = curve_at(tables_.illumination, wavelength_, radius_).value;
        const auto is_path = is_lit_ && found > T(0.0);
        const T illumination = select(is_path, found, T(1.0));
        const T transmittance = of_wavelength_.look_up(tables_.transmittance);
        Vec2<T> q{T(0.0), T(0.0)};
        if (!tables_.is_pinhole) {
            const Vec2<T> in_disc = warped_onto_disc(T(1.0), u, v);
            const Vec2<T> axes =
                profile_semi_axes(of_wavelength_.look_up(tables_.axial_radius),
                                  profile_pupil_area(radius_, angle_slope_, chief_.sine, illumination, transmittance));
            q = {axes.x * cross(chief_.azimuth, in_disc), axes.y * dot(chief_.azimuth, in_disc)};
        }
        const Vec3<T> from_centre = chief_.across(q);
        const Vec3<T> along =
            chief_.outwards() - (profile_focus_vergence(tables_, chief_) * chief_.cosine) * from_centre;
        const Vec3<T> direction = (T(1.0) / sqrt(dot(along, along))) * along;
        return {.ray = {chief_.centre() + from_centre + T(tables_.lead_mm) * direction, direction},
                .illumination = select(is_path, found, T(0.0)),
                .etendue = illumination / (transmittance * profile_per_etendue(tables_, chief_, q))};
    }

    /// Where such a path's ray passes the pupil.
    [[nodiscard]] Vec2<T> offset(const Ray<T>& ray) const {
        return chief_.across(ray.origin - T(tables_.lead_mm) * ray.direction - chief_.centre());
    }

    /// What becomes of the ray at another wavelength.
    struct Arrival {
        Vec2<T> film;
        T transmittance;  // below 0: it does not arrive
        T per_etendue;    // the pdf of such a path, as the hero of its own
    };
    [[nodiscard]] Arrival arrival(const T& wavelength, const Vec2<T>& q, const T& g) const {
        using std::numbers::pi;
        const Index<T> other(wavelength);
        const auto is_seen = chief_.angle <= other.look_up(tables_.radius.end);
        const T angle = select(is_seen, chief_.angle, T(0.0));
        const CurvePoint<T> near = curve_at(tables_.radius, wavelength, angle);
        const T end = other.look_up(tables_.field_angle.end);
        const CurvePoint<T> there =
            curve_at(tables_.field_angle, wavelength, select(near.value < end, near.value, end));
        const T radius = near.value - (there.value - angle) * near.slope;
        const T found = curve_at(tables_.illumination, wavelength, radius).value;
        auto arrives = is_seen && found > T(0.0);
        const T illumination = select(arrives, found, T(1.0));
        const T transmittance = other.look_up(tables_.transmittance);
        const auto is_off_axis = radius > T(0.0);
        const T divisor = select(is_off_axis, radius, T(1.0));
        const T per_both = T(1.0) / (divisor * illumination);
        const T per_illumination = per_both * divisor;
        if (!tables_.is_pinhole) {  // as profile_pupil_area and profile_semi_axes, with one division
            const T per_area = transmittance * there.slope *
                               select(is_off_axis, chief_.sine * per_both, there.slope * per_illumination);
            const T axial = other.look_up(tables_.axial_radius);
            // Both over the axes, times the sagittal one.
            const T y = q.y * (T(pi) * per_area * axial * axial);
            arrives = arrives && q.x * q.x + y * y <= T(kPupilEdge) * axial * axial;
        }
        const T brought = transmittance * g;
        return {.film = {radius * chief_.azimuth.x, radius * chief_.azimuth.y},
                .transmittance = select(arrives, brought, T(-1.0)),
                .per_etendue = brought * per_illumination};
    }

    [[nodiscard]] const ProfileChief<T>& chief() const { return chief_; }

  private:
    [[nodiscard]] ProfileChief<T> chief_at(const T& angle, const Vec2<T>& azimuth) const {
        const T end(*tables_.pupil_z.end);
        const auto is_within = angle < end;
        const CurvePoint<T> pupil = curve_at(tables_.pupil_z, T(0.0), select(is_within, angle, end));
        const Vec2<T> turn = cos_sin_within(angle);
        return {azimuth, angle, turn.y, turn.x, pupil.value, select(is_within, pupil.slope, T(0.0))};
    }

    Index<T> of_wavelength_;
    T wavelength_;
    T radius_;
    T angle_slope_;
    ProfileChief<T> chief_;
    const ProfileTables& tables_;
    MaskOf<T> is_lit_;
};

}  // namespace lensproof::render
