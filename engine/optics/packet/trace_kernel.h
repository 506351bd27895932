// engine/optics/packet/trace_kernel.h — the packet tracer's inner loop, compiled once for each width of packets.
//
// Only a file for each level includes this (.ci/rooms.cmake), compiled for its own instructions, so what it
// defines must not be shared with code for other machines: everything here is a template over the packs' Abi, and
// inlined.
#pragma once
#include <array>
#include <tuple>

#include "engine/base/elementary.h"
#include "engine/base/pack.h"
#include "engine/optics/intersect.h"
#include "engine/optics/packet/coated_lanes.h"
#include "engine/optics/packet/media.h"
#include "engine/optics/packet/trace_kernels.h"
#include "engine/optics/refract.h"
#include "engine/optics/surface_shape.h"
#include "engine/optics/trace.h"

namespace lensproof::optics {

/// A block of rays through a lens. It walks surface by surface, each surface packet by packet: the packets
/// are independent of each other, so that the processor works at several at once while one waits for its root.
template <class Scalar, class Abi, Direction sense, Carry carry>
class BlockTracer {
  public:
    static constexpr int kBlock = 128;  // rays; their columns stay in the first-level cache

    BlockTracer(const KernelLens<Scalar>& lens, const RayColumns<Scalar>& rays, bool clip, int first)
        : lens_(lens), rays_(rays), clip_(clip), first_(first) {}

    void trace() {
        const int count = rays_.size - first_ < kBlock ? rays_.size - first_ : kBlock;
        packets_ = (count + kLanes - 1) / kLanes;
        for (int packet = 0; packet < packets_; ++packet) {
            start(packet, count);
        }
        for (int i = first_; i < first_ + count; ++i) {
            rays_.status[i] = RayStatus::ok;
            rays_.surface[i] = static_cast<std::int16_t>(kForward ? lens_.count - 1 : 0);
        }
        for (int step = 0; step < lens_.count; ++step) {
            pass(kForward ? step : lens_.count - 1 - step);
            if (carry != Carry::geometry && LeftBySurfaces<Scalar>::is_divided_after(step)) {
                divide();
            }
        }
        for (int packet = 0; packet < packets_; ++packet) {
            finish(packet, count);
        }
    }

  private:
    using Numbers = Pack<Scalar, Abi>;
    using Mask = PackMask<Scalar, Abi>;
    using Media = optics::Media<Numbers>;
    static constexpr int kLanes = Numbers::kLanes;
    static constexpr bool kForward = sense == Direction::forward;

    struct State {
        Vec3<Numbers> origin;  // z from the last vertex passed
        Vec3<Numbers> direction;
    };

    // As numbers, since g++ 12 copies a mask in pieces of 16 bytes, for which a load of all of it has to wait.
    [[nodiscard]] Mask going(int packet) const {
        return Numbers::load(going_.data() + packet * kLanes) > Numbers(Scalar(0));
    }
    void set_going(int packet, const Mask& lanes) {
        select(lanes, Numbers(Scalar(1)), Numbers(Scalar(0))).store(going_.data() + packet * kLanes);
    }

    [[nodiscard]] int at(int packet) const { return first_ + packet * kLanes; }

    [[nodiscard]] State load(int packet) const {
        const int i = packet * kLanes;
        return {{Numbers::load(x_.data() + i), Numbers::load(y_.data() + i), Numbers::load(z_.data() + i)},
                {Numbers::load(dx_.data() + i), Numbers::load(dy_.data() + i), Numbers::load(dz_.data() + i)}};
    }

    void store(int packet, const State& state) {
        const int i = packet * kLanes;
        state.origin.x.store(x_.data() + i);
        state.origin.y.store(y_.data() + i);
        state.origin.z.store(z_.data() + i);
        state.direction.x.store(dx_.data() + i);
        state.direction.y.store(dy_.data() + i);
        state.direction.z.store(dz_.data() + i);
    }

    void start(int packet, int count) {
        const int i = at(packet);
        store(packet, {{Numbers::load(rays_.x + i), Numbers::load(rays_.y + i), Numbers::load(rays_.z + i)},
                       {Numbers::load(rays_.dx + i), Numbers::load(rays_.dy + i), Numbers::load(rays_.dz + i)}});
        set_going(packet, is_ray(packet, count));
        Numbers(Scalar(1)).store(part_.data() + packet * kLanes);
        Numbers(Scalar(1)).store(whole_.data() + packet * kLanes);
        Numbers(Scalar(0)).store(path_.data() + packet * kLanes);
        Numbers(Scalar(0)).store(depth_.data() + packet * kLanes);
    }

    /// Back into the batch, in lens space; the lanes behind the last ray keep what the batch has there.
    void finish(int packet, int count) const {
        const int i = at(packet);
        State state = load(packet);
        state.origin.z = state.origin.z + select(going(packet), Numbers(last_vertex_z_), Numbers(Scalar(0)));
        const Mask rays = is_ray(packet, count);
        const auto put = [&](const Numbers& numbers, Scalar* column) {
            select(rays, numbers, Numbers::load(column + i)).store(column + i);
        };
        put(state.origin.x, rays_.x);
        put(state.origin.y, rays_.y);
        put(state.origin.z, rays_.z);
        put(state.direction.x, rays_.dx);
        put(state.direction.y, rays_.dy);
        put(state.direction.z, rays_.dz);
        if constexpr (carry != Carry::geometry) {
            put(transmittances(packet), rays_.transmittance);
        }
        if constexpr (carry == Carry::all) {
            put(Numbers::load(path_.data() + packet * kLanes), rays_.optical_path);
        }
    }

    [[nodiscard]] Numbers left_by_surfaces(int packet) const {
        return Numbers::load(part_.data() + packet * kLanes) / Numbers::load(whole_.data() + packet * kLanes);
    }

    /// As `LeftBySurfaces` is, after some surfaces.
    void divide() {
        for (int packet = 0; packet < packets_; ++packet) {
            left_by_surfaces(packet).store(part_.data() + packet * kLanes);
            Numbers(Scalar(1)).store(whole_.data() + packet * kLanes);
        }
    }

    /// What surfaces and media left of each ray.
    [[nodiscard]] Numbers transmittances(int packet) const {
        const Numbers at_surfaces = left_by_surfaces(packet);
        if (!lens_.absorbs) {
            return at_surfaces;
        }
        const Numbers depth = Numbers::load(depth_.data() + packet * kLanes);
        const Numbers of_thin = exponential_near_zero(-depth);
        return at_surfaces * Numbers::by_lane(!(abs(depth) < Numbers(kNearZero<Scalar>)), of_thin,
                                              [&](int lane) { return lane_fading(depth[lane]); });
    }

    static Mask is_ray(int packet, int count) {
        return Numbers::iota() + Numbers(static_cast<Scalar>(packet * kLanes)) < Numbers(static_cast<Scalar>(count));
    }

    template <bool per_lane>
    [[nodiscard]] ByWavelength<Numbers, per_lane> by_wavelength(int packet) const {
        if constexpr (per_lane) {
            return {rays_.wavelength + at(packet)};
        } else {
            return {};
        }
    }

    template <bool per_lane>
    [[nodiscard]] Media media(int surface, int packet) const {
        return Media::of(lens_.indices[surface].at, kForward, by_wavelength<per_lane>(packet));
    }

    /// Nothing but what bends the lanes.
    [[nodiscard]] Media ratio_of_media(int surface, int packet) const {
        const auto& of = lens_.indices[surface];
        return {.ratio = by_wavelength<true>(packet).number(kForward ? of.forward_ratios : of.reverse_ratios),
                .before = {},
                .after = {}};
    }

    /// What one surface is to every packet.
    struct Here {
        const TraceSurface<Scalar>& surface;
        int index;
        Scalar from_last_vertex;
        Scalar limit;  // of r²; below 0 where the surface is closed
    };

    void pass(int index) {
        const TraceSurface<Scalar>& surface = lens_.surfaces[index];
        const Scalar limit = surface.semi_diameter_squared;
        const Here here{.surface = surface,
                        .index = index,
                        .from_last_vertex = surface.vertex_z - last_vertex_z_,
                        .limit = limit > Scalar(0) ? limit : Scalar(-1)};
        const bool from_far = !clip_ || (kForward ? surface.from_far_forward : surface.from_far_reverse);
        if (surface.special >= 0 && !lens_.indices[index].is_coated_sphere) {
            lens_.is_monochromatic() ? pass_special<false>(here) : pass_special<true>(here);
        } else if (lens_.is_monochromatic()) {
            from_far ? pass_packets<true, false>(here) : pass_packets<false, false>(here);
        } else {
            from_far ? pass_packets<true, true>(here) : pass_packets<false, true>(here);
        }
        last_vertex_z_ = surface.vertex_z;
    }

    /// What a sphere is to light that goes on.
    enum class Sphere {
        opening,  // flat, between media of one index, as a stop is: nothing bends, and all that is inside passes
        bare,     // bends it, and takes what Fresnel's equations say
        coated,   // or its coating
    };

    template <bool from_far, bool per_lane>
    void pass_packets(const Here& here) {
        const auto& of = lens_.indices[here.index];
        if (carry != Carry::geometry && of.is_coated_sphere) {
            pass_coated<from_far, per_lane>(here);
        } else if (of.bends || here.surface.curvature != Scalar(0)) {
            pass_packets<from_far, per_lane, Sphere::bare>(here);
        } else {
            pass_packets<from_far, per_lane, Sphere::opening>(here);
        }
    }

    /// Kept apart, so that bare lenses keep their registers.
    template <bool from_far, bool per_lane>
    [[gnu::noinline, gnu::flatten]] void pass_coated(const Here& here) {
        pass_packets<from_far, per_lane, Sphere::coated>(here);
    }

    template <bool from_far, bool per_lane, Sphere sphere>
    void pass_packets(const Here& here) {
        [[maybe_unused]] const Media the_same = media<false>(here.index, 0);
        for (int packet = 0; packet < packets_; ++packet) {
            if constexpr (per_lane && sphere == Sphere::bare && carry != Carry::all) {
                pass_packet<from_far, true, sphere>(here, packet, ratio_of_media(here.index, packet));
            } else if constexpr (per_lane) {
                pass_packet<from_far, true, sphere>(here, packet, media<true>(here.index, packet));
            } else {
                pass_packet<from_far, false, sphere>(here, packet, the_same);
            }
        }
    }

    /// An opening is passed to the bit as refracting there would have it, since the root of a rounded square is what
    /// was squared.
    template <bool from_far, bool per_lane, Sphere sphere>
    void pass_packet(const Here& here, int packet, const Media& media) {
        const Mask going = this->going(packet);
        if (!any(going)) {
            return;
        }
        const State before = load(packet);
        const Vec3<Numbers> near = moved_near<from_far>(here, before);
        const Intersection<Numbers> met = sphere != Sphere::opening
                                              ? intersect_from_near(near, before.direction, curvature(here), heading())
                                              : intersect_plane_from_near(near, before.direction, heading());
        const Refraction<Numbers> bent =
            sphere != Sphere::opening
                ? bent_at(here, before, met, media)
                : Refraction<Numbers>{
                      .direction = before.direction, .cos_refraction = met.cos_incidence, .transmitted = Mask(true)};
        const Mask passes = met.hit && is_inside(here, met) && bent.transmitted;
        if (!all(passes || !going)) {
            pass_with_ends<from_far, per_lane, sphere>(here, packet);
            return;
        }
        const Vec3<Numbers>& at_surface = met.point;
        if (all(going)) {
            store(packet, {at_surface, bent.direction});
        } else {
            store(packet, {select(going, at_surface, before.origin), select(going, bent.direction, before.direction)});
        }
        add_path(packet, media, distance_moved<from_far>(here, before) + met.distance, going);
        add_depth<per_lane>(here, packet, distance_moved<from_far>(here, before) + met.distance, going);
        add_loss_of<per_lane, sphere>(here, packet, media, met, bent, going);
    }

    static Numbers heading() { return Numbers(kForward ? Scalar(1) : Scalar(-1)); }
    static Numbers curvature(const Here& here) { return Numbers(here.surface.curvature); }

    static Vec3<Numbers> from_vertex(const Here& here, const State& before) {
        return {before.origin.x, before.origin.y, before.origin.z - Numbers(here.from_last_vertex)};
    }

    /// How far a ray from far off goes before it is met: to its closest approach to the vertex.
    template <bool from_far>
    static Numbers distance_moved(const Here& here, const State& before) {
        return from_far ? distance_to_vertex(from_vertex(here, before), before.direction) : Numbers(Scalar(0));
    }

    template <bool from_far>
    static Vec3<Numbers> moved_near(const Here& here, const State& before) {
        if constexpr (from_far) {
            return from_vertex(here, before) + distance_moved<from_far>(here, before) * before.direction;
        } else {
            return from_vertex(here, before);  // and no copy of it: see going()
        }
    }

    static Mask is_inside(const Here& here, const Intersection<Numbers>& met) {
        return met.point.x * met.point.x + met.point.y * met.point.y <= Numbers(here.limit);
    }

    static Refraction<Numbers> bent_at(const Here& here, const State& before, const Intersection<Numbers>& met,
                                       const Media& media) {
        return refract_at_sphere(before.direction, met.point, curvature(here), heading(), met.cos_incidence,
                                 met.sin2_incidence, media.ratio);
    }

    /// Adds a stretch to the optical path of the rays in `lanes`, where it is asked for.
    void add_path(int packet, const Media& media, const Numbers& distance, const Mask& lanes) {
        if constexpr (carry == Carry::all) {
            Scalar* path = path_.data() + packet * kLanes;
            const Numbers so_far = Numbers::load(path);
            select(lanes, so_far + media.before * distance, so_far).store(path);
        }
    }

    /// Adds a stretch in front of a surface to the optical depth of the rays in `lanes`, where it is asked for.
    template <bool per_lane>
    void add_depth(const Here& here, int packet, const Numbers& distance, const Mask& lanes) {
        if constexpr (carry != Carry::geometry) {
            const auto& of = lens_.indices[here.index];
            if (const Scalar* attenuation = kForward ? of.attenuation_before : of.attenuation_after) {
                deepen<per_lane>(attenuation, packet, distance, lanes);
            }
        }
    }

    /// Kept apart, so that clear glass pays for a branch alone.
    template <bool per_lane>
    [[gnu::noinline]] void deepen(const Scalar* table, int packet, const Numbers& distance, const Mask& lanes) {
        const Numbers attenuation = by_wavelength<per_lane>(packet).number(table);
        Scalar* depth = depth_.data() + packet * kLanes;
        const Numbers so_far = Numbers::load(depth);
        select(lanes, so_far + attenuation * distance, so_far).store(depth);
    }

    /// Takes a surface's loss from the rays in `lanes`, where it is asked for.
    void add_loss(int packet, const Numbers& passing, const Mask& lanes) {
        if constexpr (carry != Carry::geometry) {
            multiply(part_.data() + packet * kLanes, passing, lanes);
        }
    }
    void add_loss(int packet, const Fraction<Numbers>& passing, const Mask& lanes) {
        if constexpr (carry != Carry::geometry) {
            multiply(part_.data() + packet * kLanes, passing.part, lanes);
            multiply(whole_.data() + packet * kLanes, passing.whole, lanes);
        }
    }
    static void multiply(Scalar* numbers, const Numbers& by, const Mask& lanes) {
        const Numbers so_far = Numbers::load(numbers);
        select(lanes, so_far * by, so_far).store(numbers);
    }

    /// A sphere's loss.
    template <bool per_lane, Sphere sphere>
    void add_loss_of(const Here& here, int packet, const Media& media, const Intersection<Numbers>& met,
                     const Refraction<Numbers>& bent, const Mask& lanes) {
        if constexpr (sphere == Sphere::coated) {
            add_loss(packet, coated_transmittances<per_lane>(here, packet, media, met.cos_incidence, lanes), lanes);
        } else if constexpr (sphere == Sphere::bare) {
            add_loss(packet, fresnel(media, met, bent), lanes);
        }
    }

    /// What `pass_packet` does, for a packet of which some rays end here or pass a rim: kept apart, since it is rare.
    template <bool from_far, bool per_lane, Sphere sphere>
    [[gnu::noinline, gnu::flatten]] void pass_with_ends(const Here& here, int packet) {
        const State before = load(packet);
        const Media media = this->template media<per_lane>(here.index, packet);
        const Vec3<Numbers> near = moved_near<from_far>(here, before);
        const Intersection<Numbers> met = intersect_from_near(near, before.direction, curvature(here), heading());
        const Refraction<Numbers> bent = bent_at(here, before, met, media);
        const Fate fate =
            settle(here, packet, before, {met.point, bent.direction}, met.hit, !is_inside(here, met), bent.transmitted);
        add_path(packet, media, distance_moved<from_far>(here, before) + met.distance, fate.met);
        add_depth<per_lane>(here, packet, distance_moved<from_far>(here, before) + met.distance, fate.met);
        add_loss_of<per_lane, sphere>(here, packet, media, met, bent, fate.on);
    }

    /// A surface with a shape, a frame or an opening of its own.
    template <bool per_lane>
    [[gnu::noinline, gnu::flatten]] void pass_special(const Here& here) {
        const SpecialSurface<Scalar>& special = lens_.specials[here.surface.special];
        const Vec3<Numbers> vertex{Numbers(special.vertex.x), Numbers(special.vertex.y), Numbers(Scalar(0))};
        for (int packet = 0; packet < packets_; ++packet) {
            if (!any(going(packet))) {
                continue;
            }
            const State before = load(packet);
            const Media media = this->template media<per_lane>(here.index, packet);
            const State own{special.to_own(from_vertex(here, before) - vertex), special.to_own(before.direction)};
            Intersection<Numbers> met;
            Refraction<Numbers> bent;
            Numbers added_path(Scalar(0));
            Vec3<Numbers> normal;
            if (special.has_shape) {
                std::tie(met, normal) = intersect(special.shape, own.origin, own.direction, heading());
            } else {
                met = intersect(own.origin, own.direction, curvature(here), heading());
            }
            if (special.thin.kind != ThinKind::none) {
                normal = special.has_shape ? normal : normal_of_sphere(met.point, curvature(here), heading());
                const ThinBending<Numbers> thin = bent_thin<per_lane>(here, packet, own, met, normal);
                bent = {.direction = thin.direction, .cos_refraction = {}, .transmitted = thin.passes};
                added_path = thin.optical_path;
            } else if (special.has_shape) {
                bent = refract(own.direction, normal, met.cos_incidence, met.sin2_incidence, media.ratio);
            } else {
                bent = bent_at(here, own, met, media);
            }
            const Mask beyond = !is_inside(here, met);
            const Numbers open = mask_transmittances(here, special, met.point, going(packet) && met.hit && !beyond);
            const State after{special.from_own(met.point) + vertex, special.from_own(bent.direction)};
            const Fate fate =
                settle(here, packet, before, after, met.hit, beyond || !(open > Numbers(Scalar(0))), bent.transmitted);
            add_path(packet, media, met.distance, fate.met);
            add_depth<per_lane>(here, packet, met.distance, fate.met);
            if constexpr (carry != Carry::geometry) {
                if (!special.coating.is_bare()) {
                    add_loss(packet, coated_transmittances<per_lane>(here, packet, media, met.cos_incidence, fate.on),
                             fate.on);
                } else if (special.thin.kind == ThinKind::none) {
                    add_loss(packet, fresnel(media, met, bent), fate.on);
                }
                add_loss(packet, open, fate.on);
            }
            if (special.thin.kind != ThinKind::none) {
                add_path(packet, {.ratio = {}, .before = Numbers(Scalar(1)), .after = {}}, added_path, fate.on);
            }
        }
    }

    /// At the surface's thin element, in its own axes.
    template <bool per_lane>
    ThinBending<Numbers> bent_thin(const Here& here, int packet, const State& own, const Intersection<Numbers>& met,
                                   const Vec3<Numbers>& normal) const {
        const Media media = this->template media<per_lane>(here.index, packet);
        const ThinMeeting<Numbers> meeting{met.point,    own.direction, normal,   met.cos_incidence,
                                           media.before, media.after,   heading()};
        const ThinElement<Scalar>& thin = lens_.specials[here.surface.special].thin;
        if (!per_lane || thin.kind == ThinKind::ideal_lens) {
            return bend_at(thin, meeting);
        }
        Numbers linear;
        std::array<Numbers, kPhaseTerms> radial;
        for (int lane = 0; lane < kLanes; ++lane) {
            const ThinElement<Scalar>& of_lane =
                lane_thin_element(*lens_.lens, rays_.wavelength[at(packet) + lane], here.index);
            linear.set(lane, of_lane.linear);
            for (std::size_t i = 0; i < radial.size(); ++i) {
                radial[i].set(lane, of_lane.radial[i]);
            }
        }
        return bend_at_phase(linear, radial, meeting);
    }

    static Fraction<Numbers> fresnel(const Media& media, const Intersection<Numbers>& met,
                                     const Refraction<Numbers>& bent) {
        return fresnel_transmittance(media.ratio, met.cos_incidence, bent.cos_refraction);
    }

    /// Of the rays in `lanes`, one by one; 1 for the others.
    Numbers mask_transmittances(const Here& here, const SpecialSurface<Scalar>& special, const Vec3<Numbers>& point,
                                const Mask& lanes) const {
        const Numbers whole(Scalar(1));
        if (special.mask.is_full_circle()) {
            return whole;
        }
        return Numbers::by_lane(lanes, whole, [&](int lane) {
            return lane_mask_transmittance(*lens_.lens, here.index, point.x[lane], point.y[lane]);
        });
    }

    /// Of the rays in `lanes`.
    template <bool per_lane>
    Numbers coated_transmittances(const Here& here, int packet, const Media& media, const Numbers& cos_incidence,
                                  const Mask& lanes) const {
        return coated_power(CoatedPower::transmitted, lens_.indices[here.index].coatings, kForward, media,
                            by_wavelength<per_lane>(packet), cos_incidence, lanes, [&](int lane) {
                                const int wavelength = per_lane ? rays_.wavelength[at(packet) + lane] : 0;
                                return lane_coated_transmittance(*lens_.lens, wavelength, here.index, kForward,
                                                                 cos_incidence[lane]);
                            });
    }

    /// Which rays of a packet met a surface, and which go on.
    struct Fate {
        Mask met;
        Mask on;
    };

    /// Notes what becomes of each ray and stores it: one that ends is in lens space from now on.
    Fate settle(const Here& here, int packet, const State& before, const State& after, const Mask& hit,
                const Mask& beyond, const Mask& transmitted) {
        const Mask going = this->going(packet);
        const Mask met = going && hit;
        const Mask inside = met && (clip_ ? !beyond : Mask(true));
        const Mask on = inside && transmitted;
        mark(going && !met, packet, here.index, RayStatus::missed, false);
        mark(met && beyond, packet, here.index, here.surface.is_stop ? RayStatus::stopped : RayStatus::clipped, true);
        mark(inside && !on, packet, here.index, why_it_ends(here), false);
        Vec3<Numbers> last = select(met, after.origin, before.origin);
        const Numbers global_z = last.z + select(met, Numbers(here.surface.vertex_z), Numbers(last_vertex_z_));
        last.z = select(going && !on, global_z, last.z);
        store(packet, {last, select(on, after.direction, before.direction)});
        set_going(packet, on);
        return {met, on};
    }

    /// Of a ray that is met and not let on.
    RayStatus why_it_ends(const Here& here) const {
        const bool is_thin =
            here.surface.special >= 0 && lens_.specials[here.surface.special].thin.kind != ThinKind::none;
        return is_thin ? RayStatus::evanescent : RayStatus::total_internal_reflection;
    }

    /// Notes the fate of the rays in `lanes`; of those that have none yet, if `only_first`.
    void mark(const Mask& lanes, int packet, int index, RayStatus status, bool only_first) const {
        for (int lane = 0; lane < kLanes; ++lane) {
            const int i = at(packet) + lane;
            if (lanes[lane] && !(only_first && rays_.status[i] != RayStatus::ok)) {
                rays_.status[i] = status;
                rays_.surface[i] = static_cast<std::int16_t>(index);
            }
        }
    }

    KernelLens<Scalar> lens_;
    RayColumns<Scalar> rays_;
    bool clip_;
    int first_;
    int packets_ = 0;
    Scalar last_vertex_z_ = Scalar(0);
    // The block's own columns: at fixed distances from each other, they need but one address in the inner loop.
    using Column = std::array<Scalar, kBlock>;
    alignas(kPacketAlignment) Column x_;  // mm; z from the last vertex passed, until a ray ends
    alignas(kPacketAlignment) Column y_;
    alignas(kPacketAlignment) Column z_;
    alignas(kPacketAlignment) Column dx_;
    alignas(kPacketAlignment) Column dy_;
    alignas(kPacketAlignment) Column dz_;
    alignas(kPacketAlignment) Column path_;
    alignas(kPacketAlignment) Column part_;  // of what surfaces left, as LeftBySurfaces has it
    alignas(kPacketAlignment) Column whole_;
    alignas(kPacketAlignment) Column depth_;  // optical: Σ attenuation · distance
    alignas(kPacketAlignment) Column going_;  // 1: not ended, 0: ended or no ray
};

template <class Scalar, class Abi, Direction direction, Carry carry>
[[gnu::flatten]] void trace_blocks(const KernelLens<Scalar>& lens, const RayColumns<Scalar>& rays, bool clip) {
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

template <>
LevelKernels trace_kernels_at<SimdLevel::LENSPROOF_LEVEL>() {
    return {.in_float = kernels_of<float, AbiOf<SimdLevel::LENSPROOF_LEVEL, float>>(),
            .in_double = kernels_of<double, AbiOf<SimdLevel::LENSPROOF_LEVEL, double>>()};
}

}  // namespace lensproof::optics
