// engine/scene/scene_shapes.h — the surfaces of a described scene, loaded.
#pragma once
#include <string>
#include <vector>

#include "engine/scene/geometry/geometry.h"
#include "engine/scene/scene_description.h"

namespace lensproof::scene {

/// An object that is made of what its glTF file says.
struct OwnMaterial {
    std::size_t object = 0;              // of `SceneShapes::objects`
    const MeshFromFile* mesh = nullptr;  // of the description
    std::size_t material = 0;            // as `MeshPart::material`
};

/// What `SceneGeometry` is made of.
struct SceneShapes {
    std::vector<Shape> shapes;
    /// One for each object of the description, in its order; of a mesh with its file's materials one for each of these.
    /// `material` is the description's index, or, for the k-th of `own_charts`, the number of materials + k; of
    /// `own_materials` it is not yet known.
    std::vector<SceneObject> objects;
    std::vector<std::size_t> first_object;  // of each of the description's, and behind them how many there are
    std::vector<std::size_t> own_charts;    // of the description: charts without another material
    std::vector<OwnMaterial> own_materials;
    std::vector<std::string> remarks;  // what of the mesh files is not used
};

/// Loads the meshes, each once: objects that are the same file with the same options share a shape, and so do
/// instances. Throws InputError for what `read_mesh` refuses.
SceneShapes load_shapes(const SceneDescription& scene);

}  // namespace lensproof::scene
