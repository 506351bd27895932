// tests/validation/small_scene.h — scenes of a few objects, as tests put them together.
#pragma once
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "engine/scene/scene.h"

namespace lensproof {

/// Objects, each of its own material, and lights.
class SceneParts {
  public:
    explicit SceneParts(const spectral::SpectralGrid& grid) : grid_(grid) {}

    /// Returns the object's index.
    std::uint32_t add(scene::Shape shape, const AffineMap& to_world, scene::Material material) {
        const auto index = static_cast<std::uint32_t>(objects.size());
        shapes.push_back(std::move(shape));
        objects.push_back({.shape = index, .to_world = to_world, .material = index});
        materials.push_back(std::move(material));
        return index;
    }

    /// A diffuse one.
    std::uint32_t add(scene::Shape shape, const AffineMap& to_world, double albedo) {
        return add(std::move(shape), to_world,
                   scene::Material{scene::DiffuseMaterial{spectral::constant_spectrum(albedo, grid_)}});
    }

    [[nodiscard]] scene::Scene scene() const {
        scene::Scene made{.grid = grid_,
                          .geometry = std::make_unique<scene::SceneGeometry>(shapes, objects),
                          .materials = materials,
                          .absorption = {},
                          .lights = {}};
        made.lights = scene::Lights(*made.geometry, lights);
        return made;
    }

    std::vector<scene::Shape> shapes;
    std::vector<scene::SceneObject> objects;
    std::vector<scene::Material> materials;
    std::vector<scene::LightSource> lights;

  private:
    spectral::SpectralGrid grid_;
};

}  // namespace lensproof
