// engine/optics/ghost_path.h — a ray that surfaces of the lens reflect on its way: along a ghost, surface by surface.
#pragma once
#include <string>
#include <vector>

#include "engine/optics/reflect.h"
#include "engine/optics/surface_axes.h"

namespace lensproof::optics {

/// The surfaces that reflect, counted from 0, in the order of reflection; the number of surfaces stands for the sensor.
/// Where the stop is no glass surface, its blades reflect: its plane outside the opening, from both sides.
using GhostPath = std::vector<int>;

/// Why light cannot go that way through a lens of `surfaces` surfaces, as in "surface 3 cannot follow surface 2: …",
/// counted from 1; empty where it can. Light enters at the front and ends on the sensor, so the reflections are even in
/// number; between the first and the second it runs back, and so on.
std::string path_fault(const GhostPath& path, int surfaces);

/// Reflectances that no prescription states, at every angle.
template <class T>
struct StrayMirrors {
    T sensor = T(0);
    T blades = T(0);
};

/// Whether reflections at a surface are those of the stop's blades.
template <class T>
constexpr bool reflects_by_blades(const TraceSurface<T>& surface) {
    return surface.is_stop && surface.index_before == surface.index_after;
}

/// A ray on its way: at the last surface that it met, or its origin.
template <class T>
struct TravellingRay {
    Vec3<T> origin;  // z from the last vertex passed, where the numbers are small
    T last_vertex_z = T(0);
    Vec3<T> direction;
    T optical_path = T(0);
    LeftBySurfaces<T> at_surfaces;  // of its light,
    T optical_depth = T(0);         // and the glass between them (`fading`)
    RayStatus status = RayStatus::ok;
    int surface = -1;  // where the status befell it

    [[nodiscard]] constexpr Ray<T> global() const {
        return {{origin.x, origin.y, origin.z + last_vertex_z}, direction};
    }

    template <class OfLens>
    constexpr void cross(const OfLens& lens, int towards, bool forward, const T& distance) {
        if (!lens.attenuation.empty()) {
            optical_depth = optical_depth + lens.attenuation_towards(towards, forward) * distance;
        }
    }

    template <class OfLens>
    [[nodiscard]] constexpr T transmittance(const OfLens& lens) const {
        return lens.attenuation.empty() ? at_surfaces.value() : T(at_surfaces.value() * fading(optical_depth));
    }

    constexpr void end(RayStatus why, int at) {
        status = why;
        surface = at;
    }
};

enum class AtSurface { pass, reflect };

/// Takes the ray to the sensor's plane and back from it; false where it does not meet it.
template <class OfLens, class T>
constexpr bool reflect_at_sensor(const OfLens& lens, const StrayMirrors<T>& mirrors, TravellingRay<T>& ray) {
    const int sensor = static_cast<int>(lens.surfaces.size());
    if (!(ray.direction.z > T(0))) {
        ray.end(RayStatus::missed, sensor);
        return false;
    }
    const PlanePoint<T> image = meet_plane(Ray<T>{ray.origin, ray.direction}, T(lens.image_z - ray.last_vertex_z));
    ray.origin = {image.point.x, image.point.y, T(0)};
    ray.last_vertex_z = lens.image_z;
    ray.optical_path = ray.optical_path + image.distance;
    ray.cross(lens, sensor, true, image.distance);
    ray.direction.z = -ray.direction.z;
    ray.at_surfaces.pass(mirrors.sensor);
    return true;
}

/// Where a ray has come to a surface: what decides how it goes on.
template <class T>
struct SurfaceMeeting {
    Vec3<T> direction{};  // of the ray, in the surface's own frame
    Vec3<T> normal{};     // of unit length, turned along the ray
    T cos_incidence = T(0);
    T open = T(1);  // of a stop's mask
    Refraction<T> bent{};
};

/// Takes `ray` to surface `index`, forward or back, where it is to go on as `what` says, by `go_on(const
/// SurfaceMeeting<T>&)`, which answers whether it does: a function that is called from here, so that all this stays in
/// single variables. Returns the status there, as an event of `trace` has it, and whether the ray goes on.
template <Rims rims, class OfLens, class T, class GoOn>
constexpr std::pair<RayStatus, bool> come_to_surface(const OfLens& lens, int index, bool forward, AtSurface what,
                                                     TravellingRay<T>& ray, GoOn&& go_on) {
    const TraceSurface<T>& surface = lens.surfaces[static_cast<std::size_t>(index)];
    const typename OfLens::Special* special = special_of(lens, surface);
    const T heading = forward ? T(1) : T(-1);
    const auto ended = [&](RayStatus why) {
        ray.end(why, index);
        return std::pair{why, false};
    };

    // In the surface's own frame, until the ray leaves it.
    Vec3<T> from_vertex{ray.origin.x, ray.origin.y, ray.origin.z - (surface.vertex_z - ray.last_vertex_z)};
    Vec3<T> direction = ray.direction;
    if (special != nullptr) {
        from_vertex =
            special->to_own({ray.origin.x - special->vertex.x, ray.origin.y - special->vertex.y, from_vertex.z});
        direction = special->to_own(ray.direction);
    }
    const T& c = surface.curvature;
    T to_vertex = T(0);
    Intersection<T> meeting;
    Vec3<T> normal;
    const bool is_shaped = special != nullptr && special->has_shape;
    if (is_shaped) {
        std::tie(meeting, normal) = intersect(special->shape, from_vertex, direction, heading);
    } else {
        if (rims == Rims::follow || (forward ? surface.from_far_forward : surface.from_far_reverse)) {
            to_vertex = distance_to_vertex(from_vertex, direction);
            from_vertex = from_vertex + to_vertex * direction;
        }
        meeting = intersect_from_near(from_vertex, direction, c, heading);
        normal = normal_of_sphere(meeting.point, c, heading);
    }
    if (!meeting.hit) {
        return ended(RayStatus::missed);
    }
    const Vec3<T>& point = meeting.point;
    const T& index_before = forward ? surface.index_before : surface.index_after;
    ray.optical_path = ray.optical_path + index_before * (to_vertex + meeting.distance);
    ray.cross(lens, index, forward, to_vertex + meeting.distance);
    ray.origin = point;
    ray.last_vertex_z = surface.vertex_z;
    if (special != nullptr) {
        const Vec3<T> turned = special->from_own(point);
        ray.origin = {turned.x + special->vertex.x, turned.y + special->vertex.y, turned.z};
    }

    const T r2 = point.x * point.x + point.y * point.y;
    const bool is_beyond = r2 > surface.semi_diameter_squared || !(surface.semi_diameter_squared > T(0));
    T open = is_beyond ? T(0) : T(1);
    if (special != nullptr && !is_beyond) {
        open = mask_transmittance(surface, *special, point.x, point.y);
    }
    const bool by_blades = what == AtSurface::reflect && reflects_by_blades(surface);
    if (by_blades && !(open < T(1))) {
        return ended(RayStatus::missed);
    }
    RayStatus here = RayStatus::ok;
    if (!by_blades && !(open > T(0))) {
        if (ray.status == RayStatus::ok) {  // only the first rim passed is named
            here = surface.is_stop ? RayStatus::stopped : RayStatus::clipped;
            ray.end(here, index);
        }
        if (rims == Rims::clip) {
            return {here, false};
        }
        open = T(1);
    }

    const T& ratio = forward ? surface.forward_ratio : surface.reverse_ratio;
    const Refraction<T> bent =
        is_shaped
            ? refract(direction, normal, meeting.cos_incidence, meeting.sin2_incidence, ratio)
            : refract_at_sphere(direction, point, c, heading, meeting.cos_incidence, meeting.sin2_incidence, ratio);
    const bool goes_on = go_on(SurfaceMeeting<T>{direction, normal, meeting.cos_incidence, open, bent});
    return {goes_on ? here : ray.status, goes_on};
}

/// Of the light that comes to the surface there, what goes back from it: from the blades of a stop, if it has them.
template <class OfLens, class T>
constexpr T reflected_at(const OfLens& lens, int index, bool forward, const StrayMirrors<T>& mirrors,
                         const SurfaceMeeting<T>& at) {
    const TraceSurface<T>& surface = lens.surfaces[static_cast<std::size_t>(index)];
    return reflects_by_blades(surface) ? T(mirrors.blades * (T(1) - at.open))
                                       : T(at.open * surface_reflectance(surface, special_of(lens, surface), forward,
                                                                         at.cos_incidence, at.bent));
}

/// Sends `ray`, which has come there, back.
template <class OfLens, class T>
constexpr void turn_back(const OfLens& lens, int index, const SurfaceMeeting<T>& at, TravellingRay<T>& ray) {
    const typename OfLens::Special* special = special_of(lens, lens.surfaces[static_cast<std::size_t>(index)]);
    const Vec3<T> direction = reflect(at.direction, at.normal, at.cos_incidence);
    ray.direction = special != nullptr ? special->from_own(direction) : direction;
}

/// Sends `ray`, which has come there, through the surface; false, and the ray is ended, where all of it is reflected.
template <class OfLens, class T>
[[gnu::always_inline]] constexpr bool pass_surface(const OfLens& lens, int index, bool forward,
                                                   const SurfaceMeeting<T>& at, TravellingRay<T>& ray) {
    if (!at.bent.transmitted) {
        ray.end(RayStatus::total_internal_reflection, index);
        return false;
    }
    const TraceSurface<T>& surface = lens.surfaces[static_cast<std::size_t>(index)];
    const typename OfLens::Special* special = special_of(lens, surface);
    if (special != nullptr && !special->coating.is_bare()) {
        ray.at_surfaces.pass(coated_transmittance(surface, *special, forward, at.cos_incidence));
    } else {
        ray.at_surfaces.pass(fresnel_transmittance(forward ? surface.forward_ratio : surface.reverse_ratio,
                                                   at.cos_incidence, at.bent.cos_refraction));
    }
    if (special != nullptr) {
        ray.at_surfaces.pass(at.open);
    }
    ray.at_surfaces.end_surface();
    ray.direction = special != nullptr ? special->from_own(at.bent.direction) : at.bent.direction;
    return true;
}

/// Takes `ray` to surface `index`, forward or back, and through it or back from it; returns what `come_to_surface`
/// does. A step of `trace`, with the same pieces in the same order, so that a ray which nothing has reflected yet has
/// the same bits; that loop is by itself, for it is as quick as it is only with its state in single variables.
template <Rims rims, class OfLens, class T>
constexpr std::pair<RayStatus, bool> run_to_surface(const OfLens& lens, int index, bool forward, AtSurface what,
                                                    const StrayMirrors<T>& mirrors, TravellingRay<T>& ray) {
    return come_to_surface<rims>(lens, index, forward, what, ray, [&](const SurfaceMeeting<T>& at) {
        if (what == AtSurface::pass) {
            return pass_surface(lens, index, forward, at, ray);
        }
        ray.at_surfaces.pass(reflected_at(lens, index, forward, mirrors, at));
        ray.at_surfaces.end_surface();
        turn_back(lens, index, at, ray);
        return true;
    });
}

/// Traces `ray` along a ghost: to the first surface of `path`, reflected there, back to the second, and so on, until it
/// leaves the last surface of the lens, as `trace` does (the sensor's plane is the caller's). Rims clip at every
/// passage. Total reflection ends a ray that should have passed, and reflects one whole that should be reflected; one
/// that should meet the stop's blades and finds them open has missed.
///
/// In reverse light comes from the sensor, and the path of the light that comes back is the same one reversed.
///
/// `visit(const SurfaceEvent<T>&)` is called at every surface met, in that order; the sensor's number is the number of
/// surfaces.
template <Direction direction = Direction::forward, Rims rims = Rims::clip, class OfLens, class Path = GhostPath,
          class T = decltype(OfLens::image_z), class Visitor>
constexpr TracedRay<T> trace_ghost(const OfLens& lens, const Path& path, const Ray<T>& ray,
                                   const StrayMirrors<T>& mirrors, Visitor&& visit) {
    const int count = static_cast<int>(lens.surfaces.size());
    TravellingRay<T> at{.origin = ray.origin, .direction = ray.direction};
    auto next = path.begin();
    int step = direction == Direction::forward ? 1 : -1;
    int last = -1;
    for (int index = step > 0 ? 0 : count - 1;; index += step) {
        const bool reflects = next != path.end() && *next == index;
        if (index < 0 || index > count || (index == count && !reflects)) {
            break;
        }
        const auto [here, goes_on] =
            index == count ? std::pair{RayStatus::ok, reflect_at_sensor(lens, mirrors, at)}
                           : run_to_surface<rims>(lens, index, step > 0,
                                                  reflects ? AtSurface::reflect : AtSurface::pass, mirrors, at);
        visit(SurfaceEvent<T>{index, at.global(), at.optical_path, at.transmittance(lens), goes_on ? here : at.status});
        last = index;
        if (!goes_on) {
            break;
        }
        if (reflects) {
            step = -step;
            ++next;
        }
    }
    return {at.global(), at.optical_path, at.transmittance(lens), at.status,
            at.status == RayStatus::ok ? last : at.surface};
}

template <Direction direction = Direction::forward, Rims rims = Rims::clip, class OfLens, class Path = GhostPath,
          class T = decltype(OfLens::image_z)>
constexpr TracedRay<T> trace_ghost(const OfLens& lens, const Path& path, const Ray<T>& ray,
                                   const StrayMirrors<T>& mirrors = {}) {
    return trace_ghost<direction, rims>(lens, path, ray, mirrors, [](const SurfaceEvent<T>&) {});
}

}  // namespace lensproof::optics
