// engine/scene/light/area_light.h — an object that shines.
#pragma once
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>

#include "engine/base/kinds.h"
#include "engine/base/toml_keys.h"
#include "engine/scene/geometry/surface_sampler.h"
#include "engine/scene/light/light_maker.h"
#include "engine/scene/light/light_sample.h"

namespace lensproof::scene {

/// A surface that shines in every direction on its outward side, or on both: evenly, or as a picture over its uvs.
struct AreaLight {
    std::uint32_t object = 0;
    spectral::GridSpectrum radiance;  // unused with a picture
    bool is_two_sided = false;
    std::shared_ptr<const ImageTexture> picture;

    [[nodiscard]] spectral::SpectralSample radiance_at(const Vec2d& uv, const spectral::PathWavelengths& path) const {
        return picture != nullptr ? value_at(*picture, uv, path) : radiance(path);
    }

    [[nodiscard]] double sides() const { return is_two_sided ? 2.0 : 1.0; }
    /// Per etendue, of a light path from a point that is drawn with this pdf per mm²: by the cosine about the normal,
    /// from each of the sides.
    [[nodiscard]] double leaving_pdf(double per_mm2) const { return per_mm2 / (sides() * std::numbers::pi); }
};

/// The surface of an area light, as points see it: points are drawn evenly over it, and of a sphere by the cone that a
/// point has of it.
class ShiningSurface {
  public:
    /// `scene` has to outlive it.
    ShiningSurface(const SceneGeometry& scene, const AreaLight& light);

    [[nodiscard]] const SurfaceSampler& sampler() const { return sampler_; }
    /// W·nm⁻¹, the mean over the grid; of a picture about, and never 0 where it shines anywhere.
    [[nodiscard]] double power(const AreaLight& light) const;
    /// A point of it as `point` sees it; nothing where it shows its dark side.
    [[nodiscard]] std::optional<LightSample> sample(const AreaLight& light, const Vec3d& point,
                                                    const spectral::PathWavelengths& path,
                                                    const LightNumbers& numbers) const;
    /// Draws what these numbers draw of it for these points, as `sample` would, together; nothing where it is not made
    /// of a few flat pieces.
    void draw_ahead(std::span<const Vec3d> points, std::span<LightNumbers> numbers) const;
    /// With which `sample` draws the point `at` from `from`; `per_mm2`: with which `sampler` does, `cosine`: that of
    /// the light's direction there.
    [[nodiscard]] double pdf(const Vec3d& at, double per_mm2, const Vec3d& from, double cosine) const;
    /// Whether points at `from` draw by the cone. Nearer ones than a millionth of the radius squared see nearly half
    /// of the sphere, and draw by its area.
    [[nodiscard]] bool is_seen_as_cone(const Vec3d& from) const;

  private:
    struct Ball {
        Vec3d centre;
        double radius_mm = 0.0;
    };
    [[nodiscard]] double mean_radiance(const AreaLight& light) const;
    static ShiningFacets facets_of(const SurfaceSampler& sampler);
    static std::optional<Ball> ball_of(const SceneGeometry& scene, const AreaLight& light);

    SurfaceSampler sampler_;
    ShiningFacets facets_;      // of one that is even, and has few
    std::optional<Ball> ball_;  // of one that is a sphere in the world, and shines outwards alone
};

struct AreaLightDescription {
    static constexpr KindNames<> kNames{"area"};
    std::size_t object = 0;
    EmissionDescription emission;
    bool is_two_sided = false;
};

inline void read_keys(AreaLightDescription& light, TomlTable& table, const NameIndex& objects) {
    light.object = objects.find(table, "object");
    light.emission = read_emission(table);
    light.is_two_sided = table.boolean_or("two_sided", false);
}

inline void check_beside(const AreaLightDescription& light, const AreaLightDescription& earlier,
                         const std::string& where_earlier, const TomlTable& table) {
    if (light.object == earlier.object) {
        table.fail("object", "shines already, by " + where_earlier);
    }
}

inline AreaLight make_light(const AreaLightDescription& light, const LightMaker& maker) {
    return {.object = static_cast<std::uint32_t>(light.object),
            .radiance = maker.radiance(light.emission),
            .is_two_sided = light.is_two_sided};
}

}  // namespace lensproof::scene
