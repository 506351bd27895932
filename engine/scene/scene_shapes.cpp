#include "engine/scene/scene_shapes.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

namespace lensproof::scene {

namespace {

class Loader {
  public:
    explicit Loader(const SceneDescription& scene) : scene_(&scene) {}

    SceneShapes load() {
        for (const ObjectDescription& object : scene_->objects) {
            const std::uint32_t shape = std::visit([&](const auto& described) { return add(described); }, object.shape);
            loaded_.objects.push_back({.shape = shape, .to_world = object.to_world, .material = material_of(object)});
        }
        return std::move(loaded_);
    }

  private:
    std::uint32_t push(Shape shape) {
        loaded_.shapes.push_back(std::move(shape));
        return static_cast<std::uint32_t>(loaded_.shapes.size() - 1);
    }

    std::uint32_t add(const MeshFromFile& mesh) {
        const MeshOptions& o = mesh.options;
        const auto [place, is_new] = files_.try_emplace(
            {mesh.file.lexically_normal().string(), o.part, o.mm_per_unit, o.normals, o.crease_deg}, 0);
        if (is_new) {
            MeshFile read = read_mesh(mesh.file, o);
            std::ranges::move(read.remarks, std::back_inserter(loaded_.remarks));
            place->second = push(std::move(read.mesh));
        }
        return place->second;
    }
    std::uint32_t add(const ChartOnQuad& chart) { return push(chart.quad); }
    std::uint32_t add(const InstanceOf& instance) { return loaded_.objects[instance.object].shape; }
    std::uint32_t add(const auto& shape) { return push(shape); }

    std::uint32_t material_of(const ObjectDescription& object) {
        if (object.material) {
            return static_cast<std::uint32_t>(*object.material);
        }
        loaded_.own_charts.push_back(loaded_.objects.size());
        return static_cast<std::uint32_t>(scene_->materials.size() + loaded_.own_charts.size() - 1);
    }

    const SceneDescription* scene_;
    SceneShapes loaded_;
    std::map<std::tuple<std::string, std::string, std::optional<double>, MeshNormals, double>, std::uint32_t> files_;
};

}  // namespace

SceneShapes load_shapes(const SceneDescription& scene) {
    return Loader(scene).load();
}

}  // namespace lensproof::scene
