// engine/optics/packet/ghost_kernel.h — the loop of ghost_lanes.h, compiled once for each width of packets.
//
// Only the files ghost_kernel_*.cpp include this, as trace_kernel.h is by its own.
#pragma once
#include <tuple>

#include "engine/base/pack.h"
#include "engine/optics/intersect.h"
#include "engine/optics/packet/ghost_kernels.h"
#include "engine/optics/refract.h"
#include "engine/optics/surface_shape.h"

namespace lensproof::optics {

/// A few wavelengths of a ray on their way: `TravellingRay`, `run_to_surface` and `reflect_at_sensor` for a packet,
/// with the same steps in the same order.
template <class Abi>
class GhostTracer {
  public:
    using Numbers = Pack<double, Abi>;
    using Mask = PackMask<double, Abi>;
    static constexpr int kLanes = Numbers::kLanes;

    GhostTracer(const KernelLens<double>& lens, const GhostWay& way, const std::uint16_t* wavelengths)
        : lens_(lens),
          way_(way),
          wavelengths_(wavelengths),
          origin_(everywhere(way.ray.origin)),
          direction_(everywhere(way.ray.direction)) {}

    /// Along the whole ghost, as far as any of them goes.
    void trace() {
        int next = 0;
        bool is_forward = true;
        for (int index = 0; any(going_); index += is_forward ? 1 : -1) {
            const bool reflects = next < way_.count && way_.reflections[next] == index;
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

    /// Into the lanes from `first` on.
    void store(GhostLanes& lanes, std::size_t first) const {
        for (int lane = 0; lane < kLanes; ++lane) {
            const std::size_t to = first + static_cast<std::size_t>(lane);
            lanes.arrives[to] = going_[lane];
            if (going_[lane]) {
                lanes.ray[to] = {{origin_.x[lane], origin_.y[lane], origin_.z[lane] + last_vertex_z_},
                                 {direction_.x[lane], direction_.y[lane], direction_.z[lane]}};
                lanes.transmittance[to] =
                    lens_.absorbs ? at_surfaces_[lane] * lane_fading(optical_depth_[lane]) : at_surfaces_[lane];
            }
        }
    }

  private:
    static Vec3<Numbers> everywhere(const Vec3d& v) { return {Numbers(v.x), Numbers(v.y), Numbers(v.z)}; }

    [[nodiscard]] Numbers by_wavelength(const double* table) const { return Numbers::gather(table, wavelengths_); }

    void cross(int surface, bool is_forward, const Numbers& distance) {
        if (lens_.absorbs) {
            const auto& of = lens_.indices[surface];
            optical_depth_ =
                optical_depth_ + by_wavelength(is_forward ? of.attenuation_before : of.attenuation_after) * distance;
        }
    }

    void reflect_at_sensor() {
        going_ = going_ && direction_.z > Numbers(0.0);
        const Numbers distance = (Numbers(way_.image_z - last_vertex_z_) - origin_.z) / direction_.z;
        origin_ = origin_ + distance * direction_;
        origin_.z = Numbers(0.0);
        last_vertex_z_ = way_.image_z;
        // Behind the last surface.
        cross(lens_.count - 1, false, distance);
        direction_.z = -direction_.z;
        at_surfaces_ = at_surfaces_ * Numbers(way_.mirrors.sensor);
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
            if (is_forward ? surface.from_far_forward : surface.from_far_reverse) {
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
        const Numbers by_rim = select(is_inside, Numbers(1.0), Numbers(0.0));
        if (special == nullptr || special->mask.is_full_circle()) {
            return by_rim;
        }
        return Numbers::by_lane(going_ && is_inside, by_rim, [&](int lane) {
            return lane_mask_transmittance(*lens_.lens, index, point.x[lane], point.y[lane]);
        });
    }

    void run_to_surface(int index, bool is_forward, bool reflects) {
        const TraceSurface<double>& surface = lens_.surfaces[index];
        const SpecialSurface<double>* special = surface.special < 0 ? nullptr : lens_.specials + surface.special;
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

        const Numbers open = opening(index, special, met.at.point);
        const bool by_blades = reflects && reflects_by_blades(surface);
        going_ = going_ && (by_blades ? open < Numbers(1.0) : open > Numbers(0.0));

        const auto& of = lens_.indices[index];
        const Numbers ratio = by_wavelength(is_forward ? of.forward_ratio : of.reverse_ratio);
        const Numbers before = by_wavelength(is_forward ? of.before : of.after);
        const Numbers after = by_wavelength(is_forward ? of.after : of.before);
        const Numbers heading(is_forward ? 1.0 : -1.0);
        const Numbers& cos_incidence = met.at.cos_incidence;
        const Refraction<Numbers> bent =
            special != nullptr && special->has_shape
                ? refract(direction, met.normal, cos_incidence, met.at.sin2_incidence, ratio)
                : refract_at_sphere(direction, met.at.point, Numbers(surface.curvature), heading, cos_incidence,
                                    met.at.sin2_incidence, ratio);
        const bool is_coated = special != nullptr && !special->coating.is_bare();
        if (reflects) {
            direction = reflect(direction, met.normal, cos_incidence);
            if (by_blades) {
                at_surfaces_ = at_surfaces_ * (Numbers(way_.mirrors.blades) * (Numbers(1.0) - open));
            } else {
                const Numbers reflected =
                    is_coated
                        ? coated(lane_coated_reflectance, index, is_forward, cos_incidence)
                        : select(bent.transmitted,
                                 fresnel_reflectance(before, after, cos_incidence, bent.cos_refraction), Numbers(1.0));
                at_surfaces_ = at_surfaces_ * (open * reflected);
            }
        } else {
            going_ = going_ && bent.transmitted;
            direction = bent.direction;
            Numbers passing = is_coated ? coated(lane_coated_transmittance<double>, index, is_forward, cos_incidence)
                                        : fresnel_transmittance(before, after, cos_incidence, bent.cos_refraction);
            if (special != nullptr) {
                passing = passing * open;
            }
            at_surfaces_ = at_surfaces_ * passing;
        }
        direction_ = special != nullptr ? special->from_own(direction) : direction;
    }

    /// A coating's power, wavelength by wavelength.
    template <class Power>
    [[nodiscard]] Numbers coated(const Power& power, int index, bool is_forward, const Numbers& cos_incidence) const {
        return Numbers::by_lane(going_, Numbers(0.0), [&](int lane) {
            return power(*lens_.lens, wavelengths_[lane], index, is_forward, cos_incidence[lane]);
        });
    }

    const KernelLens<double>& lens_;
    const GhostWay& way_;
    const std::uint16_t* wavelengths_;
    Vec3<Numbers> origin_;  // z from the last vertex passed
    Vec3<Numbers> direction_;
    double last_vertex_z_ = 0.0;
    Numbers at_surfaces_{1.0};
    Numbers optical_depth_{0.0};
    Mask going_{true};
};

template <class Abi>
[[gnu::flatten]] void trace_lanes(const KernelLens<double>& lens, const GhostWay& way, GhostLanes& lanes) {
    using Tracer = GhostTracer<Abi>;
    for (std::size_t first = 0; first < kGhostLanes; first += Tracer::kLanes) {
        Tracer tracer(lens, way, way.wavelengths + first);
        tracer.trace();
        tracer.store(lanes, first);
    }
}

/// So many doubles, in one register of the file's instructions.
template <int lanes>
using GhostAbi = std::experimental::simd_abi::deduce_t<double, lanes>;

}  // namespace lensproof::optics
