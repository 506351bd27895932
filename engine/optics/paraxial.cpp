#include "engine/optics/paraxial.h"

#include <algorithm>
#include <cmath>

namespace lensproof {

namespace {

int find_stop(const TraceLens<double>& lens) {
    const auto stop = std::ranges::find_if(lens.surfaces, &TraceSurface<double>::is_stop);
    return static_cast<int>(stop - lens.surfaces.begin());
}

ParaxialRay refracted(ParaxialRay ray, const TraceSurface<double>& surface) {
    const double n1 = surface.index_before;
    const double n2 = surface.index_after;
    return {ray.height, (n1 * ray.slope - ray.height * surface.curvature * (n2 - n1)) / n2};
}

ParaxialRay refracted_backwards(ParaxialRay ray, const TraceSurface<double>& surface) {
    const double n1 = surface.index_before;
    const double n2 = surface.index_after;
    return {ray.height, (n2 * ray.slope + ray.height * surface.curvature * (n2 - n1)) / n1};
}

/// Where a ray in the plane of a vertex crosses the axis, from that vertex.
double axis_crossing(ParaxialRay ray) {
    return -ray.height / ray.slope;
}

}  // namespace

ParaxialRay trace_paraxial(const TraceLens<double>& lens, ParaxialRay ray, int first, int last) {
    const int step = first <= last ? 1 : -1;
    for (int i = first;; i += step) {
        const TraceSurface<double>& surface = lens.surfaces[i];
        ray = step > 0 ? refracted(ray, surface) : refracted_backwards(ray, surface);
        if (i == last) {
            return ray;
        }
        ray.height += ray.slope * (lens.surfaces[i + step].vertex_z - surface.vertex_z);
    }
}

ParaxialData paraxial_data(const TraceLens<double>& lens) {
    const int last = static_cast<int>(lens.surfaces.size()) - 1;
    const int stop = find_stop(lens);
    const ParaxialRay rear = trace_paraxial(lens, {1.0, 0.0}, 0, last);
    // A ray that leaves parallel to the axis, followed backwards: it crosses the axis at the front focal point.
    ParaxialRay front{1.0, 0.0};
    for (int i = last; i >= 0; --i) {
        front = refracted_backwards(front, lens.surfaces[i]);
        if (i > 0) {
            front.height -= front.slope * (lens.surfaces[i].vertex_z - lens.surfaces[i - 1].vertex_z);
        }
    }

    ParaxialData data;
    data.efl = -1.0 / rear.slope;
    data.bfl = axis_crossing(rear);
    data.ffl = axis_crossing(front);

    // Pupils: the stop's centre and edge imaged through what lies before and behind it. Its own index does not change.
    const ParaxialRay chief{0.0, 1.0};
    const ParaxialRay edge{
        lens.surfaces[stop].semi_diameter_squared > 0.0 ? std::sqrt(lens.surfaces[stop].semi_diameter_squared) : 0.0,
        0.0};
    const auto pupil = [](ParaxialRay centre_ray, ParaxialRay edge_ray, double& z, double& diameter) {
        z = axis_crossing(centre_ray);
        diameter = 2.0 * std::abs(edge_ray.height + edge_ray.slope * z);
    };
    pupil(trace_paraxial(lens, chief, stop, 0), trace_paraxial(lens, edge, stop, 0), data.entrance_pupil_z,
          data.entrance_pupil_diameter);
    pupil(trace_paraxial(lens, chief, stop, last), trace_paraxial(lens, edge, stop, last), data.exit_pupil_z,
          data.exit_pupil_diameter);
    data.f_number = data.efl / data.entrance_pupil_diameter;
    return data;
}

double paraxial_image_distance(const TraceLens<double>& lens, double object_distance) {
    const int last = static_cast<int>(lens.surfaces.size()) - 1;
    const ParaxialRay marginal =
        std::isinf(object_distance) ? ParaxialRay{1.0, 0.0} : ParaxialRay{1.0, 1.0 / object_distance};
    return axis_crossing(trace_paraxial(lens, marginal, 0, last));
}

}  // namespace lensproof
