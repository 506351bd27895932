// engine/scene/light.h — sources of light, and how paths find them from either end.
//
// World frame, mm. Radiance in W·m⁻²·sr⁻¹·nm⁻¹, intensity in W·sr⁻¹·nm⁻¹, irradiance in W·m⁻²·nm⁻¹; so intensity over a
// squared distance in mm is taken in m.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "engine/base/ray.h"
#include "engine/scene/environment.h"
#include "engine/scene/geometry.h"
#include "engine/scene/surface_sampler.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::scene {

/// A surface that shines evenly: every point of it, in every direction on its outward side, or on both.
struct AreaLight {
    std::uint32_t object = 0;
    spectral::GridSpectrum radiance;
    bool is_two_sided = false;
};

struct PointLight {
    Vec3d position;
    spectral::GridSpectrum intensity;
};

/// A cone of light: full within `cos_inner` of its axis, none beyond `cos_outer`, a smoothstep of the cosine between.
struct SpotLight {
    Vec3d position;
    Vec3d axis;  // unit length, the way the light goes
    double cos_inner = 1.0;
    double cos_outer = 0.0;
    spectral::GridSpectrum intensity;  // on the axis
};

/// A disc at infinity, evenly bright: the sun.
struct SunLight {
    Vec3d towards;  // unit length, to the disc's centre
    double cos_radius = 1.0;
    spectral::GridSpectrum radiance;
};

/// The same radiance from every direction.
struct ConstantLight {
    spectral::GridSpectrum radiance;
};

/// A picture of all directions at infinity.
struct EnvironmentLight {
    std::shared_ptr<const Environment> map;
};

using LightSource = std::variant<AreaLight, PointLight, SpotLight, SunLight, ConstantLight, EnvironmentLight>;

/// Light that reaches a point: what next-event estimation adds, if nothing stands in the way.
struct LightSample {
    Vec3d direction;                 // from the point to the light, unit length
    Vec3d end;                       // the way is free if nothing stands between the point and this
    spectral::SpectralSample value;  // radiance over density, or irradiance on a surface that faces a delta light
    double density = 0.0;            // per solid angle at the point, choice of the light included; 0 for a delta
    /// The density per etendue with which a light path would leave along this way, over that of this sample, 1/mm².
    double leaving_per_sample = 0.0;
};

/// Where a light path begins: a point of a source or, for one at infinity, a direction that its light comes along.
struct LightStart {
    std::uint32_t light = 0;
    bool is_at_infinity = false;
    Vec3d point;
    Vec3d direction;        // of light from infinity, unit length
    Vec3d normal;           // of a surface, on the side that shines here; else zeros
    double error_mm = 0.0;  // for `ray_origin`
    /// Over the density of having drawn the start. Of a surface radiance · m², of a point intensity, W·sr⁻¹·nm⁻¹; of
    /// light from infinity radiance · sr, the irradiance across it.
    spectral::SpectralSample value;
    /// With which it was drawn, choice of the light included: per mm² of a surface, per solid angle of directions from
    /// infinity; 0 of a point.
    double density = 0.0;

    /// Of a point light or a spot, which has an intensity and no radiance.
    [[nodiscard]] bool is_point() const { return density == 0.0; }
};

/// The way of light from a start to a surface point, and how likely each kind of path is to take it.
struct LightWay {
    double hit_per_leaving = 0.0;  // mm² sr: 1 over the density per etendue with which light paths leave along it; 0
                                   // of a point, which no path runs into
    double sample_per_leaving = 0.0;  // mm²: the density with which the surface point samples it, over the same
};

/// A ray of light as it leaves a source.
struct EmittedRay {
    Ray<double> ray;
    spectral::SpectralSample
        power;  // W·nm⁻¹: what the source sends out, over the density of having drawn this ray of it
};

/// All lights of a scene, each drawn as often as its share of the power that they send into the scene.
class Lights {
  public:
    Lights() = default;
    /// `scene` has to outlive it. Objects in the scene carry at most one area light.
    Lights(const SceneGeometry& scene, std::vector<LightSource> lights);

    [[nodiscard]] bool is_empty() const { return lights_.empty(); }
    [[nodiscard]] std::size_t size() const { return lights_.size(); }

    /// Draws a light and a point of it as `point` sees them. Nothing where that light does not reach the point.
    [[nodiscard]] std::optional<LightSample> sample(const Vec3d& point, const spectral::PathWavelengths& path,
                                                    double u_light, double u1, double u2) const;

    /// What a surface that a ray has met radiates towards where the ray comes from, and the density with which
    /// `sample` would have drawn that direction from `from`.
    struct Emission {
        spectral::SpectralSample radiance;
        double density = 0.0;          // per solid angle, choice of the light included
        double start_density = 0.0;    // with which `start` draws this point or direction (LightStart)
        double leaving_density = 0.0;  // per etendue, 1/(mm² sr): of `start` and `leave` together
    };
    [[nodiscard]] Emission emitted(const SurfaceHit& hit, const Vec3d& from, const Vec3d& direction,
                                   const spectral::PathWavelengths& path) const;

    /// The same for a ray that leaves the scene: visits what each of the lights at infinity has in that direction.
    template <class Visit>
    void visit_infinity(const Vec3d& direction, const spectral::PathWavelengths& path, const Visit& visit) const {
        for (const std::uint32_t index : at_infinity_) {
            if (const Emission found = at_infinity(lights_[index], direction, path);
                !spectral::is_black(found.radiance)) {
                visit(found);
            }
        }
    }

    /// Draws where a light path begins. There has to be a light.
    [[nodiscard]] LightStart start(const spectral::PathWavelengths& path, double u_light, double u1, double u2) const;

    /// What a start that is not at infinity sends in a direction: W·sr⁻¹·nm⁻¹.
    [[nodiscard]] spectral::SpectralSample intensity(const LightStart& start, const Vec3d& direction) const;

    /// Draws the direction that a path goes on in; of light from infinity, where it crosses the scene.
    [[nodiscard]] EmittedRay leave(const LightStart& start, double u1, double u2) const;

    /// Of the way from a start to a surface point that it shines on.
    [[nodiscard]] LightWay way(const LightStart& start, const Vec3d& to) const;

    /// How far from a point all of the scene lies behind, whatever the direction.
    [[nodiscard]] double beyond_mm(const Vec3d& point) const {
        return length(point - centre_) + 2.0 * radius_mm_ + 1.0;
    }

    /// W·nm⁻¹, the mean over the grid, that all lights send into the scene: what the choice goes by.
    [[nodiscard]] double power() const { return power_; }

  private:
    struct Ball {
        Vec3d centre;
        double radius_mm = 0.0;
    };
    struct Entry {
        LightSource light;
        std::optional<SurfaceSampler> surface;  // of an area light
        std::optional<Ball> ball;               // of one that is a sphere in the world: points see a cone of it
        double probability = 0.0;
    };
    struct Chosen {
        const Entry* entry;
        double rest;  // of the number that chose it, uniform again
    };
    [[nodiscard]] Chosen choose(double u) const;
    static std::optional<Ball> ball_of(const SceneGeometry& scene, std::uint32_t object);
    static bool is_outside(const Ball& ball, const Vec3d& point);
    /// With which `sample` draws a point of the light; `per_mm2` is that of its surface's sampler, `cosine` that of the
    /// way from `from` there.
    static double area_density(const Entry& entry, const Vec3d& at, double per_mm2, const Vec3d& from, double cosine);
    static std::optional<LightSample> sample_area(const Entry& entry, const AreaLight& area, const Vec3d& point,
                                                  const spectral::PathWavelengths& path, double u1, double u2);
    [[nodiscard]] Emission at_infinity(const Entry& entry, const Vec3d& direction,
                                       const spectral::PathWavelengths& path) const;

    std::vector<Entry> lights_;
    std::vector<double> cumulative_;          // of the probabilities
    std::vector<std::int32_t> of_object_;     // the area light of each object, or −1
    std::vector<std::uint32_t> at_infinity_;  // indices
    Vec3d centre_;                            // of a sphere around the scene
    double radius_mm_ = 0.0;
    double crossing_density_ = 0.0;  // 1/mm²: of light paths from infinity over the disc in front of the scene
    double power_ = 0.0;
};

}  // namespace lensproof::scene
