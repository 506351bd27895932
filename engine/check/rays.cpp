#include "engine/check/rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/bisect.h"
#include "engine/base/infinity.h"

namespace lensproof::check {

namespace {

constexpr int kSteps = 200;           // across the beam, in search of its edge
constexpr int kEdgeHalvings = 50;     // of a step
constexpr double kBackwards = -1e-9;  // mm: further back than rounding goes

/// From the object to the first vertex of a surface that changes light: files put planes of air before it.
double distance_to_lens(const CheckedLens& checked) {
    double distance = checked.prescription.object_distance_mm;
    for (int i = 0; i < checked.leading_dummies(); ++i) {
        distance += checked.row(i).thickness_mm;
    }
    return distance;
}

/// From the axial object point, through `at` in the plane of the first vertex.
Ray<double> axial_ray(const CheckedLens& checked, const Vec2d& at) {
    if (std::isinf(checked.prescription.object_distance_mm)) {
        return {{at.x, at.y, 0.0}, {0.0, 0.0, 1.0}};
    }
    return {{0.0, 0.0, -checked.prescription.object_distance_mm},
            normalized(Vec3d{at.x, at.y, distance_to_lens(checked)})};
}

/// The same, in the plane that a cut shows.
Ray<double> axial_ray(const CheckedLens& checked, double h) {
    return axial_ray(checked, {0.0, h});
}

AxialBeam beam_through(const CheckedLens& checked, const optics::TraceLens<double>& lens) {
    AxialBeam beam;
    const double front = checked.semi_diameters[static_cast<std::size_t>(checked.leading_dummies())];
    const double widest = 1.5 * std::max(front, paraxial_beam(checked).height);
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
    const double object = checked.prescription.object_distance_mm;
    const double distance = distance_to_lens(checked);
    const optics::ParaxialRay any =
        std::isinf(object) ? optics::ParaxialRay{1.0, 0.0} : optics::ParaxialRay{object / distance, 1.0 / distance};
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

namespace {

/// No surface is shifted or tilted; toroids may be among them.
bool is_centred(const optics::Prescription& prescription) {
    const auto is_aligned = [](const auto& part) { return part.misalignment == optics::Misalignment{}; };
    return std::ranges::all_of(prescription.surfaces, is_aligned) &&
           std::ranges::all_of(prescription.groups, is_aligned);
}

/// Of the lens at one of its wavelengths; one azimuth says all where the lens is symmetric about its axis.
AxialSpread axial_spread(const CheckedLens& checked, const optics::TraceLens<double>& lens, double beam_height) {
    constexpr int kRays = 32;
    const int azimuths = checked.prescription.is_rotationally_symmetric() ? 1 : 12;
    AxialSpread sums;
    double weights = 0.0;
    for (int k = 0; k < kRays; ++k) {
        const double h = beam_height * (k + 0.5) / kRays;
        for (int j = 0; j < azimuths; ++j) {
            const double azimuth = azimuths == 1 ? 0.5 * kPi : 0.5 * kPi * (j + 0.5) / azimuths;
            const RayFate fate = follow(lens, axial_ray(checked, {h * std::cos(azimuth), h * std::sin(azimuth)}));
            if (!fate.passes()) {
                continue;
            }
            const Vec3d& d = fate.ray.direction;
            const Vec2d t{d.x / d.z, d.y / d.z};
            const double back = fate.ray.origin.z - checked.lens->last_vertex_z();
            const Vec2d at{fate.ray.origin.x - t.x * back, fate.ray.origin.y - t.y * back};
            sums.yy += h * (at.x * at.x + at.y * at.y);
            sums.yt += h * (at.x * t.x + at.y * t.y);
            sums.tt += h * (t.x * t.x + t.y * t.y);
            weights += h;
        }
    }
    const double mean = weights > 0.0 ? 1.0 / weights : 0.0;
    return {mean * sums.yy, mean * sums.yt, mean * sums.tt};
}

/// Where the ray of that height crosses the axis, mm behind the last vertex.
std::optional<double> axis_crossing(const CheckedLens& checked, double height) {
    const RayFate fate = follow(*checked.traced, axial_ray(checked, height));
    const double slope = fate.ray.direction.y / fate.ray.direction.z;
    return fate.passes() && slope != 0.0
               ? std::optional(fate.ray.origin.z - fate.ray.origin.y / slope - checked.lens->last_vertex_z())
               : std::nullopt;
}

}  // namespace

AxialSpread axial_spread(const CheckedLens& checked, double beam_height) {
    return axial_spread(checked, *checked.traced, beam_height);
}

bool stands_at_best_focus(const CheckedLens& checked) {
    if (!checked.traced || !checked.focus || !is_centred(checked.prescription) || checked.collimates()) {
        return false;
    }
    const double last = checked.row(checked.size() - 1).thickness_mm;
    const double image = checked.focus->image_distance;
    constexpr double kSamePlace = 1e-3;  // of the focal length
    if (!(last * image > 0.0) || std::abs(last - image) < kSamePlace * std::abs(checked.focus->efl)) {
        return false;
    }
    const AxialBeam beam = axial_beam(checked);
    if (beam.height <= 0.0) {
        return false;
    }
    const auto is_there = [&](const AxialSpread& spread) {
        constexpr double kNear = 0.1;
        const double best = spread.best_z();
        return spread.tt > 0.0 && std::abs(last - best) <= kNear * std::abs(image - best);
    };
    constexpr double kAtEdge = 0.02;
    const std::optional<double> edge = axis_crossing(checked, beam.height);
    if (is_there(axial_spread(checked, beam.height)) ||
        (edge && std::abs(last - *edge) <= kAtEdge * std::abs(image - *edge))) {
        return true;
    }
    AxialSpread all;
    for (const double wavelength : checked.prescription.wavelengths_nm) {
        const bool is_known = std::ranges::all_of(
            checked.lens->surfaces, [&](const auto& surface) { return optics::covers(surface.medium, wavelength); });
        if (is_known) {
            const AxialSpread own =
                axial_spread(checked, optics::at_wavelength<double>(*checked.lens, wavelength), beam.height);
            all = {all.yy + own.yy, all.yt + own.yt, all.tt + own.tt};
        }
    }
    return is_there(all);
}

}  // namespace lensproof::check
