#include "engine/optics/polarised_ghost.h"

#include "engine/optics/polarisation.h"
#include "engine/optics/surface_axes.h"

namespace lensproof::optics {

namespace {

// A mirror that leaves both polarisations as they are, but for the half wave between them that metals make.
const TraceCoating<double> kMirror{.layers = {}, .reflectance = 1.0};
constexpr double kMetal = 1e3;

}  // namespace

double polarisation_factor(const TraceLens<double>& lens, const GhostPath& path, const Ray<double>& ray,
                           const StrayMirrors<double>& mirrors) {
    PolarisedPath<double> polarised(ray.direction);
    double averaged = 1.0;
    auto next = path.begin();
    bool forward = true;
    const auto carry = [&](const SurfaceEvent<double>& event) {
        const bool reflects = next != path.end() && *next == event.surface;
        const bool came_forward = forward;
        if (reflects) {
            ++next;
            forward = !forward;
        }
        if (event.status != RayStatus::ok) {
            return;
        }
        if (event.surface == static_cast<int>(lens.surfaces.size())) {
            polarised.reflect(kMirror, 1.0, kMetal, true, {0.0, 0.0, 1.0});
            return;
        }
        const TraceSurface<double>& surface = lens.surfaces[static_cast<std::size_t>(event.surface)];
        const SpecialSurface<double>* special = special_of(lens, surface);
        const Vec3d before = special != nullptr ? special->to_own(polarised.direction()) : polarised.direction();
        const auto [meeting, own_normal] = intersect(
            shape_of(lens, surface), to_own_axes(lens, surface, event.ray.origin), before, came_forward ? 1.0 : -1.0);
        const Vec3d normal = special != nullptr ? special->from_own(own_normal) : own_normal;
        if (reflects && reflects_by_blades(surface)) {
            polarised.reflect(kMirror, 1.0, kMetal, true, normal);
            return;
        }
        const TraceCoating<double> coating = special != nullptr ? special->coating : TraceCoating<double>{};
        const CoatedPowers<double> powers =
            coating_powers(coating, surface.index_before, surface.index_after, dot(before, own_normal), came_forward)
                .unpolarised();
        averaged *= reflects ? powers.reflected : powers.transmitted;
        if (reflects) {
            polarised.reflect(coating, surface.index_before, surface.index_after, came_forward, normal);
        } else {
            polarised.refract(coating, surface.index_before, surface.index_after, came_forward, normal,
                              event.ray.direction);
        }
    };
    const TracedRay<double> traced = trace_ghost(lens, path, ray, mirrors, carry);
    return traced.status == RayStatus::ok && averaged > 0.0 ? polarised.transmittance() / averaged : 1.0;
}

}  // namespace lensproof::optics
