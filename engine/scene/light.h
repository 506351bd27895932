// engine/scene/light.h — sources of light, and how paths find them from either end.
//
// World frame, mm. Radiance in W·m⁻²·sr⁻¹·nm⁻¹, intensity in W·sr⁻¹·nm⁻¹, irradiance in W·m⁻²·nm⁻¹; so intensity over a
// squared distance in mm is taken in m.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "engine/scene/geometry.h"
#include "engine/scene/surface_sampler.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof {

/// A surface that shines evenly: every point of it, in every direction on its outward side, or on both.
struct AreaLight {
    std::uint32_t object = 0;
    GridSpectrum radiance;
    bool is_two_sided = false;
};

struct PointLight {
    Vec3d position;
    GridSpectrum intensity;
};

/// A cone of light: full within `cos_inner` of its axis, none beyond `cos_outer`, a smoothstep of the cosine between.
struct SpotLight {
    Vec3d position;
    Vec3d axis;  // unit length, the way the light goes
    double cos_inner = 1.0;
    double cos_outer = 0.0;
    GridSpectrum intensity;  // on the axis
};

/// A disc at infinity, evenly bright: the sun.
struct SunLight {
    Vec3d towards;  // unit length, to the disc's centre
    double cos_radius = 1.0;
    GridSpectrum radiance;
};

/// The same radiance from every direction.
struct ConstantLight {
    GridSpectrum radiance;
};

using Light = std::variant<AreaLight, PointLight, SpotLight, SunLight, ConstantLight>;

/// Light that reaches a point: what next-event estimation adds, if nothing stands in the way.
struct LightSample {
    Vec3d direction;       // from the point to the light, unit length
    Vec3d end;             // the way is free if nothing stands between the point and this
    SpectralSample value;  // radiance over density, or irradiance on a surface that faces a delta light
    double density = 0.0;  // per solid angle at the point, choice of the light included; 0 for a delta
};

/// A ray of light as it leaves a source.
struct EmittedRay {
    Vec3d origin;
    Vec3d direction;
    SpectralSample power;  // W·nm⁻¹: what the source sends out, over the density of having drawn this ray of it
};

/// All lights of a scene, each drawn as often as its share of the power that they send into the scene.
class Lights {
  public:
    Lights() = default;
    /// `scene` has to outlive it. Objects in the scene carry at most one area light.
    Lights(const SceneGeometry& scene, std::vector<Light> lights);

    [[nodiscard]] bool is_empty() const { return lights_.empty(); }
    [[nodiscard]] std::size_t size() const { return lights_.size(); }

    /// Draws a light and a point of it as `point` sees them. Nothing where that light does not reach the point.
    [[nodiscard]] std::optional<LightSample> sample(const Vec3d& point, const PathWavelengths& path, double u_light,
                                                    double u1, double u2) const;

    /// What a surface that a ray has met radiates towards where the ray comes from, and the density with which
    /// `sample` would have drawn that direction from `from`.
    struct Emission {
        SpectralSample radiance;
        double density = 0.0;  // per solid angle, choice of the light included
    };
    [[nodiscard]] Emission emitted(const SurfaceHit& hit, const Vec3d& from, const Vec3d& direction,
                                   const PathWavelengths& path) const;

    /// The same for a ray that leaves the scene: visits what each of the lights at infinity has in that direction.
    template <class Visit>
    void visit_infinity(const Vec3d& direction, const PathWavelengths& path, const Visit& visit) const {
        for (const std::uint32_t index : at_infinity_) {
            if (const Emission found = at_infinity(lights_[index], direction, path); found.density > 0.0) {
                visit(found);
            }
        }
    }

    /// A ray that starts at a light. `u_light` chooses the light, the first two of `u` the point (or, of a light at
    /// infinity, where the ray crosses the scene), the others the direction.
    [[nodiscard]] EmittedRay emit(const PathWavelengths& path, double u_light, const std::array<double, 4>& u) const;

    /// W·nm⁻¹, the mean over the grid, that all lights send into the scene: what the choice goes by.
    [[nodiscard]] double power() const { return power_; }

  private:
    struct Ball {
        Vec3d centre;
        double radius_mm = 0.0;
    };
    struct Entry {
        Light light;
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
    static double area_density(const Entry& entry, const SurfaceHit& hit, const Vec3d& from, double cosine);
    static std::optional<LightSample> sample_area(const Entry& entry, const AreaLight& area, const Vec3d& point,
                                                  const PathWavelengths& path, double u1, double u2);
    static Emission at_infinity(const Entry& entry, const Vec3d& direction, const PathWavelengths& path);

    std::vector<Entry> lights_;
    std::vector<double> cumulative_;          // of the probabilities
    std::vector<std::int32_t> of_object_;     // the area light of each object, or −1
    std::vector<std::uint32_t> at_infinity_;  // indices
    Vec3d centre_;                            // of a sphere around the scene
    double radius_mm_ = 0.0;
    double power_ = 0.0;
};

}  // namespace lensproof
