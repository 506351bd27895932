#include "engine/optics/float_error.h"

#include <algorithm>
#include <cmath>

#include "engine/optics/convert_lens.h"

namespace lensproof::optics {

namespace {

/// A ray's points on the surfaces and, forward, on the image plane; in double, which holds either type's.
struct TracedPath {
    std::vector<Vec3d> points;
    bool arrives = false;  // at the image plane, or in reverse at the first surface
    RayFate fate;
};

template <Direction direction, Rims rims, class T>
TracedPath path_of(const TraceLens<T>& lens, const GhostPath& reflections, const Ray<double>& ray) {
    TracedPath path;
    const auto visit = [&](const SurfaceEvent<T>& event) {
        if (event.status != RayStatus::missed) {  // that has no point
            path.points.push_back(convert_vector<double>(event.ray.origin));
        }
    };
    const TracedRay<T> traced = reflections.empty()
                                    ? trace<direction, rims>(lens, convert_ray<T>(ray), visit)
                                    : trace_ghost<direction, rims>(lens, reflections, convert_ray<T>(ray), {}, visit);
    path.fate = {traced.status, traced.surface};
    const bool ends = !gets_through(traced.status) || (rims == Rims::clip && traced.status != RayStatus::ok);
    path.arrives = !ends && (direction == Direction::reverse || traced.ray.direction.z > T(0));
    if (path.arrives && direction == Direction::forward) {
        path.points.push_back(convert_vector<double>(meet_plane(traced.ray, lens.image_z).point));
    }
    return path;
}

template <Direction direction, Rims rims>
RayInFloat compare(const TraceLens<float>& lens_in_float, const TraceLens<double>& lens, const Ray<double>& ray,
                   const GhostPath& reflections = {}) {
    constexpr double kUmPerMm = 1e3;
    const TracedPath in_float = path_of<direction, rims>(lens_in_float, reflections, ray);
    const TracedPath in_double = path_of<direction, rims>(lens, reflections, ray);
    RayInFloat compared{.in_float = in_float.fate, .in_double = in_double.fate};
    for (std::size_t i = 0; i < std::min(in_float.points.size(), in_double.points.size()); ++i) {
        compared.off_um.push_back(kUmPerMm * length(in_float.points[i] - in_double.points[i]));
    }
    if (in_float.arrives && in_double.arrives) {
        compared.end_off_um = compared.off_um.back();
    }
    return compared;
}

}  // namespace

RayInFloat trace_in_float(const TraceLens<float>& lens_in_float, const TraceLens<double>& lens, const Ray<double>& ray,
                          Direction direction, Rims rims) {
    const bool clip = rims == Rims::clip;
    if (direction == Direction::forward) {
        return clip ? compare<Direction::forward, Rims::clip>(lens_in_float, lens, ray)
                    : compare<Direction::forward, Rims::follow>(lens_in_float, lens, ray);
    }
    return clip ? compare<Direction::reverse, Rims::clip>(lens_in_float, lens, ray)
                : compare<Direction::reverse, Rims::follow>(lens_in_float, lens, ray);
}

RayInFloat trace_ghost_in_float(const TraceLens<float>& lens_in_float, const TraceLens<double>& lens,
                                const GhostPath& path, const Ray<double>& ray, Rims rims) {
    return rims == Rims::clip ? compare<Direction::forward, Rims::clip>(lens_in_float, lens, ray, path)
                              : compare<Direction::forward, Rims::follow>(lens_in_float, lens, ray, path);
}

void Distances::add(double um) {
    ++points;
    largest_um = std::max(largest_um, um);
    sum_of_squares += um * um;
}

double Distances::rms_um() const {
    return points > 0 ? std::sqrt(sum_of_squares / points) : 0.0;
}

void FloatError::add(const RayInFloat& ray) {
    ++rays;
    other_fates += ray.in_float == ray.in_double ? 0 : 1;
    for (const double um : ray.off_um) {
        anywhere.add(um);
    }
    if (ray.end_off_um) {
        at_end.add(*ray.end_off_um);
    }
}

double float_error_bound_um(double system_length_mm) {
    return 1e-3 * system_length_mm;
}

}  // namespace lensproof::optics
