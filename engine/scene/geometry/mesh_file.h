// engine/scene/geometry/mesh_file.h — triangle meshes from the files of modelling programs, by Assimp.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/geometry/shapes.h"

namespace lensproof::scene {

enum class MeshNormals {
    file,    // as the file gives them; flat where it gives none
    flat,    // every triangle its own
    smooth,  // averaged over the triangles at a vertex that meet at less than the crease angle
};

inline constexpr double kGltfUnitMm = 1000.0;  // a metre

/// Whether its name says that the file is glTF.
bool is_gltf(const std::filesystem::path& file);

struct MeshOptions {
    /// mm in a unit of the file. Without: 1000 for glTF, whose unit is the metre, and 1 for OBJ and PLY, which have
    /// none.
    std::optional<double> mm_per_unit;
    /// The part of the file that is meant, by the name of a node or a mesh (an object or a group of OBJ); empty: all of
    /// it.
    std::string part;
    MeshNormals normals = MeshNormals::file;
    double crease_deg = 30.0;
    /// Of glTF: a mesh for each material, with the uvs that its pictures are laid out by.
    bool by_material = false;
};

/// What of a glTF file is of one material.
struct MeshPart {
    TriangleMesh mesh;
    std::size_t material = 0;  // an index of `GltfMaterials::materials`; their number for what has none
};

struct MeshFile {
    TriangleMesh mesh;                 // all that is meant, as one, in mm; nothing where it is asked for by material
    std::vector<MeshPart> parts;       // then these
    std::vector<std::string> remarks;  // what of the file is not used, a sentence each
};

/// Reads a glTF (.gltf, .glb), OBJ or PLY file: its triangles, and its polygons cut into triangles, each where the
/// file's tree of nodes places it. uvs have v upwards whatever the form. Lines, points, cameras, lights and animations
/// are left out, and named in the remarks; so are materials where they are not asked for, and vertices' colours where
/// they are. What materials are is not read here (mesh_material.h).
///
/// Throws InputError naming the file: missing, another extension, damaged or truncated where the form lets one see it,
/// larger than 256 MiB (PLY), no triangles, no such part, more than 2³¹ vertices; as read_gltf_materials does. A
/// triangle of glTF whose indices lead beyond its vertices is left out by Assimp, without a word. The mesh still has to
/// be repaired, as `SceneGeometry` does.
///
/// Where files are distrusted (engine/base/confined.h), a confined process reads it, and what lies beside it.
MeshFile read_mesh(const std::filesystem::path& file, const MeshOptions& options = {});

/// The same in this process, whatever its file is.
MeshFile read_mesh_here(const std::filesystem::path& file, const MeshOptions& options);

}  // namespace lensproof::scene
