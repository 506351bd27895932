// engine/scene/scene_shapes.h — the surfaces of a described scene, loaded.
#pragma once
#include <string>
#include <vector>

#include "engine/scene/geometry/geometry.h"
#include "engine/scene/scene_description.h"

namespace lensproof::scene {

/// What `SceneGeometry` is made of.
struct SceneShapes {
    std::vector<Shape> shapes;
    /// One for each object of the description, in its order. `material` is the description's index, or, for the k-th of
    /// `own_charts`, the number of materials + k.
    std::vector<SceneObject> objects;
    std::vector<std::size_t> own_charts;  // objects that are charts without another material
    std::vector<std::string> remarks;     // what of the mesh files is not used
};

/// Loads the meshes, each once: objects that are the same file with the same options share a shape, and so do
/// instances. Throws InputError for what `read_mesh` refuses.
SceneShapes load_shapes(const SceneDescription& scene);

}  // namespace lensproof::scene
