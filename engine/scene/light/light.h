// engine/scene/light/light.h — the lights of a scene, and how paths find them from either end.
#pragma once
#include <array>
#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "engine/scene/light/area_light.h"
#include "engine/scene/light/environment_light.h"
#include "engine/scene/light/light_sample.h"
#include "engine/scene/light/point_light.h"
#include "engine/scene/light/spot_light.h"
#include "engine/scene/light/sun_light.h"

namespace lensproof::scene {

/// A light is a surface (`AreaLight`), at a point or at infinity.
using LightSource = std::variant<AreaLight, PointLight, SpotLight, SunLight, ConstantLight, EnvironmentLight>;

/// An intensity, and no radiance: `falloff` of it in a direction, none outside a cone in which `draw` draws evenly.
/// `power`: W·nm⁻¹, the mean over the grid.
template <class Light>
concept LightAtPoint = requires(const Light& light, const Vec3d& direction) {
    { light.position } -> std::convertible_to<Vec3d>;
    { light.falloff(direction) } -> std::same_as<double>;
    { light.draw(0.0, 0.0) } -> std::same_as<Vec3d>;
    { light.cone_sr() } -> std::same_as<double>;
    { light.power() } -> std::same_as<double>;
};

/// Radiance from directions, which `draw` draws as the light has them, with the pdf that `seen` tells. `irradiance`:
/// W·m⁻²·nm⁻¹ of all of it, each direction on what faces it, the mean over the grid.
template <class Light>
concept LightAtInfinity = requires(const Light& light, const Vec3d& direction, const spectral::PathWavelengths& path) {
    { light.draw(path, 0.0, 0.0) } -> std::same_as<SkySample>;
    { light.seen(direction, path) } -> std::same_as<SkySample>;
    { light.irradiance() } -> std::same_as<double>;
};

/// All lights of a scene, each drawn as often as its fraction of the power that they send into the scene; by a surface
/// point, where there are not too many, mostly as often as its fraction of what the point would pass on.
class Lights {
  public:
    Lights() = default;
    /// `scene` has to outlive it. Objects in the scene carry at most one area light.
    Lights(const SceneGeometry& scene, std::vector<LightSource> lights);

    [[nodiscard]] bool is_empty() const { return lights_.empty(); }
    [[nodiscard]] std::size_t size() const { return lights_.size(); }

    /// Draws a light and a point of it as `point` sees them. Nothing where that light does not reach the point.
    [[nodiscard]] std::optional<LightSample> sample(const Vec3d& point, const spectral::PathWavelengths& path,
                                                    const LightNumbers& numbers) const {
        return is_empty() ? std::nullopt : sample_of(choose(numbers.of_light), point, path, numbers);
    }
    /// The same for a point of which `passes_on` tells how much (in any unit) it passes on of light from a direction
    /// (world, unit length): what a lamp's mirror image in a wet street needs. The sample's pdfs, which only weigh
    /// it against other ways to the light, are those of a choice by power.
    template <class PassesOn>
    [[nodiscard]] std::optional<LightSample> sample(const Vec3d& point, const spectral::PathWavelengths& path,
                                                    const LightNumbers& numbers, const PassesOn& passes_on) const {
        if (lights_.size() < 2 || lights_.size() > kMostWeighed) {
            return sample(point, path, numbers);
        }
        std::array<double, kMostWeighed> weights{};
        for (std::size_t i = 0; i < lights_.size(); ++i) {
            const auto [direction, irradiance] = lights_[i].seen_from(point);
            weights[i] = irradiance > 0.0 ? irradiance * passes_on(direction) : 0.0;
        }
        return sample_of(choose(numbers.of_light, std::span(weights).first(lights_.size())), point, path, numbers);
    }

    /// What a surface that a ray has met radiates towards where the ray comes from, and the pdf with which
    /// `sample` would have drawn that direction from `from`.
    struct Emission {
        spectral::SpectralSample radiance;
        double pdf = 0.0;          // per solid angle, with the light drawn by power
        double start_pdf = 0.0;    // with which `start` draws this point or direction (LightStart)
        double leaving_pdf = 0.0;  // per etendue, 1/(mm² sr): of `start` and `leave` together
        bool is_sun = false;
    };
    [[nodiscard]] Emission emitted(const SurfaceHit& hit, const Vec3d& from, const Vec3d& direction,
                                   const spectral::PathWavelengths& path) const;

    /// The map that rays out of the scene see; none: there is none. Of several the first.
    [[nodiscard]] const Environment* map() const { return map_; }
    /// Draws what these numbers draw for these points, as `sample` would, together: of the map, while memory brings it,
    /// and of a shining surface that is the only light.
    void draw_ahead(std::span<const Vec3d> points, std::span<LightNumbers> numbers) const;

    /// The same as `emitted` for a ray that leaves the scene: visits what each of the lights at infinity has in that
    /// direction. `ahead`: where the map shows it, if that is known.
    template <class Visit>
    void visit_infinity(const Vec3d& direction, const spectral::PathWavelengths& path, const Visit& visit,
                        const MapPlace& ahead = {}) const {
        for (const std::uint32_t index : at_infinity_) {
            if (const Emission found = at_infinity(lights_[index], direction, ahead, path);
                !spectral::is_black(found.radiance)) {
                visit(found);
            }
        }
    }

    /// Draws where a light path begins. There has to be a light.
    [[nodiscard]] LightStart start(const spectral::PathWavelengths& path, double u_light, double u1, double u2) const;

    /// The same at one of its suns, of which there has to be one, each as often as its fraction of their power.
    [[nodiscard]] LightStart start_at_sun(const spectral::PathWavelengths& path, double u_light, double u1,
                                          double u2) const;
    [[nodiscard]] std::vector<SunLight> suns() const;
    /// Points of the i-th light: its own, or sixteen spread over its surface. None of one at infinity.
    [[nodiscard]] std::vector<Vec3d> points_of(std::size_t i) const;

    /// What a start that is not at infinity sends in a direction: W·sr⁻¹·nm⁻¹.
    [[nodiscard]] spectral::SpectralSample intensity(const LightStart& start, const Vec3d& direction) const;

    /// Draws the direction that a path goes on in; of light from infinity, where it crosses the scene.
    [[nodiscard]] EmittedRay leave(const LightStart& start, double u1, double u2) const;

    /// From a start to a surface point that it shines on.
    [[nodiscard]] FirstSegment first_segment(const LightStart& start, const Vec3d& to) const;

    /// How far from a point all of the scene lies behind, whatever the direction.
    [[nodiscard]] double beyond_mm(const Vec3d& point) const {
        return length(point - centre_) + 2.0 * radius_mm_ + 1.0;
    }

    /// W·nm⁻¹, the mean over the grid, that all lights send into the scene: what the choice goes by.
    [[nodiscard]] double power() const { return power_; }

  private:
    static constexpr std::size_t kMostWeighed = 64;  // lights, of which each is asked for at every point
    struct Entry {
        LightSource light;
        std::optional<ShiningSurface> surface;  // of an area light
        double probability = 0.0;
        std::optional<Vec3d> middle;     // none: at infinity
        std::optional<Vec3d> direction;  // to one at infinity; none: near, or all about
        double extent2_mm2 = 0.0;        // squared: from nearer than this it counts as from there
        double irradiance = 0.0;         // of light from one direction, on what faces it; of a near one times mm²

        /// By its middle, if nothing stands in the way. No irradiance: it is all about.
        struct Seen {
            Vec3d direction;
            double irradiance = 0.0;
        };
        [[nodiscard]] Seen seen_from(const Vec3d& point) const;
        [[nodiscard]] bool is_directed() const { return middle || direction; }
    };
    struct Chosen {
        const Entry* entry = nullptr;
        double probability = 0.0;
        double rest = 0.0;  // of the number that chose it, uniform again
    };
    [[nodiscard]] Chosen choose(double u) const;
    [[nodiscard]] LightStart start_at(const Chosen& chosen, const spectral::PathWavelengths& path, double u1,
                                      double u2) const;
    /// Nine times out of ten by these weights of lights that have a direction, else by power: none is left out for
    /// being judged by its middle alone. Lights all about are drawn by power.
    [[nodiscard]] Chosen choose(double u, std::span<const double> weights) const;
    [[nodiscard]] std::optional<LightSample> sample_of(const Chosen& chosen, const Vec3d& point,
                                                       const spectral::PathWavelengths& path,
                                                       const LightNumbers& numbers) const;
    [[nodiscard]] Emission at_infinity(const Entry& entry, const Vec3d& direction, const MapPlace& ahead,
                                       const spectral::PathWavelengths& path) const;

    std::vector<Entry> lights_;
    std::vector<double> cumulative_;          // of the probabilities
    std::vector<std::int32_t> of_object_;     // the area light of each object, or −1
    std::vector<std::uint32_t> at_infinity_;  // indices
    std::vector<std::uint32_t> suns_;         // indices
    const Environment* map_ = nullptr;        // of the first light among these that is one
    Vec3d centre_;                            // of a sphere around the scene
    double radius_mm_ = 0.0;
    double crossing_pdf_ = 0.0;  // 1/mm²: of light paths from infinity over the disc in front of the scene
    double power_ = 0.0;
    double directed_ = 0.0;  // fraction of lights that are not all about
};

}  // namespace lensproof::scene
