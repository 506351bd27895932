// engine/optics/packet/trace_kernel.h — the packet tracer's inner loop, compiled once for each width of packets.
//
// Only the files trace_kernel_*.cpp include this. Each is compiled for its own instructions, so what it defines must
// not be shared with code for other machines: everything here is a template over the packs' Abi, and inlined.
#pragma once
#include <array>

#include "engine/optics/intersect.h"
#include "engine/optics/pack.h"
#include "engine/optics/packet/trace_kernels.h"
#include "engine/optics/refract.h"

namespace lensproof {

/// Lane by lane, `a` where `mask` holds, else `b`.
template <class Scalar, class Abi>
Vec3<Pack<Scalar, Abi>> select(const PackMask<Scalar, Abi>& mask, const Vec3<Pack<Scalar, Abi>>& a,
                               const Vec3<Pack<Scalar, Abi>>& b) {
    return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

/// A block of rays on its way through a lens. It walks surface by surface, each surface packet by packet: the packets
/// are independent of each other, so that the processor works at several at once while one waits for its root.
template <class Scalar, class Abi, Direction direction, Carry carry>
class BlockTracer {
  public:
    static constexpr int kBlock = 128;  // rays; their columns stay in the first-level cache

    BlockTracer(const KernelLens<Scalar>& lens, const KernelRays<Scalar>& rays, bool clip, int first)
        : lens_(lens), rays_(rays), clip_(clip), first_(first) {}

    void trace() {
        const int count = rays_.size - first_ < kBlock ? rays_.size - first_ : kBlock;
        packets_ = (count + kLanes - 1) / kLanes;
        for (int packet = 0; packet < packets_; ++packet) {
            const Numbers lane = Numbers::iota() + Numbers(static_cast<Scalar>(packet * kLanes));
            going_[packet] = lane < Numbers(static_cast<Scalar>(count));
            if constexpr (carry != Carry::geometry) {
                Numbers(Scalar(1)).store(rays_.transmittance + at(packet));
            }
            if constexpr (carry == Carry::all) {
                Numbers(Scalar(0)).store(rays_.optical_path + at(packet));
            }
        }
        for (int i = first_; i < first_ + count; ++i) {
            rays_.status[i] = RayStatus::ok;
            rays_.surface[i] = static_cast<std::int16_t>(kForward ? lens_.count - 1 : 0);
        }
        for (int step = 0; step < lens_.count; ++step) {
            pass(kForward ? step : lens_.count - 1 - step);
        }
        for (int packet = 0; packet < packets_; ++packet) {
            to_global(packet, going_[packet]);
        }
    }

  private:
    using Numbers = Pack<Scalar, Abi>;
    using Mask = PackMask<Scalar, Abi>;
    static constexpr int kLanes = Numbers::kLanes;
    static constexpr bool kForward = direction == Direction::forward;

    struct State {
        Vec3<Numbers> origin;  // z from the last vertex passed
        Vec3<Numbers> way;
    };

    /// A surface's numbers for a packet of rays.
    struct Media {
        Numbers ratio;
        Numbers before;
        Numbers after;
    };

    [[nodiscard]] int at(int packet) const { return first_ + packet * kLanes; }

    [[nodiscard]] State load(int packet) const {
        const int i = at(packet);
        return {{Numbers::load(rays_.x + i), Numbers::load(rays_.y + i), Numbers::load(rays_.z + i)},
                {Numbers::load(rays_.dx + i), Numbers::load(rays_.dy + i), Numbers::load(rays_.dz + i)}};
    }

    void store(int packet, const State& state) const {
        const int i = at(packet);
        state.origin.x.store(rays_.x + i);
        state.origin.y.store(rays_.y + i);
        state.origin.z.store(rays_.z + i);
        state.way.x.store(rays_.dx + i);
        state.way.y.store(rays_.dy + i);
        state.way.z.store(rays_.dz + i);
    }

    /// Turns the lanes' z from the last vertex passed into that of lens space.
    void to_global(int packet, const Mask& lanes) const {
        Scalar* z = rays_.z + at(packet);
        const Numbers own = Numbers::load(z);
        select(lanes, own + Numbers(last_vertex_z_), own).store(z);
    }

    [[nodiscard]] Media media(int surface, int packet) const {
        const auto& of = lens_.indices[surface];
        const auto look_up = [&](const Scalar* table) {
            return lens_.is_monochromatic ? Numbers(*table) : Numbers::gather(table, rays_.wavelength + at(packet));
        };
        Media found{.ratio = look_up(kForward ? of.forward_ratio : of.reverse_ratio), .before = {}, .after = {}};
        if constexpr (carry != Carry::geometry) {
            found.before = look_up(kForward ? of.before : of.after);
            found.after = look_up(kForward ? of.after : of.before);
        }
        return found;
    }

    void pass(int index) {
        const TraceSurface<Scalar>& surface = lens_.surfaces[index];
        const Scalar from_last_vertex = surface.vertex_z - last_vertex_z_;
        const bool from_far = !clip_ || (kForward ? surface.from_far_forward : surface.from_far_reverse);
        for (int packet = 0; packet < packets_; ++packet) {
            if (any(going_[packet])) {
                pass(surface, index, packet, from_last_vertex, from_far);
            }
        }
        last_vertex_z_ = surface.vertex_z;
    }

    /// One packet through one surface, as `trace_through` takes one ray.
    void pass(const TraceSurface<Scalar>& surface, int index, int packet, Scalar from_last_vertex, bool from_far) {
        const Numbers heading(kForward ? Scalar(1) : Scalar(-1));
        const Numbers c(surface.curvature);
        const Mask going = going_[packet];
        const State before = load(packet);
        Vec3<Numbers> from_vertex = before.origin;
        from_vertex.z = from_vertex.z - Numbers(from_last_vertex);
        Numbers to_vertex(Scalar(0));
        if (from_far) {
            to_vertex = way_to_vertex(from_vertex, before.way);
            from_vertex = from_vertex + to_vertex * before.way;
        }
        const Intersection<Numbers> meeting = intersect_from_near(from_vertex, before.way, c, heading);
        const Vec3<Numbers>& point = meeting.point;
        const Numbers limit(surface.semi_diameter_squared);
        const Mask beyond = point.x * point.x + point.y * point.y > limit || !(limit > Numbers(Scalar(0)));
        const Media media = this->media(index, packet);
        const Refraction<Numbers> bent = refract_at_sphere(before.way, point, c, heading, meeting.cos_incidence,
                                                           meeting.sin2_incidence, media.ratio);
        const Mask ends_here = !meeting.hit || !bent.transmitted || (clip_ ? beyond : Mask(false));
        if (any(going && (ends_here || beyond))) {
            note_ends(index, packet, before, meeting.hit, beyond, bent.transmitted, point, surface.is_stop);
        }
        const Mask on = going && !ends_here;
        going_[packet] = on;
        State after{point, bent.direction};
        if (!all(on)) {
            const State kept = load(packet);
            after = {select(on, after.origin, kept.origin), select(on, after.way, kept.way)};
        }
        store(packet, after);
        carry_on(packet, media, meeting, to_vertex, bent, going && meeting.hit, on);
    }

    /// What the rays carry besides: the optical path of those that met the surface, the losses of those that go on.
    void carry_on(int packet, const Media& media, const Intersection<Numbers>& meeting, const Numbers& to_vertex,
                  const Refraction<Numbers>& bent, const Mask& met, const Mask& on) const {
        if constexpr (carry == Carry::all) {
            Scalar* path = rays_.optical_path + at(packet);
            const Numbers so_far = Numbers::load(path);
            select(met, so_far + media.before * (to_vertex + meeting.distance), so_far).store(path);
        }
        if constexpr (carry != Carry::geometry) {
            Scalar* share = rays_.transmittance + at(packet);
            const Numbers so_far = Numbers::load(share);
            const Numbers passing =
                fresnel_transmittance(media.before, media.after, meeting.cos_incidence, bent.cos_refraction);
            select(on, so_far * passing, so_far).store(share);
        }
    }

    /// The fate of rays that end here or pass a rim, and the last points of those that end.
    void note_ends(int index, int packet, const State& before, const Mask& hit, const Mask& beyond,
                   const Mask& transmitted, const Vec3<Numbers>& point, bool is_stop) const {
        const Mask going = going_[packet];
        const auto mark = [&](const Mask& lanes, RayStatus status, bool only_first) {
            for (int lane = 0; lane < kLanes; ++lane) {
                const int i = at(packet) + lane;
                if (lanes[lane] && !(only_first && rays_.status[i] != RayStatus::ok)) {
                    rays_.status[i] = status;
                    rays_.surface[i] = static_cast<std::int16_t>(index);
                }
            }
        };
        mark(going && !hit, RayStatus::missed, false);
        mark(going && hit && beyond, is_stop ? RayStatus::stopped : RayStatus::clipped, true);
        const Mask inside = clip_ ? !beyond : Mask(true);
        mark(going && hit && inside && !transmitted, RayStatus::total_internal_reflection, false);
        // A ray that missed stays where it was, the others that end are on the surface; both in lens space.
        const Mask missed = going && !hit;
        const Mask ends = going && (!hit || !inside || !transmitted);
        const Scalar vertex_z = lens_.surfaces[index].vertex_z;
        Vec3<Numbers> last = select(missed, before.origin, point);
        last.z = last.z + select(missed, Numbers(last_vertex_z_), Numbers(vertex_z));
        store(packet, {select(ends, last, before.origin), before.way});
    }

    KernelLens<Scalar> lens_;
    KernelRays<Scalar> rays_;
    bool clip_;
    int first_;
    int packets_ = 0;
    Scalar last_vertex_z_ = Scalar(0);
    std::array<Mask, kBlock / kLanes> going_;
};

template <class Scalar, class Abi, Direction direction, Carry carry>
[[gnu::flatten]] void trace_blocks(const KernelLens<Scalar>& lens, const KernelRays<Scalar>& rays, bool clip) {
    using Tracer = BlockTracer<Scalar, Abi, direction, carry>;
    for (int first = 0; first < rays.size; first += Tracer::kBlock) {
        Tracer(lens, rays, clip, first).trace();
    }
}

template <class Scalar, class Abi, Direction direction>
std::array<TraceKernel<Scalar>, 3> loops_by_carry() {
    return {trace_blocks<Scalar, Abi, direction, Carry::geometry>,
            trace_blocks<Scalar, Abi, direction, Carry::transmittance>,
            trace_blocks<Scalar, Abi, direction, Carry::all>};
}

template <class Scalar, class Abi>
TraceKernels<Scalar> kernels_of() {
    return {{loops_by_carry<Scalar, Abi, Direction::forward>(), loops_by_carry<Scalar, Abi, Direction::reverse>()}};
}

}  // namespace lensproof
