// engine/optics/packet/ghost_kernel.h — the loop of ghost_lanes.h, compiled once for each width of packets.
//
// Only a file for each level includes this, as it does trace_kernel.h.
#pragma once
#include <algorithm>
#include <tuple>

#include "engine/base/pack.h"
#include "engine/optics/intersect.h"
#include "engine/optics/packet/coated_lanes.h"
#include "engine/optics/packet/ghost_kernels.h"
#include "engine/optics/packet/media.h"
#include "engine/optics/refract.h"
#include "engine/optics/surface_shape.h"

namespace lensproof::optics {

/// A few rays on their way, each at its wavelength: `TravellingRay`, `run_to_surface` and `reflect_at_sensor` for a
/// packet, with the same steps in the same order.
template <class Abi, Rims rims>
class GhostTracer {
  public:
    using Numbers = Pack<double, Abi>;
    using Mask = PackMask<double, Abi>;
    static constexpr int kLanes = Numbers::kLanes;

    /// Rays as they enter the lens.
    GhostTracer(const KernelLens<double>& lens, const KernelGhost& ghost, const std::uint16_t* wavelengths,
                const Vec3<Numbers>& origin, const Vec3<Numbers>& direction)
        : origin_(origin), direction_(direction), lens_(lens), ghost_(ghost), wavelengths_(wavelengths) {}

    static Vec3<Numbers> everywhere(const Vec3d& v) { return {Numbers(v.x), Numbers(v.y), Numbers(v.z)}; }
    template <class Of>
    static Vec3<Numbers> by_lane(const Of& of) {
        Vec3<Numbers> lanes = everywhere({});
        for (int lane = 0; lane < kLanes; ++lane) {
            const Vec3d& v = of(lane);
            lanes.x.set(lane, v.x);
            lanes.y.set(lane, v.y);
            lanes.z.set(lane, v.z);
        }
        return lanes;
    }

    /// Along the whole ghost, as far as any of them goes.
    void trace() {
        int next = 0;
        bool is_forward = true;
        for (int index = 0; any(going_); index += is_forward ? 1 : -1) {
            const bool reflects = next < ghost_.count && ghost_.reflections[next] == index;
            if (index < 0 || index > lens_.count || (index == lens_.count && !reflects)) {
                return;
            }
            if (index == lens_.count) {
                reflect_at_sensor();
            } else {
                run_to_surface(index, is_forward, reflects);
            }
            if (reflects) {
                is_forward = !is_forward;
                ++next;
            }
        }
    }

    [[nodiscard]] bool gets_through(int lane) const { return going_[lane]; }
    [[nodiscard]] Ray<double> ray(int lane) const {
        return {{origin_.x[lane], origin_.y[lane], origin_.z[lane] + last_vertex_z_},
                {direction_.x[lane], direction_.y[lane], direction_.z[lane]}};
    }
    [[nodiscard]] double transmittance(int lane) const {
        const double at_surfaces = at_surfaces_.part[lane] / at_surfaces_.whole[lane];
        return lens_.absorbs ? at_surfaces * lane_fading(optical_depth_[lane]) : at_surfaces;
    }
    [[nodiscard]] WorstLimit worst(int lane) const { return {others_[lane], ratio_squared_[lane]}; }

  private:
    [[nodiscard]] ByWavelength<Numbers, true> by_wavelength() const { return {wavelengths_}; }

    void cross(int surface, bool is_forward, const Numbers& distance) {
        const auto& of = lens_.indices[surface];
        if (const double* attenuation = is_forward ? of.attenuation_before : of.attenuation_after) {
            optical_depth_ = optical_depth_ + by_wavelength().number(attenuation) * distance;
        }
    }

    void pass(const Numbers& power) { at_surfaces_.part = at_surfaces_.part * power; }

    void reflect_at_sensor() {
        going_ = going_ && direction_.z > Numbers(0.0);
        const Numbers distance = (Numbers(ghost_.image_z - last_vertex_z_) - origin_.z) / direction_.z;
        origin_ = origin_ + distance * direction_;
        origin_.z = Numbers(0.0);
        last_vertex_z_ = ghost_.image_z;
        // Behind the last surface.
        cross(lens_.count - 1, false, distance);
        direction_.z = -direction_.z;
        pass(Numbers(ghost_.mirrors.sensor));
    }

    struct Meeting {
        Intersection<Numbers> at;
        Vec3<Numbers> normal;  // of unit length, turned along the ray
        Numbers distance;      // from where the ray was
    };

    /// In the surface's own frame.
    static Meeting meet(const TraceSurface<double>& surface, const SpecialSurface<double>* special, bool is_forward,
                        Vec3<Numbers> from_vertex, const Vec3<Numbers>& direction) {
        const Numbers heading(is_forward ? 1.0 : -1.0);
        Meeting met;
        Numbers to_vertex(0.0);
        if (special != nullptr && special->has_shape) {
            std::tie(met.at, met.normal) = intersect(special->shape, from_vertex, direction, heading);
        } else {
            if (rims == Rims::follow || (is_forward ? surface.from_far_forward : surface.from_far_reverse)) {
                to_vertex = distance_to_vertex(from_vertex, direction);
                from_vertex = from_vertex + to_vertex * direction;
            }
            met.at = intersect_from_near(from_vertex, direction, Numbers(surface.curvature), heading);
            met.normal = normal_of_sphere(met.at.point, Numbers(surface.curvature), heading);
        }
        met.distance = to_vertex + met.at.distance;
        return met;
    }

    /// What a rim and a stop's mask let pass at each point.
    [[nodiscard]] Numbers opening(int index, const SpecialSurface<double>* special, const Vec3<Numbers>& point) const {
        const double limit = lens_.surfaces[index].semi_diameter_squared;
        const Numbers r2 = point.x * point.x + point.y * point.y;
        const Mask is_inside = r2 <= Numbers(limit > 0.0 ? limit : -1.0);
        Numbers by_rim = select(is_inside, Numbers(1.0), Numbers(0.0));
        if (special == nullptr || special->mask.is_full_circle()) {
            return by_rim;
        }
        return Numbers::by_lane(going_ && is_inside, by_rim, [&](int lane) {
            return lane_mask_transmittance(*lens_.lens, index, point.x[lane], point.y[lane]);
        });
    }

    /// Where the packet is now, of rays that have met the surface.
    void meet_limit(int index, const SpecialSurface<double>* special, bool by_blades) {
        const TraceSurface<double>& surface = lens_.surfaces[index];
        Vec3<Numbers> at = origin_;
        if (special != nullptr) {
            const Numbers z = origin_.z + Numbers(surface.vertex_z);
            at = special->to_own(Vec3<Numbers>{origin_.x - Numbers(special->vertex.x),
                                               origin_.y - Numbers(special->vertex.y), z - Numbers(surface.vertex_z)});
        }
        Mask is_rim = going_;
        if (by_blades || (special != nullptr && !special->mask.is_full_circle())) {
            Numbers is_other(0.0);
            for (int lane = 0; lane < kLanes; ++lane) {
                if (!going_[lane]) {
                    continue;
                }
                if (const auto margin = lane_limit_margin(*lens_.lens, index, {at.x[lane], at.y[lane]}, by_blades)) {
                    others_.set(lane, others_[lane] < *margin ? *margin : others_[lane]);
                    is_other.set(lane, 1.0);
                }
            }
            is_rim = is_rim && is_other < Numbers(1.0);
        }
        const Numbers ratio = (at.x * at.x + at.y * at.y) / Numbers(surface.semi_diameter_squared);
        ratio_squared_ = select(is_rim && ratio_squared_ < ratio, ratio, ratio_squared_);
    }

    void run_to_surface(int index, bool is_forward, bool reflects) {
        const TraceSurface<double>& surface = lens_.surfaces[index];
        const bool is_sphere = surface.special < 0 || lens_.indices[index].is_coated_sphere;
        const SpecialSurface<double>* special = is_sphere ? nullptr : lens_.specials + surface.special;
        Vec3<Numbers> from_vertex{origin_.x, origin_.y, origin_.z - Numbers(surface.vertex_z - last_vertex_z_)};
        Vec3<Numbers> direction = direction_;
        if (special != nullptr) {
            from_vertex = special->to_own(Vec3<Numbers>{origin_.x - Numbers(special->vertex.x),
                                                        origin_.y - Numbers(special->vertex.y), from_vertex.z});
            direction = special->to_own(direction);
        }
        const Meeting met = meet(surface, special, is_forward, from_vertex, direction);
        going_ = going_ && met.at.hit;
        if (!any(going_)) {
            return;
        }
        cross(index, is_forward, met.distance);
        origin_ = met.at.point;
        last_vertex_z_ = surface.vertex_z;
        if (special != nullptr) {
            const Vec3<Numbers> turned = special->from_own(met.at.point);
            origin_ = {turned.x + Numbers(special->vertex.x), turned.y + Numbers(special->vertex.y), turned.z};
        }

        Numbers open = opening(index, special, met.at.point);
        const bool by_blades = reflects && reflects_by_blades(surface);
        if constexpr (rims == Rims::follow) {
            meet_limit(index, special, by_blades);
            if (!by_blades) {
                open = select(open > Numbers(0.0), open, Numbers(1.0));
            }
        }
        going_ = going_ && (by_blades ? open < Numbers(1.0) : open > Numbers(0.0));

        const auto media = Media<Numbers>::of(lens_.indices[index].at, is_forward, by_wavelength());
        const Numbers heading(is_forward ? 1.0 : -1.0);
        const Numbers& cos_incidence = met.at.cos_incidence;
        const Refraction<Numbers> bent =
            special != nullptr && special->has_shape
                ? refract(direction, met.normal, cos_incidence, met.at.sin2_incidence, media.ratio)
                : refract_at_sphere(direction, met.at.point, Numbers(surface.curvature), heading, cos_incidence,
                                    met.at.sin2_incidence, media.ratio);
        const bool is_coated = surface.special >= 0 && !lens_.specials[surface.special].coating.is_bare();
        if (reflects) {
            direction = reflect(direction, met.normal, cos_incidence);
            if (by_blades) {
                pass(Numbers(ghost_.mirrors.blades) * (Numbers(1.0) - open));
            } else {
                const Numbers reflected =
                    is_coated
                        ? coated(CoatedPower::reflected, lane_coated_reflectance, index, is_forward, media, met.at)
                        : select(bent.transmitted,
                                 fresnel_reflectance(media.before, media.after, cos_incidence, bent.cos_refraction),
                                 Numbers(1.0));
                pass(open * reflected);
            }
        } else {
            going_ = going_ && bent.transmitted;
            direction = bent.direction;
            if (is_coated) {
                pass(coated(CoatedPower::transmitted, lane_coated_transmittance<double>, index, is_forward, media,
                            met.at));
            } else {
                const auto passing = fresnel_transmittance(media.ratio, cos_incidence, bent.cos_refraction);
                pass(passing.part);
                at_surfaces_.whole = at_surfaces_.whole * passing.whole;
            }
            if (special != nullptr) {
                pass(open);
            }
        }
        if (LeftBySurfaces<double>::is_divided_after(surfaces_++)) {
            at_surfaces_ = {.part = at_surfaces_.value()};
        }
        direction_ = special != nullptr ? special->from_own(direction) : direction;
    }

    /// One of a coating's powers, of unpolarised light. `of_lane`: the same of a ray.
    template <class OfLane>
    [[nodiscard]] Numbers coated(CoatedPower power, const OfLane& of_lane, int index, bool is_forward,
                                 const Media<Numbers>& media, const Intersection<Numbers>& met) const {
        return coated_power(power, lens_.indices[index].coatings, is_forward, media, by_wavelength(), met.cos_incidence,
                            going_, [&](int lane) {
                                return of_lane(*lens_.lens, wavelengths_[lane], index, is_forward,
                                               met.cos_incidence[lane]);
                            });
    }

    Vec3<Numbers> origin_;  // z from the last vertex passed
    Vec3<Numbers> direction_;
    Fraction<Numbers> at_surfaces_;  // as LeftBySurfaces has it
    int surfaces_ = 0;
    Numbers optical_depth_{0.0};
    Numbers others_{-1.0};  // WorstLimit
    Numbers ratio_squared_{0.0};
    Mask going_{true};
    const KernelLens<double>& lens_;
    const KernelGhost& ghost_;
    const std::uint16_t* wavelengths_;
    double last_vertex_z_ = 0.0;
};

template <class Abi>
[[gnu::flatten]] void trace_lanes(const KernelLens<double>& lens, const KernelGhost& ghost,
                                  const std::uint16_t* wavelengths, const Ray<double>& ray, GhostLanes& lanes) {
    using Tracer = GhostTracer<Abi, Rims::clip>;
    for (std::size_t first = 0; first < kGhostLanes; first += Tracer::kLanes) {
        Tracer tracer(lens, ghost, wavelengths + first, Tracer::everywhere(ray.origin),
                      Tracer::everywhere(ray.direction));
        tracer.trace();
        for (int lane = 0; lane < Tracer::kLanes; ++lane) {
            const std::size_t to = first + static_cast<std::size_t>(lane);
            lanes.arrives[to] = tracer.gets_through(lane);
            if (lanes.arrives[to]) {
                lanes.ray[to] = tracer.ray(lane);
                lanes.transmittance[to] = tracer.transmittance(lane);
            }
        }
    }
}

template <class Abi>
[[gnu::flatten]] void follow_rays(const KernelLens<double>& lens, const KernelGhost& ghost, FollowedRays& rays) {
    using Tracer = GhostTracer<Abi, Rims::follow>;
    const std::uint16_t wavelengths[kFollowedRays] = {};
    for (std::size_t first = 0; first < kFollowedRays; first += Tracer::kLanes) {
        const TracedRay<double>* given = rays.ray.data() + first;
        Tracer tracer(lens, ghost, wavelengths,
                      Tracer::by_lane([&](int lane) -> const Vec3d& { return given[lane].ray.origin; }),
                      Tracer::by_lane([&](int lane) -> const Vec3d& { return given[lane].ray.direction; }));
        tracer.trace();
        for (int lane = 0; lane < Tracer::kLanes; ++lane) {
            const std::size_t at = first + static_cast<std::size_t>(lane);
            TracedRay<double>& to = rays.ray[at];
            to.status = tracer.gets_through(lane) ? RayStatus::ok : RayStatus::missed;
            to.ray = tracer.ray(lane);
            to.transmittance = tracer.transmittance(lane);
            rays.worst[at] = tracer.worst(lane);
        }
    }
}

template <>
GhostKernels ghost_kernels_at<SimdLevel::LENSPROOF_LEVEL>() {
    using Abi = AbiOf<SimdLevel::LENSPROOF_LEVEL, double>;
    constexpr int kLanes = std::min(Pack<double, Abi>::kLanes, int{kGhostLanes});
    return {trace_lanes<std::experimental::simd_abi::deduce_t<double, kLanes>>, follow_rays<Abi>};
}

}  // namespace lensproof::optics
