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
    // The state in single variables, made a TracedRay only at the end, and two vectors for `intersect` rather than a
    // Ray: g++ 12 keeps the aggregates in memory, written 8 bytes at a time and copied 16 at a time, which processors
    // do not forward from store to load. That doubled the time of a surface (lensproof_benchmark, trace/tessar).
    Vec3<T> origin = ray.origin;
    Vec3<T> way = ray.direction;
    T optical_path = T(0);
    T transmittance = T(1);
    RayStatus status = RayStatus::ok;
    int ended_at = -1;
    const auto report = [&](int index, RayStatus here) {
        visit(SurfaceEvent<T>{index, {origin, way}, optical_path, transmittance, here});
    };
    const auto traced = [&] { return TracedRay<T>{{origin, way}, optical_path, transmittance, status, ended_at}; };

    const int count = static_cast<int>(lens.surfaces.size());
    const T heading = direction == Direction::forward ? T(1) : T(-1);
    for (int step = 0; step < count; ++step) {
        const int index = direction == Direction::forward ? step : count - 1 - step;
        const TraceSurface<T>& surface = lens.surfaces[index];
        const T& index_before = direction == Direction::forward ? surface.index_before : surface.index_after;
        const T& index_after = direction == Direction::forward ? surface.index_after : surface.index_before;
        const T& ratio = direction == Direction::forward ? surface.forward_ratio : surface.reverse_ratio;
        const T& c = surface.curvature;

        const Vec3<T> from_vertex{origin.x, origin.y, origin.z - surface.vertex_z};
        const Intersection<T> meeting = intersect(from_vertex, way, c, heading);
        if (!any(meeting.hit)) {
            status = RayStatus::missed;
            ended_at = index;
            report(index, status);
            return traced();
        }
        const Vec3<T>& point = meeting.point;
        optical_path = optical_path + index_before * meeting.distance;
        origin = {point.x, point.y, point.z + surface.vertex_z};

        RayStatus here = RayStatus::ok;
        if (any(point.x * point.x + point.y * point.y > surface.semi_diameter_squared)) {
            if (status == RayStatus::ok) {  // only the first rim passed is named
                here = surface.is_stop ? RayStatus::stopped : RayStatus::clipped;
                status = here;
                ended_at = index;
            }
            if (rims == Rims::clip) {
                report(index, here);
                return traced();
            }
        }

        // The sphere's unit normal at the point, turned along the ray.
        const Vec3<T> normal = heading * Vec3<T>{-c * point.x, -c * point.y, T(1) - c * point.z};
        const Refraction<T> bent = refract(way, normal, meeting.cos_incidence, ratio);
        if (!any(bent.transmitted)) {
            status = RayStatus::total_internal_reflection;
            ended_at = index;
            report(index, status);
            return traced();
        }
        way = bent.direction;
        transmittance = transmittance *
                        fresnel_transmittance(index_before, index_after, meeting.cos_incidence, bent.cos_refraction);
        report(index, here);
    }
    if (status == RayStatus::ok) {
        ended_at = direction == Direction::forward ? count - 1 : 0;
    }
    return traced();
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
