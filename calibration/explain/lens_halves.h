// calibration/explain/lens_halves.h — a changed lens for the tracer, before and behind its stop, over any number type.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "calibration/explain/lens_change.h"
#include "engine/base/angle.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/dual_numbers.h"
#include "engine/optics/lens.h"
#include "engine/optics/refract.h"
#include "engine/optics/trace.h"

namespace lensproof::calibration {

/// What the changes start from: the lens at a wavelength, and its glasses' dispersion there.
struct BareLens {
    optics::TraceLens<double> traced;  // without blades, coatings and absorption
    int stop = 0;
    std::vector<double> n_d;         // of the medium behind each surface
    std::vector<double> V_d;         // infinite where the index is constant
    std::vector<double> dispersion;  // n(λ) − n_d, in units of n_F − n_C
};

template <class T>
using AxesOf = std::array<Vec3<T>, 3>;

/// Turned about x, then about y, by the right-hand rule, radians.
template <class T>
Vec3<T> turned(const Vec3<T>& v, const T& about_x, const T& about_y) {
    using std::cos;
    using std::sin;
    const Vec3<T> once{v.x, cos(about_x) * v.y - sin(about_x) * v.z, sin(about_x) * v.y + cos(about_x) * v.z};
    return {cos(about_y) * once.x + sin(about_y) * once.z, once.y, cos(about_y) * once.z - sin(about_y) * once.x};
}

/// The sensor and what becomes of a picture on it.
template <class T>
struct Sensor {
    Vec3<T> middle;
    AxesOf<T> axes;
    T scale;
    Vec2<T> shift;
};

template <class T>
struct LensHalves {
    optics::TraceLens<T> front;
    optics::TraceLens<T> rear;
    Vec3<T> stop_centre;
    AxesOf<T> stop_axes;
    T stop_ratio;  // index behind the stop over that before it
    Sensor<T> sensor;
};

/// The surfaces' places once the changes are made.
template <class T>
class SurfacePlaces {
  public:
    explicit SurfacePlaces(optics::TraceLens<T>& lens) : lens_(lens) {
        for (optics::TraceSurface<T>& surface : lens_.surfaces) {
            if (surface.special < 0) {
                surface.special = static_cast<int>(lens_.specials.size());
                lens_.specials.emplace_back();
            }
        }
    }
    void widen(int gap, const T& by) {
        for (std::size_t i = static_cast<std::size_t>(gap); i < lens_.surfaces.size(); ++i) {
            lens_.surfaces[i].vertex_z = lens_.surfaces[i].vertex_z + by;
        }
        lens_.image_z = lens_.image_z + by;
    }
    void shift(const LensChange& group, const T& by) {
        for (int i = group.first - 1; i < group.last; ++i) {
            Vec2<T>& vertex = special(i).vertex;
            (group.axis == 0 ? vertex.x : vertex.y) = (group.axis == 0 ? vertex.x : vertex.y) + by;
        }
    }
    /// About the group's first vertex.
    void turn(const LensChange& group, const T& angle) {
        const Vec3<T> pivot = place(group.first - 1);
        const auto turn_vector = [&](const Vec3<T>& v) {
            return group.axis == 0 ? turned(v, angle, T(0)) : turned(v, T(0), angle);
        };
        for (int i = group.first - 1; i < group.last; ++i) {
            const Vec3<T> moved = pivot + turn_vector(place(i) - pivot);
            special(i).vertex = {moved.x, moved.y};
            lens_.surfaces[static_cast<std::size_t>(i)].vertex_z = moved.z;
            for (Vec3<T>& axis : special(i).axes) {
                axis = turn_vector(axis);
            }
        }
    }
    [[nodiscard]] Vec3<T> place(int surface) const {
        const optics::TraceSurface<T>& at = lens_.surfaces[static_cast<std::size_t>(surface)];
        const optics::SpecialSurface<T>& beside = lens_.specials[static_cast<std::size_t>(at.special)];
        return {beside.vertex.x, beside.vertex.y, at.vertex_z};
    }
    optics::SpecialSurface<T>& special(int surface) {
        return lens_.specials[static_cast<std::size_t>(lens_.surfaces[static_cast<std::size_t>(surface)].special)];
    }

  private:
    optics::TraceLens<T>& lens_;
};

/// n = n_d + (n_d − 1) / V_d · dispersion, of the changed n_d and V_d.
template <class T>
void set_index(const BareLens& bare, int surface, const T& d_n, const T& d_V, optics::TraceLens<T>& lens) {
    const auto i = static_cast<std::size_t>(surface) - 1;
    const T n_d = T(bare.n_d[i]) + d_n;
    const T index =
        std::isfinite(bare.V_d[i]) ? n_d + (n_d - T(1)) / (T(bare.V_d[i]) + d_V) * T(bare.dispersion[i]) : n_d;
    optics::TraceSurface<T>& here = lens.surfaces[i];
    here.index_after = index;
    here.forward_ratio = here.index_before / index;
    here.reverse_ratio = index / here.index_before;
    if (i + 1 < lens.surfaces.size()) {
        optics::TraceSurface<T>& next = lens.surfaces[i + 1];
        next.index_before = index;
        next.forward_ratio = index / next.index_after;
        next.reverse_ratio = next.index_after / index;
    }
}

template <class T>
LensHalves<T> changed_halves(const BareLens& bare, const std::vector<LensChange>& changes, const std::vector<T>& values,
                             int profile) {
    optics::TraceLens<T> lens = optics::convert_lens<T>(bare.traced);
    SurfacePlaces<T> places(lens);
    T focus(0);
    std::array<T, 2> tilt{T(0), T(0)};
    std::array<T, 2> shift{T(0), T(0)};
    T scale(1);
    std::vector<std::array<T, 2>> glass(lens.surfaces.size() + 1, {T(0), T(0)});
    for (std::size_t c = 0; c < changes.size(); ++c) {
        const LensChange& change = changes[c];
        const T& value = values[c];
        if (change.profile >= 0 && change.profile != profile) {
            continue;
        }
        switch (change.kind) {
            case ChangeKind::focus:
                focus = value;
                break;
            case ChangeKind::gap:
                places.widen(change.first, value);
                break;
            case ChangeKind::decentre:
                places.shift(change, value);
                break;
            case ChangeKind::tilt:
                places.turn(change, value * T(kDegree));
                break;
            case ChangeKind::sensor_tilt:
                tilt[static_cast<std::size_t>(change.axis)] = value * T(kDegree);
                break;
            case ChangeKind::n_d:
            case ChangeKind::V_d:
                glass[static_cast<std::size_t>(change.first)][change.kind == ChangeKind::n_d ? 0 : 1] = value;
                break;
            case ChangeKind::scale:
                scale = T(1) + value;
                break;
            case ChangeKind::sensor_shift:
                shift[static_cast<std::size_t>(change.axis)] = value;
                break;
        }
    }
    for (const LensChange& change : changes) {
        if (change.kind == ChangeKind::n_d) {
            const auto& [d_n, d_V] = glass[static_cast<std::size_t>(change.first)];
            set_index(bare, change.first, d_n, d_V, lens);
        }
    }
    const Vec3<T> stop = places.place(bare.stop);
    LensHalves<T> halves{
        .front = {.surfaces = {}, .image_z = T(0), .specials = lens.specials},
        .rear = {.surfaces = {}, .image_z = T(0), .specials = lens.specials},
        .stop_centre = stop,
        .stop_axes = places.special(bare.stop).axes,
        .stop_ratio = lens.surfaces[static_cast<std::size_t>(bare.stop)].reverse_ratio,
        .sensor = {
            .middle = {T(0), T(0), lens.image_z + focus}, .axes = {}, .scale = scale, .shift = {shift[0], shift[1]}}};
    halves.sensor.axes = {turned({T(1), T(0), T(0)}, tilt[0], tilt[1]), turned({T(0), T(1), T(0)}, tilt[0], tilt[1]),
                          turned({T(0), T(0), T(1)}, tilt[0], tilt[1])};
    halves.front.surfaces.assign(lens.surfaces.begin(), lens.surfaces.begin() + bare.stop);
    halves.rear.surfaces.assign(lens.surfaces.begin() + bare.stop + 1, lens.surfaces.end());
    return halves;
}

/// A ray through the stop's centre along slopes `s` in its axes: by how much it misses the object along `across`, two
/// axes across the way there, in radians.
template <class T>
std::optional<Vec2<T>> miss(const LensHalves<T>& halves, const Vec2<T>& s, const Vec3<T>& object,
                            const std::array<Vec3d, 2>& across) {
    const auto& [x, y, z] = halves.stop_axes;
    const Vec3<T> direction = normalized(s.x * x + (s.y * y + z));
    const auto outwards = optics::refract(T(-1) * direction, T(-1) * z, dot(direction, z), halves.stop_ratio);
    const auto out = optics::trace<optics::Direction::reverse, optics::Rims::follow>(
        halves.front, Ray<T>{halves.stop_centre, outwards.direction});
    if (!outwards.transmitted || (out.status != optics::RayStatus::ok && out.status != optics::RayStatus::clipped)) {
        return std::nullopt;
    }
    const Vec3<T> off = normalized(object - out.ray.origin) - out.ray.direction;
    const auto along = [&](const Vec3d& axis) { return off.x * T(axis.x) + off.y * T(axis.y) + off.z * T(axis.z); };
    return Vec2<T>{along(across[0]), along(across[1])};
}

/// Where that ray meets the sensor.
template <class T>
std::optional<Vec2<T>> image(const LensHalves<T>& halves, const Vec2<T>& s) {
    const auto& [x, y, z] = halves.stop_axes;
    const auto out = optics::trace<optics::Direction::forward, optics::Rims::follow>(
        halves.rear, Ray<T>{halves.stop_centre, normalized(s.x * x + (s.y * y + z))});
    if ((out.status != optics::RayStatus::ok && out.status != optics::RayStatus::clipped) ||
        !(out.ray.direction.z > T(0))) {
        return std::nullopt;
    }
    const Sensor<T>& sensor = halves.sensor;
    const T distance = dot(sensor.middle - out.ray.origin, sensor.axes[2]) / dot(out.ray.direction, sensor.axes[2]);
    const Vec3<T> from_middle = out.ray.origin + distance * out.ray.direction - sensor.middle;
    return Vec2<T>{sensor.scale * dot(from_middle, sensor.axes[0]) + sensor.shift.x,
                   sensor.scale * dot(from_middle, sensor.axes[1]) + sensor.shift.y};
}

}  // namespace lensproof::calibration
