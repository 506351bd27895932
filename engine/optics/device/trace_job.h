// engine/optics/device/trace_job.h — given rays through a lens, an item a ray.
#pragma once
#include "engine/optics/device/lens_view.h"
#include "engine/optics/packet/ray_batch.h"
#include "engine/optics/packet/trace_batch.h"
#include "engine/optics/ray_course.h"

namespace lensproof::optics {

/// As `trace_columns`, from columns of the device's memory to others, or to the same; those that `carry` does not ask
/// for are not looked at.
template <class T, Direction direction, Rims rims, Carry carry, LensMakeup makeup>
struct TraceJob {
    static constexpr int kThreadsPerBlock = 128;

    LensView<T> lens;
    RayColumns<T> rays;
    RayColumns<T> to;

    constexpr void operator()(int item) const {
        const auto i = static_cast<std::size_t>(item);
        const Ray<T> ray{{rays.x[i], rays.y[i], rays.z[i]}, {rays.dx[i], rays.dy[i], rays.dz[i]}};
        const typename LensView<T>::AtWavelength at = lens.at(lens.wavelengths > 1 ? rays.wavelength[i] : 0);
        const TracedRay<T> traced = trace_through<direction, rims, makeup>(at, ray, [](const SurfaceEvent<T>&) {});
        to.x[i] = traced.ray.origin.x;
        to.y[i] = traced.ray.origin.y;
        to.z[i] = traced.ray.origin.z;
        to.dx[i] = traced.ray.direction.x;
        to.dy[i] = traced.ray.direction.y;
        to.dz[i] = traced.ray.direction.z;
        if constexpr (carry != Carry::geometry) {
            to.transmittance[i] = traced.transmittance;
        }
        if constexpr (carry == Carry::all) {
            to.optical_path[i] = traced.optical_path;
        }
        to.status[i] = traced.status;
        to.surface[i] = static_cast<std::int16_t>(traced.surface);
    }
};

/// The job that `carry` asks for, of those that are compiled: where more than geometry is carried, a lens of more than
/// clear spheres carries all, which is the least of its cost.
template <Direction direction, class T, class Use>
void with_trace_job(const LensView<T>& lens, const RayColumns<T>& rays, const RayColumns<T>& to, Rims rims, Carry carry,
                    const Use& use) {
    const auto with_rims = [&]<Rims with>() {
        const LensMakeup makeup = lens.makeup();
        if (makeup == LensMakeup::any) {
            use(TraceJob<T, direction, with, Carry::all, LensMakeup::any>{lens, rays, to});
        } else if (carry == Carry::geometry) {
            use(TraceJob<T, direction, with, Carry::geometry, LensMakeup::clear_spheres>{lens, rays, to});
        } else if (makeup == LensMakeup::spheres) {
            use(TraceJob<T, direction, with, Carry::all, LensMakeup::spheres>{lens, rays, to});
        } else if (carry == Carry::transmittance) {
            use(TraceJob<T, direction, with, Carry::transmittance, LensMakeup::clear_spheres>{lens, rays, to});
        } else {
            use(TraceJob<T, direction, with, Carry::all, LensMakeup::clear_spheres>{lens, rays, to});
        }
    };
    rims == Rims::clip ? with_rims.template operator()<Rims::clip>() : with_rims.template operator()<Rims::follow>();
}

/// What `trace_along` reports, event by event: of ray i those from i · `most_events` on.
template <class T>
struct EventJob {
    static constexpr int kThreadsPerBlock = 128;

    LensView<T> lens;
    RayCourse<T, std::span<const int>> course;
    const Ray<T>* rays = nullptr;
    const std::uint16_t* wavelength = nullptr;
    SurfaceEvent<T>* events = nullptr;
    std::int32_t* event_counts = nullptr;
    TracedRay<T>* ends = nullptr;
    int most_events = 0;

    constexpr void operator()(int item) const {
        const auto i = static_cast<std::size_t>(item);
        SurfaceEvent<T>* to = events + i * static_cast<std::size_t>(most_events);
        int count = 0;
        ends[i] = trace_along(lens.at(wavelength[i]), course, rays[i],
                              [&](const SurfaceEvent<T>& event) { to[count++] = event; });
        event_counts[i] = count;
    }
};

}  // namespace lensproof::optics
