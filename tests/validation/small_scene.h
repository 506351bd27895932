// tests/validation/small_scene.h — scenes of a few diffuse objects, as tests put them together.
#pragma once
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "engine/scene/scene.h"

namespace lensproof {

/// Objects of one albedo each, and lights.
struct SceneParts {
    std::vector<Shape> shapes;
    std::vector<SceneObject> objects;
    std::vector<double> albedos;
    std::vector<Light> lights;

    /// Returns the object's index.
    std::uint32_t add(Shape shape, const AffineMap& to_world, double albedo) {
        const auto index = static_cast<std::uint32_t>(objects.size());
        shapes.push_back(std::move(shape));
        objects.push_back({.shape = index, .to_world = to_world, .material = index});
        albedos.push_back(albedo);
        return index;
    }

    [[nodiscard]] Scene scene(const SpectralGrid& grid) const {
        Scene made{
            .grid = grid, .geometry = std::make_unique<SceneGeometry>(shapes, objects), .materials = {}, .lights = {}};
        for (const double albedo : albedos) {
            made.materials.push_back({.surface = DiffuseMaterial{constant_spectrum(albedo, grid)}, .radiance = {}});
        }
        made.lights = Lights(*made.geometry, lights);
        return made;
    }
};

}  // namespace lensproof
