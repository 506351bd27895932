// engine/optics/trace.h — a ray through a lens, surface by surface: the one tracer that everything else uses.
#pragma once
#include <vector>

#include "engine/optics/intersect.h"
#include "engine/optics/ray.h"
#include "engine/optics/refract.h"

namespace lensproof {

/// One surface as the tracer sees it, at one wavelength. Flat, immutable, no look-up behind it.
template <class T>
struct TraceSurface {
    T curvature;              // 1/mm, positive where the centre of curvature lies at larger z
    T vertex_z;               // mm
    T semi_diameter_squared;  // mm²
    T index_before;           // of the medium on the scene's side
    T index_after;            // of the medium on the sensor's side
    T forward_ratio;          // index_before / index_after, and its inverse: divisions that the inner loop is spared
    T reverse_ratio;
    bool is_stop;
};

template <class T>
TraceSurface<T> make_trace_surface(T curvature, T vertex_z, T semi_diameter, T index_before, T index_after,
                                   bool is_stop) {
    return {.curvature = curvature,
            .vertex_z = vertex_z,
            .semi_diameter_squared = semi_diameter * semi_diameter,
            .index_before = index_before,
            .index_after = index_after,
            .forward_ratio = index_before / index_after,
            .reverse_ratio = index_after / index_before,
            .is_stop = is_stop};
}

/// A lens at one wavelength and in one precision: its surfaces from the scene to the sensor.
template <class T>
struct TraceLens {
    std::vector<TraceSurface<T>> surfaces;
    T image_z;  // the sensor's plane, mm
};

/// The way a ray walks: from the scene to the sensor, or from the sensor outwards.
enum class Direction { forward, reverse };

/// Whether a ray that meets a surface beyond its rim ends there. `follow` traces the geometry alone; the status still
/// names the first rim that was passed.
enum class Rims { clip, follow };

/// A ray after the last surface that it reached.
template <class T>
struct TracedRay {
    Ray<T> ray;       // origin on that surface, direction after it (before it where it ended there)
    T optical_path;   // Σ n·t from the ray's origin, mm
    T transmittance;  // Fresnel, every surface passed, unpolarised
    RayStatus status;
    int surface;  // counted from 0 as in the prescription: where it was clipped or ended, else the last one
};

/// What `trace` reports at a surface that a ray reached.
template <class T>
struct SurfaceEvent {
    int surface;
    Ray<T> ray;
    T optical_path;
    T transmittance;
    RayStatus status;
};

/// Traces `ray` (global lens space, direction of unit length) through `lens`. In air before the first surface.
///
/// `visit(const SurfaceEvent<T>&)` is called at every surface reached, the one where the ray ends included.
/// A missed surface has no point: its event repeats the ray as it was.
template <Direction direction = Direction::forward, Rims rims = Rims::clip, class T, class Visitor>
TracedRay<T> trace(const TraceLens<T>& lens, const Ray<T>& ray, Visitor&& visit) {
    TracedRay<T> state{.ray = ray, .optical_path = T(0), .transmittance = T(1), .status = RayStatus::ok, .surface = -1};
    const int count = static_cast<int>(lens.surfaces.size());
    const T heading = direction == Direction::forward ? T(1) : T(-1);
    for (int step = 0; step < count; ++step) {
        const int index = direction == Direction::forward ? step : count - 1 - step;
        const TraceSurface<T>& surface = lens.surfaces[index];
        const T& index_before = direction == Direction::forward ? surface.index_before : surface.index_after;
        const T& index_after = direction == Direction::forward ? surface.index_after : surface.index_before;
        RayStatus here = RayStatus::ok;

        Ray<T> local = state.ray;
        local.origin.z = local.origin.z - surface.vertex_z;
        const Intersection<T> meeting = intersect(local, surface.curvature, heading);
        if (!any(meeting.hit)) {
            state.status = RayStatus::missed;
            state.surface = index;
            visit(SurfaceEvent<T>{index, state.ray, state.optical_path, state.transmittance, state.status});
            return state;
        }
        const Vec3<T>& point = meeting.point;
        state.optical_path = state.optical_path + index_before * meeting.distance;
        state.ray.origin = {point.x, point.y, point.z + surface.vertex_z};

        if (any(point.x * point.x + point.y * point.y > surface.semi_diameter_squared)) {
            here = surface.is_stop ? RayStatus::stopped : RayStatus::clipped;
            if (state.status == RayStatus::ok) {
                state.status = here;
                state.surface = index;
            } else {
                here = RayStatus::ok;  // only the first rim passed is named
            }
            if (rims == Rims::clip) {
                visit(SurfaceEvent<T>{index, state.ray, state.optical_path, state.transmittance, here});
                return state;
            }
        }

        // The sphere's unit normal at the point, turned along the ray.
        const T c = surface.curvature;
        const Vec3<T> normal = heading * Vec3<T>{-c * point.x, -c * point.y, T(1) - c * point.z};
        const Refraction<T> bent =
            refract(local.direction, normal, meeting.cos_incidence,
                    direction == Direction::forward ? surface.forward_ratio : surface.reverse_ratio);
        if (!any(bent.transmitted)) {
            state.status = RayStatus::total_internal_reflection;
            state.surface = index;
            visit(SurfaceEvent<T>{index, state.ray, state.optical_path, state.transmittance, state.status});
            return state;
        }
        state.ray.direction = bent.direction;
        state.transmittance = state.transmittance * fresnel_transmittance(index_before, index_after,
                                                                          meeting.cos_incidence, bent.cos_refraction);
        visit(SurfaceEvent<T>{index, state.ray, state.optical_path, state.transmittance, here});
    }
    if (state.status == RayStatus::ok) {
        state.surface = direction == Direction::forward ? count - 1 : 0;
    }
    return state;
}

template <Direction direction = Direction::forward, Rims rims = Rims::clip, class T>
TracedRay<T> trace(const TraceLens<T>& lens, const Ray<T>& ray) {
    return trace<direction, rims>(lens, ray, [](const SurfaceEvent<T>&) {});
}

/// Where `ray` meets the plane at `z` mm, and the geometrical way there (signed, mm). The ray must not run parallel to
/// it.
template <class T>
struct PlanePoint {
    Vec3<T> point;
    T distance;
};

template <class T>
PlanePoint<T> meet_plane(const Ray<T>& ray, const T& z) {
    const T distance = (z - ray.origin.z) / ray.direction.z;
    Vec3<T> point = ray.origin + distance * ray.direction;
    point.z = z;
    return {point, distance};
}

}  // namespace lensproof
