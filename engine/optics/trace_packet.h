// engine/optics/trace_packet.h — several rays in step through a lens, each with its own fate.
#pragma once
#include <array>

#include "engine/optics/pack.h"
#include "engine/optics/trace.h"

namespace lensproof {

/// N rays after the last surface that each reached; the fields mean what those of TracedRay do.
template <class Scalar, int N>
struct TracedPacket {
    Ray<Pack<Scalar, N>> ray;
    Pack<Scalar, N> optical_path;
    Pack<Scalar, N> transmittance;
    std::array<RayStatus, N> status{};
    std::array<int, N> surface{};

    [[nodiscard]] TracedRay<Scalar> lane(int i) const {
        const auto vector = [i](const Vec3<Pack<Scalar, N>>& v) { return Vec3<Scalar>{v.x[i], v.y[i], v.z[i]}; };
        const auto at = static_cast<std::size_t>(i);
        return {.ray = {vector(ray.origin), vector(ray.direction)},
                .optical_path = optical_path[i],
                .transmittance = transmittance[i],
                .status = status[at],
                .surface = surface[at]};
    }
};

/// Puts a ray into a lane of a packet.
template <class Scalar, int N>
void set_lane(Ray<Pack<Scalar, N>>& rays, int lane, const Ray<Scalar>& ray) {
    const auto set = [lane](Vec3<Pack<Scalar, N>>& to, const Vec3<Scalar>& from) {
        to.x.set(lane, from.x);
        to.y.set(lane, from.y);
        to.z.set(lane, from.z);
    };
    set(rays.origin, ray.origin);
    set(rays.direction, ray.direction);
}

/// The rays of a packet one after the other: what `trace_packet` does for a lens that has more than centred spheres.
template <Direction direction, Rims rims, class Scalar, int N, class Visitor>
TracedPacket<Scalar, N> trace_lanes(const TraceLens<Scalar>& lens, const Ray<Pack<Scalar, N>>& rays, Visitor&& visit) {
    TracedPacket<Scalar, N> traced{.ray = rays, .optical_path = {}, .transmittance = {}};
    for (int lane = 0; lane < N; ++lane) {
        const TracedRay<Scalar> one = trace<direction, rims>(
            lens, traced.lane(lane).ray, [&](const SurfaceEvent<Scalar>& event) { visit(lane, event); });
        set_lane(traced.ray, lane, one.ray);
        traced.optical_path.set(lane, one.optical_path);
        traced.transmittance.set(lane, one.transmittance);
        traced.status[static_cast<std::size_t>(lane)] = one.status;
        traced.surface[static_cast<std::size_t>(lane)] = one.surface;
    }
    return traced;
}

/// `trace` for a packet of rays: the same geometry on N lanes at once. A lane that ends keeps what it had, while the
/// others go on. Of centred, bare spheres each lane has the bits of the scalar `trace`; a lens with any other surface
/// is traced lane by lane, by the scalar itself.
///
/// `visit(int lane, const SurfaceEvent<Scalar>&)` is called for each lane and surface as in `trace`.
template <Direction direction = Direction::forward, Rims rims = Rims::clip, class Scalar, int N, class Visitor>
TracedPacket<Scalar, N> trace_packet(const TraceLens<Scalar>& lens, const Ray<Pack<Scalar, N>>& rays, Visitor&& visit) {
    if (!lens.specials.empty()) {
        return trace_lanes<direction, rims>(lens, rays, visit);
    }
    using Numbers = Pack<Scalar, N>;
    using Mask = PackMask<Scalar, N>;
    constexpr bool kForward = direction == Direction::forward;
    TracedPacket<Scalar, N> traced{.ray = rays, .optical_path = Numbers(0), .transmittance = Numbers(1)};
    const int count = static_cast<int>(lens.surfaces.size());
    traced.surface.fill(kForward ? count - 1 : 0);
    // The first thing that happens to a lane is its status; what ends it in spite of that (Rims::follow) comes after.
    const auto mark = [&](const Mask& lanes, RayStatus status, int surface, bool only_first) {
        for (int lane = 0; any(lanes) && lane < N; ++lane) {
            const auto at = static_cast<std::size_t>(lane);
            if (lanes[lane] && !(only_first && traced.status[at] != RayStatus::ok)) {
                traced.status[at] = status;
                traced.surface[at] = surface;
            }
        }
    };
    const auto report = [&](const Mask& lanes, int index) {
        for (int lane = 0; lane < N; ++lane) {
            if (lanes[lane]) {
                const TracedRay<Scalar> at = traced.lane(lane);
                const RayStatus here = at.surface == index ? at.status : RayStatus::ok;
                visit(lane, SurfaceEvent<Scalar>{index, at.ray, at.optical_path, at.transmittance, here});
            }
        }
    };
    const Numbers heading(kForward ? Scalar(1) : Scalar(-1));
    Mask going(true);
    for (int step = 0; step < count && any(going); ++step) {
        const int index = kForward ? step : count - 1 - step;
        const TraceSurface<Scalar>& surface = lens.surfaces[static_cast<std::size_t>(index)];
        const Numbers index_before(kForward ? surface.index_before : surface.index_after);
        const Numbers index_after(kForward ? surface.index_after : surface.index_before);
        const Numbers ratio(kForward ? surface.forward_ratio : surface.reverse_ratio);
        const Numbers c(surface.curvature);
        const Numbers vertex_z(surface.vertex_z);

        Vec3<Numbers>& origin = traced.ray.origin;
        Vec3<Numbers>& way = traced.ray.direction;
        const Mask reached = going;
        const Intersection<Numbers> meeting = intersect({origin.x, origin.y, origin.z - vertex_z}, way, c, heading);
        const Vec3<Numbers>& point = meeting.point;
        mark(going && !meeting.hit, RayStatus::missed, index, false);
        going = going && meeting.hit;
        traced.optical_path = select(going, traced.optical_path + index_before * meeting.distance, traced.optical_path);
        origin = select(going, Vec3<Numbers>{point.x, point.y, point.z + vertex_z}, origin);

        const Mask closed(!(surface.semi_diameter_squared > Scalar(0)));
        const Mask outside = point.x * point.x + point.y * point.y > Numbers(surface.semi_diameter_squared);
        const Mask beyond = going && (outside || closed);
        mark(beyond, surface.is_stop ? RayStatus::stopped : RayStatus::clipped, index, true);
        if (rims == Rims::clip) {
            going = going && !beyond;
        }

        const Vec3<Numbers> normal = heading * Vec3<Numbers>{-c * point.x, -c * point.y, Numbers(1) - c * point.z};
        const Refraction<Numbers> bent = refract(way, normal, meeting.cos_incidence, meeting.sin2_incidence, ratio);
        mark(going && !bent.transmitted, RayStatus::total_internal_reflection, index, false);
        going = going && bent.transmitted;
        way = select(going, bent.direction, way);
        const Numbers passing =
            fresnel_transmittance(index_before, index_after, meeting.cos_incidence, bent.cos_refraction);
        traced.transmittance = select(going, traced.transmittance * passing, traced.transmittance);
        report(reached, index);
    }
    return traced;
}

template <Direction direction = Direction::forward, Rims rims = Rims::clip, class Scalar, int N>
TracedPacket<Scalar, N> trace_packet(const TraceLens<Scalar>& lens, const Ray<Pack<Scalar, N>>& rays) {
    return trace_packet<direction, rims>(lens, rays, [](int, const SurfaceEvent<Scalar>&) {});
}

}  // namespace lensproof
