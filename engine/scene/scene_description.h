// engine/scene/scene_description.h — a scene as a file states it: values that name what is meant, checked, but nothing
// looked up or loaded. `engine/scene/README.md` documents every key.
#pragma once
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/base/affine.h"
#include "engine/scene/chart/chart.h"
#include "engine/scene/geometry/geometry.h"
#include "engine/scene/geometry/mesh_file.h"
#include "engine/scene/geometry/shapes.h"
#include "engine/scene/light/light_file.h"
#include "engine/scene/material/material_file.h"

namespace lensproof::scene {

// --- Objects -------------------------------------------------------------------------------------------------------

struct MeshFromFile {
    std::filesystem::path file;
    MeshOptions options;
    double cd_m2_per_unit = 1.0;  // of what the file's own materials emit
};

/// A chart on a quad that is large enough for its pattern and a margin.
struct ChartOnQuad {
    Chart chart;
    Quad quad;
};

/// Another object's shape, by its index, which is below the object's own and no instance itself.
struct InstanceOf {
    std::size_t object = 0;
};

/// A `TriangleMesh` is a polygon that the file spells out.
using ShapeDescription = std::variant<MeshFromFile, Sphere, Quad, ChartOnQuad, InstanceOf, TriangleMesh>;

struct ObjectDescription {
    std::string name;  // may be empty
    ShapeDescription shape;
    AffineMap to_world;
    /// An index of `SceneDescription::materials`. Nothing: a chart that is its own material, with its two reflectances,
    /// or a glTF file's mesh with the file's materials (`MeshOptions::by_material`).
    std::optional<std::size_t> material;
    std::string where;
};

struct SceneDescription {
    std::vector<MaterialDescription> materials;
    std::vector<ObjectDescription> objects;
    std::vector<LightDescription> lights;
    HitPrecision precision = HitPrecision::in_double;

    /// A mesh or a polygon: without one the precision changes nothing.
    [[nodiscard]] bool has_triangles() const {
        return std::ranges::any_of(objects, [](const ObjectDescription& object) {
            return std::holds_alternative<MeshFromFile>(object.shape) ||
                   std::holds_alternative<TriangleMesh>(object.shape);
        });
    }
};

}  // namespace lensproof::scene
