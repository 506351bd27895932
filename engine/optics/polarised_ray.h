// engine/optics/polarised_ray.h — the polarisation of a ray's light, carried from surface to surface of a lens.
#pragma once
#include "engine/optics/ghost_path.h"
#include "engine/optics/polarisation.h"
#include "engine/optics/surface_axes.h"

namespace lensproof::optics {

/// What arrives of light of power 1 that starts unpolarised, or linearly polarised across the plane that the ray's
/// first direction k and the axis span (along k × z; along x where k is the axis) or in it (along k × (k × z)). For a
/// ray of the meridional plane through centred surfaces these two are s and p.
template <class T>
struct PolarisedLight {
    using Field = typename PolarisedPath<T>::Field;

    Field of_sagittal;    // the field that each of the two becomes, in lens space: |E|² is the power; phases are those
    Field of_tangential;  // of surfaces alone

    [[nodiscard]] T sagittal() const { return power(of_sagittal); }
    [[nodiscard]] T tangential() const { return power(of_tangential); }
    [[nodiscard]] T unpolarised() const { return (sagittal() + tangential()) / T(2); }

    /// Of what starts unpolarised: 0 where it still is, 1 where it is wholly polarised. From the coherency matrix J,
    /// √(1 − 4 det J / tr² J) (Born & Wolf, §10.9), its two-dimensional determinant by the two fields.
    [[nodiscard]] T degree() const {
        using std::sqrt;
        const T sum = sagittal() + tangential();
        const T difference = sagittal() - tangential();
        std::complex<T> common(T(0));
        for (std::size_t i = 0; i < of_sagittal.size(); ++i) {
            common += times(of_sagittal[i], std::conj(of_tangential[i]));
        }
        return sum > T(0) ? T(sqrt(difference * difference + T(4) * std::norm(common)) / sum) : T(0);
    }

  private:
    static T power(const Field& of) { return std::norm(of[0]) + std::norm(of[1]) + std::norm(of[2]); }
};

/// A ray's light on its way through `lens`, which outlives it. The sensor and the stop's blades, where they are
/// mirrors, leave polarisation as it is; a wall that scatters leaves none.
template <class T>
class PolarisedRay {
  public:
    PolarisedRay(const TraceLens<T>& lens, const Vec3<T>& direction) : lens_(&lens), path_(direction) {}

    /// Passes surface `index` or is reflected at it, forward or back, at `point` of lens space, and goes on along
    /// `after`. The number of surfaces stands for the sensor.
    void meet(AtSurface what, int index, bool forward, const Vec3<T>& point, const Vec3<T>& after) {
        if (index == static_cast<int>(lens_->surfaces.size())) {
            meet_mirror({T(0), T(0), T(1)});
            return;
        }
        const TraceSurface<T>& surface = lens_->surfaces[static_cast<std::size_t>(index)];
        const SpecialSurface<T>* special = special_of(*lens_, surface);
        const Vec3<T> before = special != nullptr ? special->to_own(path_.direction()) : path_.direction();
        const auto [meeting, own_normal] =
            intersect(shape_of(*lens_, surface), to_own_axes(*lens_, surface, point), before, forward ? T(1) : T(-1));
        const Vec3<T> normal = special != nullptr ? special->from_own(own_normal) : own_normal;
        if (what == AtSurface::reflect && reflects_by_blades(surface)) {
            meet_mirror(normal);
            return;
        }
        const TraceCoating<T> coating = special != nullptr ? special->coating : TraceCoating<T>{};
        const CoatedPowers<T> powers =
            coating_powers(coating, surface.index_before, surface.index_after, dot(before, own_normal), forward)
                .unpolarised();
        if (what == AtSurface::reflect) {
            averaged_ = averaged_ * powers.reflected;
            path_.reflect(coating, surface.index_before, surface.index_after, forward, normal);
        } else {
            averaged_ = averaged_ * powers.transmitted;
            path_.refract(coating, surface.index_before, surface.index_after, forward, normal, after);
        }
    }

    /// A mirror that leaves both polarisations as they are, but for the half wave between them that metals make.
    void meet_mirror(const Vec3<T>& normal) {
        const TraceCoating<T> whole{.layers = {}, .reflectance = T(1)};
        const T metal(1000);
        path_.reflect(whole, T(1), metal, true, normal);
    }

    /// Light of no polarisation goes on along `direction`.
    void depolarise(const Vec3<T>& direction) {
        before_walls_ = factor();
        averaged_ = T(1);
        path_ = PolarisedPath<T>(direction);
    }

    /// What is left of unpolarised light, over the product of what each surface leaves of unpolarised light: a
    /// reflection at a slant leaves light polarised, and the next sends back more of that, or less. 1 where nothing is
    /// left.
    [[nodiscard]] T factor() const {
        return averaged_ > T(0) ? T(before_walls_ * path_.transmittance() / averaged_) : before_walls_;
    }

    /// The light of a ray whose transmittance is said to be `transmittance` by averages, from `start` on and without
    /// walls: its surfaces' part is the polarised one, what glass absorbs and stops let through stays.
    [[nodiscard]] PolarisedLight<T> light(const Vec3<T>& start, const T& transmittance) const {
        using std::sqrt;
        const Vec3<T> across = cross(start, Vec3<T>{T(0), T(0), T(1)});
        const Vec3<T> s = dot(across, across) > T(0) ? normalized(across) : Vec3<T>{T(1), T(0), T(0)};
        const T scale = averaged_ > T(0) ? T(sqrt(transmittance / averaged_)) : T(0);
        return {.of_sagittal = scaled_field(s, scale), .of_tangential = scaled_field(cross(start, s), scale)};
    }

  private:
    [[nodiscard]] typename PolarisedPath<T>::Field scaled_field(const Vec3<T>& axis, const T& scale) const {
        using Complex = std::complex<T>;
        return path_.field({Complex(scale * axis.x), Complex(scale * axis.y), Complex(scale * axis.z)});
    }

    const TraceLens<T>* lens_;
    PolarisedPath<T> path_;
    T averaged_ = T(1);      // since the last wall
    T before_walls_ = T(1);  // the factor up to there
};

/// Carries the polarisation of a ray that `trace` or `trace_ghost` follows: called with each of its events, in order.
/// The path is that of the ghost, empty for `trace`, and outlives it.
template <class T>
class PolarisedEvents {
  public:
    PolarisedEvents(const TraceLens<T>& lens, const GhostPath& path, const Vec3<T>& start, Direction direction,
                    Rims rims)
        : ray_(lens, start),
          start_(start),
          next_(path.begin()),
          end_(path.end()),
          forward_(direction == Direction::forward),
          rims_(rims) {}

    void operator()(const SurfaceEvent<T>& event) {
        const bool reflects = next_ != end_ && *next_ == event.surface;
        const bool came_forward = forward_;
        if (reflects) {
            ++next_;
            forward_ = !forward_;
        }
        const bool is_cut = event.status == RayStatus::clipped || event.status == RayStatus::stopped;
        if (event.status == RayStatus::ok || (is_cut && rims_ == Rims::follow)) {
            ray_.meet(reflects ? AtSurface::reflect : AtSurface::pass, event.surface, came_forward, event.ray.origin,
                      event.ray.direction);
        }
    }

    [[nodiscard]] T factor() const { return ray_.factor(); }
    [[nodiscard]] PolarisedLight<T> light(const T& transmittance) const { return ray_.light(start_, transmittance); }

  private:
    PolarisedRay<T> ray_;
    Vec3<T> start_;
    GhostPath::const_iterator next_;
    GhostPath::const_iterator end_;
    bool forward_;
    Rims rims_;
};

}  // namespace lensproof::optics
