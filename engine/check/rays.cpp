#include "engine/check/rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/bisect.h"
#include "engine/base/infinity.h"

namespace lensproof::check {

namespace {

constexpr int kSteps = 200;           // across the beam, in search of its edge
constexpr int kEdgeHalvings = 50;     // of a step
constexpr double kBackwards = -1e-9;  // mm: further back than rounding goes

/// From the axial object point, through height `h` in the plane of the first vertex.
Ray<double> axial_ray(const CheckedLens& checked, double h) {
    const double distance = checked.prescription.object_distance_mm;
    if (std::isinf(distance)) {
        return {{0.0, h, 0.0}, {0.0, 0.0, 1.0}};
    }
    return {{0.0, 0.0, -distance}, normalized(Vec3d{0.0, h, distance})};
}

AxialBeam beam_through(const CheckedLens& checked, const optics::TraceLens<double>& lens) {
    AxialBeam beam;
    const double widest = 1.5 * std::max(checked.semi_diameters.front(), paraxial_beam(checked).height);
    if (!std::isfinite(widest)) {
        return beam;
    }
    const auto passes = [&](double h) { return follow(lens, axial_ray(checked, h)).passes(); };
    Bracket edge{.inside = 0.0, .outside = widest};
    for (int step = 0; step <= kSteps; ++step) {
        // Not on the axis itself, where a ray meets no slope.
        const double h = widest * std::max(1e-3, static_cast<double>(step)) / kSteps;
        if (!passes(h)) {
            edge.outside = h;
            break;
        }
        edge.inside = h;
    }
    edge = bisected(edge, edge.inside > 0.0 ? kEdgeHalvings : 0, passes);
    beam.height = edge.inside;
    beam.limit = follow(lens, axial_ray(checked, edge.outside));
    const Vec3d outermost = follow(lens, axial_ray(checked, edge.inside)).ray.direction;
    beam.exit_sine = std::hypot(outermost.x, outermost.y);
    return beam;
}

}  // namespace

RayFate follow(const optics::TraceLens<double>& lens, const Ray<double>& ray, optics::Rims rims) {
    RayFate fate;
    Ray<double> before = ray;
    bool is_first = true;
    const auto visit = [&](const optics::SurfaceEvent<double>& event) {
        if (event.status == optics::RayStatus::missed) {
            return;
        }
        const optics::TraceSurface<double>& surface = lens.surfaces[event.surface];
        if (surface.index_before == surface.index_after) {
            return;  // it bends no ray, so it does not matter on which side of a neighbour the ray meets it
        }
        const Vec3d step = event.ray.origin - before.origin;
        const double heading = std::copysign(1.0, surface.index_before);
        if (!is_first && !fate.is_backwards && heading * dot(step, before.direction) < kBackwards) {
            fate.is_backwards = true;
            fate.surface = event.surface;
        }
        is_first = false;
        if (event.status == optics::RayStatus::ok) {
            // From the bend: n' d' − n d = Γ N, with Γ = n' cos i' − n cos i.
            const Vec3d bend = surface.index_after * event.ray.direction - surface.index_before * before.direction;
            const double bent = length(bend);
            if (bent > 0.0) {
                const double cosine = std::min(1.0, std::abs(dot(before.direction, (1.0 / bent) * bend)));
                const double cosine_after = std::min(1.0, std::abs(dot(event.ray.direction, (1.0 / bent) * bend)));
                const double incidence = std::acos(std::min(cosine, cosine_after));  // in the thinner medium
                if (incidence > fate.largest_incidence) {
                    fate.largest_incidence = incidence;
                    fate.steepest_surface = event.surface;
                }
            }
        }
        before = event.ray;
    };
    const optics::TracedRay<double> traced =
        rims == optics::Rims::clip ? optics::trace<optics::Direction::forward, optics::Rims::clip>(lens, ray, visit)
                                   : optics::trace<optics::Direction::forward, optics::Rims::follow>(lens, ray, visit);
    fate.status = traced.status;
    if (traced.status != optics::RayStatus::ok) {
        fate.surface = fate.is_backwards ? fate.surface : traced.surface;
    } else if (!fate.is_backwards && !(traced.ray.direction.z > 0.0)) {
        fate.is_backwards = true;
        fate.surface = static_cast<int>(lens.surfaces.size()) - 1;
    }
    fate.ray = traced.ray;
    return fate;
}

std::string words(const RayFate& fate) {
    const int surface = fate.surface + 1;
    if (fate.is_backwards) {
        return fmt::format("it would have to run backwards to meet surface {}", surface);
    }
    switch (fate.status) {
        case optics::RayStatus::missed:
            return fmt::format("it misses surface {}", surface);
        case optics::RayStatus::total_internal_reflection:
            return fmt::format("surface {} reflects it totally", surface);
        case optics::RayStatus::clipped:
            return fmt::format("the rim of surface {} cuts it off", surface);
        case optics::RayStatus::stopped:
            return fmt::format("the stop, surface {}, holds it back", surface);
        case optics::RayStatus::evanescent:
            return fmt::format("surface {} has no such order at this angle", surface);
        case optics::RayStatus::ok:
            break;
    }
    return "it passes";
}

optics::TraceLens<double> without_rims(const CheckedLens& checked, bool keep_stop) {
    optics::TraceLens<double> lens = *checked.traced;
    for (optics::TraceSurface<double>& surface : lens.surfaces) {
        if (!(keep_stop && surface.is_stop)) {
            surface.semi_diameter_squared = kInfinity;
        }
    }
    return lens;
}

ParaxialBeam paraxial_beam(const CheckedLens& checked) {
    const optics::TraceLens<double>& lens = *checked.traced;
    const int stop = checked.lens->stop_index();
    const double distance = checked.prescription.object_distance_mm;
    const optics::ParaxialRay any{1.0, std::isinf(distance) ? 0.0 : 1.0 / distance};
    const double at_stop = optics::trace_paraxial(lens, any, 0, stop).height;
    const double behind = optics::trace_paraxial(lens, any, 0, checked.size() - 1).slope;
    const double height = std::abs(std::sqrt(lens.surfaces[stop].semi_diameter_squared) / at_stop);
    return {.height = height, .f_number = 0.5 / std::abs(height * behind)};
}

AxialBeam axial_beam(const CheckedLens& checked) {
    return beam_through(checked, *checked.traced);
}

AxialBeam stop_limited_beam(const CheckedLens& checked) {
    return beam_through(checked, without_rims(checked, true));
}

double AxialSpread::at(double z) const {
    return std::sqrt(std::max(0.0, yy + z * (2.0 * yt + z * tt)));
}

AxialSpread axial_spread(const CheckedLens& checked, double beam_height) {
    constexpr int kRays = 32;
    AxialSpread sums;
    double weights = 0.0;
    for (int k = 0; k < kRays; ++k) {
        const double h = beam_height * (k + 0.5) / kRays;
        const RayFate fate = follow(*checked.traced, axial_ray(checked, h));
        if (!fate.passes()) {
            continue;
        }
        const double t = fate.ray.direction.y / fate.ray.direction.z;
        const double y = fate.ray.origin.y - t * (fate.ray.origin.z - checked.lens->last_vertex_z());
        sums.yy += h * y * y;
        sums.yt += h * y * t;
        sums.tt += h * t * t;
        weights += h;
    }
    const double mean = weights > 0.0 ? 1.0 / weights : 0.0;
    return {mean * sums.yy, mean * sums.yt, mean * sums.tt};
}

}  // namespace lensproof::check
