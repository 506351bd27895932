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
            loaded_.first_object.push_back(loaded_.objects.size());
            const auto* instance = std::get_if<InstanceOf>(&object.shape);
            const ShapeDescription& shape =
                instance != nullptr ? scene_->objects[instance->object].shape : object.shape;
            parts_.push_back(std::visit([&](const auto& described) { return add(described); }, object.shape));
            for (const Part& part : parts_.back()) {
                if (!object.material && part.material) {
                    loaded_.own_materials.push_back(
                        {loaded_.objects.size(), &std::get<MeshFromFile>(shape), *part.material});
                }
                loaded_.objects.push_back({.shape = part.shape,
                                           .to_world = object.to_world,
                                           .material = material_of(object, part.material.has_value())});
            }
        }
        loaded_.first_object.push_back(loaded_.objects.size());
        return std::move(loaded_);
    }

  private:
    /// A shape, and the material that its file says.
    struct Part {
        std::uint32_t shape = 0;
        std::optional<std::size_t> material;
    };
    using Parts = std::vector<Part>;

    std::uint32_t push(Shape shape) {
        loaded_.shapes.push_back(std::move(shape));
        return static_cast<std::uint32_t>(loaded_.shapes.size() - 1);
    }

    Parts add(const MeshFromFile& mesh) {
        const MeshOptions& o = mesh.options;
        const auto [place, is_new] = files_.try_emplace(
            {mesh.file.lexically_normal().string(), o.part, o.mm_per_unit, o.normals, o.crease_deg, o.by_material},
            Parts());
        if (is_new) {
            MeshFile read = read_mesh(mesh.file, o);
            std::ranges::move(read.remarks, std::back_inserter(loaded_.remarks));
            for (MeshPart& part : read.parts) {
                place->second.push_back({push(std::move(part.mesh)), part.material});
            }
            if (!o.by_material) {
                place->second.push_back({push(std::move(read.mesh)), std::nullopt});
            }
        }
        return place->second;
    }
    Parts add(const ChartOnQuad& chart) { return {{push(chart.quad), std::nullopt}}; }
    Parts add(const InstanceOf& instance) { return parts_[instance.object]; }
    Parts add(const auto& shape) { return {{push(shape), std::nullopt}}; }

    std::uint32_t material_of(const ObjectDescription& object, bool is_the_files) {
        if (object.material || is_the_files) {
            return static_cast<std::uint32_t>(object.material.value_or(0));
        }
        loaded_.own_charts.push_back(parts_.size() - 1);
        return static_cast<std::uint32_t>(scene_->materials.size() + loaded_.own_charts.size() - 1);
    }

    const SceneDescription* scene_;
    SceneShapes loaded_;
    std::vector<Parts> parts_;  // of each object so far
    std::map<std::tuple<std::string, std::string, std::optional<double>, MeshNormals, double, bool>, Parts> files_;
};

}  // namespace

SceneShapes load_shapes(const SceneDescription& scene) {
    return Loader(scene).load();
}

}  // namespace lensproof::scene
