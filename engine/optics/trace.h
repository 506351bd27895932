// engine/optics/trace.h — a ray through a lens, surface by surface: the one tracer that everything else uses.
//
// Lens space: +z runs from the scene to the sensor along the optical axis, the origin is the vertex of the first
// surface, light from the scene travels towards +z; mm.
//
// Mirrors by the sign convention of lens design (Welford, Aberrations of Optical Systems, §2.6): behind each, indices
// have the other sign and distances run backwards, n' = −n. Snell's law with these makes of a refraction a reflection,
// and every formula for lenses holds. Directions keep z > 0 where light runs towards −z: where the index is negative
// light travels against them, and t < 0, so that n t is positive.
#pragma once
#include <tuple>
#include <type_traits>
#include <vector>

#include "engine/base/branch.h"
#include "engine/base/elementary.h"
#include "engine/base/ray.h"
#include "engine/optics/coating.h"
#include "engine/optics/intersect.h"
#include "engine/optics/ray_status.h"
#include "engine/optics/refract.h"
#include "engine/optics/stop_mask.h"
#include "engine/optics/surface_shape.h"
#include "engine/optics/thin_element.h"

namespace lensproof::optics {

/// One surface as the tracer sees it, at one wavelength. Flat, immutable, no look-up behind it.
template <class T>
struct TraceSurface {
    T curvature;  // 1/mm, at the vertex (of a toroid: in y–z), positive where the centre of curvature lies at larger z
    T vertex_z;   // mm
    T semi_diameter_squared;  // mm²; 0: closed, even to a ray through the vertex
    T index_before;           // of the medium on the scene's side; negative behind an odd number of mirrors
    T index_after;            // of the medium on the sensor's side; −index_before at a mirror
    T forward_ratio;          // index_before / index_after, and its inverse: divisions that the inner loop is spared
    T reverse_ratio;
    bool is_stop;
    int special = -1;  // into TraceLens::specials; -1: a bare, centred sphere with a round aperture
    // Whether rays that travel forward, in reverse, may come from far off in units of the radius (`note_near_gaps`).
    bool from_far_forward = true;
    bool from_far_reverse = true;
};

/// What a surface has beyond a centred sphere's curvature and rim. Kept apart, so that a lens of spheres walks a short
/// array. Layers and mask own what they say, or look at it (`StopOpening`).
template <class T, class Layers = TraceLayers<T>, class Mask = StopMask>
struct SpecialSurface {
    bool has_shape = false;
    SurfaceShape<T> shape{};
    Vec2<T> vertex{};  // x, y of the displaced vertex
    std::array<Vec3<T>, 3> axes{{{T(1), T(0), T(0)}, {T(0), T(1), T(0)}, {T(0), T(0), T(1)}}};  // its frame's x, y, z
    TraceCoating<T, Layers> coating{};
    Mask mask{};
    ThinElement<T> thin{};

    /// From lens space to the surface's own axes, and back; of packets too.
    template <class V = T>
    [[nodiscard]] constexpr Vec3<V> to_own(const Vec3<V>& v) const {
        return {dot(axis<V>(0), v), dot(axis<V>(1), v), dot(axis<V>(2), v)};
    }
    template <class V = T>
    [[nodiscard]] constexpr Vec3<V> from_own(const Vec3<V>& v) const {
        return v.x * axis<V>(0) + (v.y * axis<V>(1) + v.z * axis<V>(2));
    }

    /// A centred sphere with a round aperture, but for its coating.
    [[nodiscard]] constexpr bool is_sphere() const {
        return !has_shape && vertex == Vec2<T>{} && axes == SpecialSurface{}.axes && mask.is_full_circle() &&
               thin.kind == ThinKind::none;
    }

  private:
    template <class V>
    [[nodiscard]] constexpr Vec3<V> axis(std::size_t i) const {
        return {V(axes[i].x), V(axes[i].y), V(axes[i].z)};
    }
};

/// The transmittance of a stop's texture or blades at a point inside its circle; 1 where it has neither.
template <class T, class Special>
constexpr T mask_transmittance(const TraceSurface<T>& surface, const Special& special, const T& x, const T& y) {
    if (special.mask.is_full_circle()) {
        return T(1);
    }
    using std::sqrt;
    const T scale = T(1) / sqrt(surface.semi_diameter_squared);
    return static_cast<T>(special.mask.transmittance(static_cast<double>(scale * x), static_cast<double>(scale * y)));
}

/// The transmittance of a coated surface for unpolarised light, from either side.
template <class T, class Special>
constexpr T coated_transmittance(const TraceSurface<T>& surface, const Special& special, bool forward,
                                 const T& cos_incidence) {
    return coating_transmittance(special.coating, surface.index_before, surface.index_after, cos_incidence, forward);
}

template <class T>
constexpr TraceSurface<T> make_trace_surface(T curvature, T vertex_z, T semi_diameter, T index_before, T index_after,
                                             bool is_stop) {
    return {.curvature = curvature,
            .vertex_z = vertex_z,
            .semi_diameter_squared = semi_diameter * semi_diameter,
            .index_before = index_before,
            .index_after = index_after,
            .forward_ratio = index_before / index_after,
            .reverse_ratio = index_after / index_before,
            .is_stop = is_stop};
}

/// Finds the gaps that every ray inside both their rims crosses within 1.75 radii of the surface it goes to: there it
/// is met by `intersect_from_near`, which is quicker. (With 2, fisheye-220's ninth surface alone makes a float's error
/// at the front 1.6 times as large, and more than it may be.) A lens without these notes is traced too.
template <class T>
void note_near_gaps(std::vector<TraceSurface<T>>& surfaces, const std::vector<SpecialSurface<T>>& specials) {
    using std::abs;
    using std::sqrt;
    const auto is_near = [](const TraceSurface<T>& to, T reach) { return abs(to.curvature) * reach <= T(1.75); };
    const auto is_sphere = [&](const TraceSurface<T>& surface) {
        return surface.special < 0 || specials[static_cast<std::size_t>(surface.special)].is_sphere();
    };
    for (std::size_t i = 1; i < surfaces.size(); ++i) {
        TraceSurface<T>& a = surfaces[i - 1];
        TraceSurface<T>& b = surfaces[i];
        // From a point on one surface to the other's vertex; a sag inside the rim is no longer than the semi-diameter
        // of a sphere.
        const auto reach_from = [&](const TraceSurface<T>& from) {
            return abs(b.vertex_z - a.vertex_z) + T(2) * sqrt(from.semi_diameter_squared);
        };
        if (is_sphere(a) && is_sphere(b)) {
            b.from_far_forward = !is_near(b, reach_from(a));
            a.from_far_reverse = !is_near(a, reach_from(b));
        }
    }
}

/// A lens at one wavelength and in one precision: its surfaces from the scene to the sensor.
template <class T>
struct TraceLens {
    using Special = SpecialSurface<T>;

    std::vector<TraceSurface<T>> surfaces;
    T image_z;  // the sensor's plane, mm
    std::vector<SpecialSurface<T>> specials{};
    /// By which light fades in the medium in front of each surface, and behind the last: e^(−attenuation · mm). Empty
    /// where no medium is known to absorb; with the index's sign.
    std::vector<T> attenuation{};

    /// Of the medium that a ray crosses on its way to a surface.
    [[nodiscard]] constexpr const T& attenuation_towards(int surface, bool forward) const {
        return attenuation[static_cast<std::size_t>(forward ? surface : surface + 1)];
    }
};

/// Where a ray travels: from the scene to the sensor, or from the sensor outwards.
enum class Direction { forward, reverse };

/// Whether a ray that meets a surface beyond its rim ends there. `follow` traces the geometry alone; the status still
/// names the first rim that was passed.
enum class Rims { clip, follow };

/// What a lens may have besides centred, bare spheres of clear glass: nothing, glass that absorbs, or anything.
enum class LensMakeup { clear_spheres, spheres, any };

/// A ray after the last surface that it reached.
template <class T>
struct TracedRay {
    Ray<T> ray;       // origin on that surface, direction after it (before it where it ended there)
    T optical_path;   // Σ n·t from the ray's origin, mm
    T transmittance;  // Fresnel and coatings at every surface passed, unpolarised, and what the glass between left
    RayStatus status;
    int surface;  // counted from 0 as in the prescription: where it was clipped or ended, else the last one
};

/// What `trace` reports at a surface that a ray reached.
template <class T>
struct SurfaceEvent {
    int surface;
    Ray<T> ray;
    T optical_path;
    T transmittance;
    RayStatus status;
};

/// What is left of light over an optical depth, Σ attenuation · distance.
template <class T>
constexpr T fading(const T& optical_depth) {
    if constexpr (std::is_same_v<T, float> || std::is_same_v<T, double>) {
        return exponential_of_negative(T(-optical_depth));
    } else {
        using std::exp;
        return exp(-optical_depth);
    }
}

/// What surfaces have left of a ray's light, as a fraction that is divided once for some surfaces: roots and divisions
/// are what processors do most slowly (`lensproof_benchmark`, batch/tessar/double). For so many that their product
/// stays in range for rays that graze, between indices as near to each other as numbers are: of the two cosines there
/// one is some √(2ε) at least, and so the whole, of their fourth powers, some 4ε².
template <class T>
class LeftBySurfaces {
  public:
    /// Whether the fraction is divided after the surface that so many stood before.
    static constexpr bool is_divided_after(int before) { return before % kSurfaces == kSurfaces - 1; }

    constexpr void pass(const T& power) { left_.part = left_.part * power; }
    constexpr void pass(const Fraction<T>& power) {
        pass(power.part);
        left_.whole = left_.whole * power.whole;
    }
    constexpr void end_surface() {
        if (is_divided_after(surfaces_++)) {
            left_ = {.part = left_.value()};
        }
    }
    [[nodiscard]] constexpr T value() const { return left_.value(); }

  private:
    static constexpr int kSurfaces = std::is_same_v<T, float> ? 2 : 8;

    Fraction<T> left_;
    int surfaces_ = 0;
};

/// `trace`, compiled for each makeup by itself, so that simple lenses pay for nothing. `OfLens`: a TraceLens<T>, or one
/// wavelength of a LensView<T>.
template <Direction direction, Rims rims, LensMakeup makeup, class OfLens, class T, class Visitor>
constexpr TracedRay<T> trace_through(const OfLens& lens, const Ray<T>& ray, Visitor&& visit) {
    constexpr bool has_specials = makeup == LensMakeup::any;
    constexpr bool may_absorb = makeup != LensMakeup::clear_spheres;
    // The state in single variables, made a TracedRay only at the end, and two vectors for `intersect` rather than a
    // Ray: g++ 12 keeps the aggregates in memory, written 8 bytes at a time and copied 16 at a time, which processors
    // do not forward from store to load. That doubled the time of a surface (lensproof_benchmark, trace/tessar).
    Vec3<T> origin = ray.origin;  // z from the last vertex passed, where the numbers are small
    T last_vertex_z = T(0);
    Vec3<T> ray_direction = ray.direction;
    T optical_path = T(0);
    LeftBySurfaces<T> at_surfaces;
    T optical_depth = T(0);
    const bool absorbs = may_absorb && !lens.attenuation.empty();
    RayStatus status = RayStatus::ok;
    int ended_at = -1;
    const auto global = [&] { return Ray<T>{{origin.x, origin.y, origin.z + last_vertex_z}, ray_direction}; };
    const auto transmittance = [&] {
        return absorbs ? at_surfaces.value() * fading(optical_depth) : at_surfaces.value();
    };
    const auto report = [&](int index, RayStatus here) {
        visit(SurfaceEvent<T>{index, global(), optical_path, transmittance(), here});
    };
    const auto traced = [&] { return TracedRay<T>{global(), optical_path, transmittance(), status, ended_at}; };

    const int count = static_cast<int>(lens.surfaces.size());
    const T heading = direction == Direction::forward ? T(1) : T(-1);
    for (int step = 0; step < count; ++step) {
        const int index = direction == Direction::forward ? step : count - 1 - step;
        const TraceSurface<T>& surface = lens.surfaces[index];
        const T& index_before = direction == Direction::forward ? surface.index_before : surface.index_after;
        const T& index_after = direction == Direction::forward ? surface.index_after : surface.index_before;
        const T& ratio = direction == Direction::forward ? surface.forward_ratio : surface.reverse_ratio;
        const T& c = surface.curvature;

        // In the surface's own frame, until the ray leaves it.
        Vec3<T> from_vertex{origin.x, origin.y, origin.z - (surface.vertex_z - last_vertex_z)};
        Vec3<T> own_direction = ray_direction;
        const typename OfLens::Special* special = nullptr;
        if constexpr (has_specials) {
            if (surface.special >= 0) {
                special = &lens.specials[surface.special];
                from_vertex =
                    special->to_own({origin.x - special->vertex.x, origin.y - special->vertex.y, from_vertex.z});
                own_direction = special->to_own(ray_direction);
            }
        }
        const bool is_shaped = has_specials && special != nullptr && special->has_shape;
        T to_vertex = T(0);
        Intersection<T> meeting;
        Vec3<T> shape_normal;  // of unit length, turned along the ray
        if (is_shaped) {
            std::tie(meeting, shape_normal) = intersect(special->shape, from_vertex, own_direction, heading);
        } else {
            const bool from_far = direction == Direction::forward ? surface.from_far_forward : surface.from_far_reverse;
            if (rims == Rims::follow || from_far) {
                if constexpr (rims == Rims::clip) {
                    stay_a_branch();
                }
                to_vertex = distance_to_vertex(from_vertex, own_direction);
                from_vertex = from_vertex + to_vertex * own_direction;
            }
            meeting = intersect_from_near(from_vertex, own_direction, c, heading);
        }
        if (!meeting.hit) {
            status = RayStatus::missed;
            ended_at = index;
            report(index, status);
            return traced();
        }
        const Vec3<T>& point = meeting.point;
        optical_path = optical_path + index_before * (to_vertex + meeting.distance);
        if constexpr (may_absorb) {
            if (absorbs) {
                optical_depth = optical_depth + lens.attenuation_towards(index, direction == Direction::forward) *
                                                    (to_vertex + meeting.distance);
            }
        }
        origin = point;
        last_vertex_z = surface.vertex_z;
        if constexpr (has_specials) {
            if (special != nullptr) {
                const Vec3<T> turned = special->from_own(point);
                origin = {turned.x + special->vertex.x, turned.y + special->vertex.y, turned.z};
            }
        }

        RayStatus here = RayStatus::ok;
        const T r2 = point.x * point.x + point.y * point.y;
        const bool is_beyond = r2 > surface.semi_diameter_squared || !(surface.semi_diameter_squared > T(0));
        T open = T(1);
        if constexpr (has_specials) {
            if (special != nullptr && !is_beyond) {
                open = mask_transmittance(surface, *special, point.x, point.y);
            }
        }
        if (is_beyond || (has_specials && !(open > T(0)))) {
            if (status == RayStatus::ok) {  // only the first rim passed is named
                here = surface.is_stop ? RayStatus::stopped : RayStatus::clipped;
                status = here;
                ended_at = index;
            }
            if (rims == Rims::clip) {
                report(index, here);
                return traced();
            }
        }

        Refraction<T> bent;
        const bool is_thin = has_specials && special != nullptr && special->thin.kind != ThinKind::none;
        T added_path = T(0);
        if (is_thin) {
            const ThinBending<T> thin =
                bend_at(special->thin, ThinMeeting<T>{point, own_direction,
                                                      is_shaped ? shape_normal : normal_of_sphere(point, c, heading),
                                                      meeting.cos_incidence, index_before, index_after, heading});
            bent = {.direction = thin.direction, .cos_refraction = T(1), .transmitted = thin.passes};
            added_path = thin.optical_path;
        } else if (is_shaped) {
            bent = refract(own_direction, shape_normal, meeting.cos_incidence, meeting.sin2_incidence, ratio);
        } else {
            bent = refract_at_sphere(own_direction, point, c, heading, meeting.cos_incidence, meeting.sin2_incidence,
                                     ratio);
        }
        if (!bent.transmitted) {
            status = is_thin ? RayStatus::evanescent : RayStatus::total_internal_reflection;
            ended_at = index;
            report(index, status);
            return traced();
        }
        ray_direction = bent.direction;
        if (has_specials && special != nullptr && !special->coating.is_bare()) {
            at_surfaces.pass(
                coated_transmittance(surface, *special, direction == Direction::forward, meeting.cos_incidence));
        } else if (!is_thin) {
            at_surfaces.pass(fresnel_transmittance(ratio, meeting.cos_incidence, bent.cos_refraction));
        }
        if constexpr (has_specials) {
            if (special != nullptr) {
                ray_direction = special->from_own(ray_direction);
                at_surfaces.pass(open);
                optical_path = optical_path + added_path;
            }
        }
        at_surfaces.end_surface();
        report(index, here);
    }
    if (status == RayStatus::ok) {
        ended_at = direction == Direction::forward ? count - 1 : 0;
    }
    return traced();
}

/// `trace_through` of lenses that have more than spheres, kept apart: inlined beside the other it takes up to a twelfth
/// of that one's speed.
template <Direction direction, Rims rims, class T, class Visitor>
[[gnu::noinline]] constexpr TracedRay<T> trace_specials(const TraceLens<T>& lens, const Ray<T>& ray, Visitor& visit) {
    return trace_through<direction, rims, LensMakeup::any>(lens, ray, visit);
}

/// Traces `ray` (global lens space, direction of unit length) through `lens`. In air before the first surface.
///
/// `visit(const SurfaceEvent<T>&)` is called at every surface reached, the one where the ray ends included.
/// A missed surface has no point: its event repeats the ray as it was.
template <Direction direction = Direction::forward, Rims rims = Rims::clip, class T, class Visitor>
constexpr TracedRay<T> trace(const TraceLens<T>& lens, const Ray<T>& ray, Visitor&& visit) {
    return lens.specials.empty() && lens.attenuation.empty()
               ? trace_through<direction, rims, LensMakeup::clear_spheres>(lens, ray, visit)
               : trace_specials<direction, rims>(lens, ray, visit);
}

template <Direction direction = Direction::forward, Rims rims = Rims::clip, class T>
constexpr TracedRay<T> trace(const TraceLens<T>& lens, const Ray<T>& ray) {
    return trace<direction, rims>(lens, ray, [](const SurfaceEvent<T>&) {});
}

/// Forward, whatever the rims would cut.
template <class T>
constexpr TracedRay<T> trace_past_rims(const TraceLens<T>& lens, const Ray<T>& ray) {
    return trace<Direction::forward, Rims::follow>(lens, ray);
}

/// From the sensor's side `from` through `to`, in reverse: z < 0, also behind an odd number of mirrors, where the
/// sensor stands at the smaller z.
template <class T>
constexpr Ray<T> reverse_ray(const Vec3<T>& from, const Vec3<T>& to) {
    const Vec3<T> direction = normalized(to - from);
    return {from, direction.z > T(0) ? T(-1) * direction : direction};
}

/// Where `ray` meets the plane at `z` mm, and the distance along it (signed, mm). The ray must not run parallel to
/// it.
template <class T>
struct PlanePoint {
    Vec3<T> point;
    T distance;
};

template <class T>
constexpr PlanePoint<T> meet_plane(const Ray<T>& ray, const T& z) {
    const T distance = (z - ray.origin.z) / ray.direction.z;
    Vec3<T> point = ray.origin + distance * ray.direction;
    point.z = z;
    return {point, distance};
}

}  // namespace lensproof::optics
