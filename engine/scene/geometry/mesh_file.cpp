#include "engine/scene/geometry/mesh_file.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <assimp/Importer.hpp>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <set>
#include <system_error>

#include "engine/base/affine.h"
#include "engine/base/confined.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/scene/geometry/confined_mesh.h"
#include "engine/scene/geometry/gltf_check.h"
#include "engine/scene/geometry/mesh_normals.h"
#include "engine/scene/geometry/ply_check.h"

namespace lensproof::scene {

namespace {

constexpr std::size_t kMost = std::size_t{1} << 31;
/// With meshes that stand there more than once, each time for itself: a gigabyte of positions and normals.
constexpr std::size_t kMostRepeated = std::size_t{1} << 25;

bool is_gltf(const std::filesystem::path& file) {
    const std::string extension = lower_extension(file);
    return extension == ".gltf" || extension == ".glb";
}

AffineMap affine(const aiMatrix4x4& m) {
    return {.linear = {Vec3d{m.a1, m.a2, m.a3}, Vec3d{m.b1, m.b2, m.b3}, Vec3d{m.c1, m.c2, m.c3}},
            .translation = {m.a4, m.b4, m.c4}};
}

Vec3d vector(const aiVector3D& v) {
    return {v.x, v.y, v.z};
}

bool is_of_triangles(const aiMesh& mesh) {
    return (mesh.mPrimitiveTypes & static_cast<unsigned>(aiPrimitiveType_TRIANGLE)) != 0;
}

/// Whether one of the scene's meshes of triangles is as asked.
template <class Asks>
bool has(const aiScene& scene, const Asks& asks) {
    return std::any_of(scene.mMeshes, scene.mMeshes + scene.mNumMeshes,
                       [&](const aiMesh* mesh) { return is_of_triangles(*mesh) && asks(*mesh); });
}

/// Puts the meshes of a tree of nodes together.
class Collector {
  public:
    Collector(const aiScene& scene, const MeshOptions& options, TriangleMesh& mesh)
        : scene_(&scene),
          options_(options),
          mesh_(&mesh),
          // A mesh without normals among others that have them gets flat ones; without uvs, uvs of nothing.
          with_normals_(
              options.normals == MeshNormals::smooth ||
              (options.normals == MeshNormals::file && has(scene, [](const aiMesh& m) { return m.HasNormals(); }))),
          with_uvs_(has(scene, [](const aiMesh& m) { return m.HasTextureCoords(0); })) {}

    void collect(const aiNode& node, const AffineMap& above, bool is_meant) {
        const AffineMap map = composed(above, affine(node.mTransformation));
        const bool node_is_meant = is_meant || is_part(node.mName);
        for (unsigned i = 0; i < node.mNumMeshes; ++i) {
            const aiMesh& mesh = *scene_->mMeshes[node.mMeshes[i]];
            if (node_is_meant || is_part(mesh.mName)) {
                add(mesh, map);
            }
        }
        for (unsigned i = 0; i < node.mNumChildren; ++i) {
            collect(*node.mChildren[i], map, node_is_meant);
        }
    }

    [[nodiscard]] const std::set<std::string>& part_names() const { return names_; }
    [[nodiscard]] std::size_t lines_and_points() const { return lines_and_points_; }

  private:
    bool is_part(const aiString& name) {
        names_.insert(name.C_Str());
        return options_.part.empty() || options_.part == name.C_Str();
    }

    void add(const aiMesh& from, const AffineMap& map) {
        if (!is_of_triangles(from)) {
            lines_and_points_ += from.mNumFaces;
            return;
        }
        if (mesh_->positions.size() + 3 * std::size_t{from.mNumFaces} > kMost) {
            throw InputError(fmt::format("{}: holds more than {} vertices", mesh_->name, kMost));
        }
        if (!added_.insert(&from).second && mesh_->positions.size() + from.mNumVertices > kMostRepeated) {
            throw InputError(
                fmt::format("{}: repeats meshes until they have more than {} vertices, instances in the "
                            "scene file would share them",
                            mesh_->name, kMostRepeated));
        }
        TriangleMesh part = with_vertices(from, map);
        const bool is_mirrored = determinant(map.linear) < 0.0;
        for (unsigned i = 0; i < from.mNumFaces; ++i) {
            const unsigned* index = from.mFaces[i].mIndices;
            part.triangles.push_back({index[0], index[is_mirrored ? 2 : 1], index[is_mirrored ? 1 : 2]});
        }
        if (!with_normals_) {
            part.normals.clear();
        } else if (options_.normals == MeshNormals::smooth || part.normals.empty()) {
            part = with_smooth_normals(part, options_.normals == MeshNormals::smooth ? options_.crease_deg : 0.0);
        }
        append(part);
    }

    TriangleMesh with_vertices(const aiMesh& from, const AffineMap& map) const {
        TriangleMesh part;
        const std::optional<AffineMap> back = inverse(map);
        for (unsigned i = 0; i < from.mNumVertices; ++i) {
            part.positions.push_back(converted<float>(map_point(map, vector(from.mVertices[i]))));
            if (from.HasNormals()) {
                const Vec3d normal = vector(from.mNormals[i]);
                part.normals.push_back(
                    converted<float>(back ? normalized(transposed_times(back->linear, normal)) : normal));
            }
            if (with_uvs_) {
                const bool has_uv = from.HasTextureCoords(0);
                part.uvs.push_back(has_uv ? Vec2<float>{from.mTextureCoords[0][i].x, from.mTextureCoords[0][i].y}
                                          : Vec2<float>{});
            }
        }
        return part;
    }

    void append(const TriangleMesh& part) {
        const auto first = static_cast<std::uint32_t>(mesh_->positions.size());
        const auto add_all = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
        add_all(mesh_->positions, part.positions);
        add_all(mesh_->normals, part.normals);
        add_all(mesh_->uvs, part.uvs);
        for (const auto& [a, b, c] : part.triangles) {
            mesh_->triangles.push_back({first + a, first + b, first + c});
        }
    }

    const aiScene* scene_;
    MeshOptions options_;
    TriangleMesh* mesh_;
    bool with_normals_;
    bool with_uvs_;
    std::set<std::string> names_;
    std::set<const aiMesh*> added_;
    std::size_t lines_and_points_ = 0;
};

bool has_empty_faces(const aiScene& scene) {
    return std::any_of(scene.mMeshes, scene.mMeshes + scene.mNumMeshes, [](const aiMesh* mesh) {
        return std::any_of(mesh->mFaces, mesh->mFaces + mesh->mNumFaces,
                           [](const aiFace& face) { return face.mNumIndices == 0; });
    });
}

/// The files that Assimp opens, or tries to: a mesh's own, and those that it names, materials and buffers.
class RegularFiles : public Assimp::DefaultIOSystem {
  public:
    /// The first that is a device or a pipe; none is opened.
    [[nodiscard]] const std::filesystem::path& refused() const { return refused_; }

    [[nodiscard]] bool Exists(const char* file) const override {  // asked by opening it
        return is_regular(file) && DefaultIOSystem::Exists(file);
    }

    Assimp::IOStream* Open(const char* file, const char* mode) override {
        return is_regular(file) ? DefaultIOSystem::Open(file, mode) : nullptr;
    }

  private:
    bool is_regular(const char* file) const {
        std::error_code error;
        const std::filesystem::file_status status = std::filesystem::status(file, error);
        const bool is_refused = std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
                                !std::filesystem::is_directory(status);
        if (is_refused && refused_.empty()) {
            refused_ = file;
        }
        return std::filesystem::is_regular_file(status);
    }

    mutable std::filesystem::path refused_;
};

const aiScene& read_scene(Assimp::Importer& importer, const std::filesystem::path& file) {
    const auto refuse = [&](std::string_view reason) {
        throw InputError(fmt::format("{}: cannot be read as {}: {}", file.string(), lower_extension(file).substr(1),
                                     printable(trimmed(reason))));
    };
    auto* files = new RegularFiles;
    importer.SetIOHandler(files);  // which it then owns
    const aiScene* scene = nullptr;
    try {
        if (lower_extension(file) == ".ply") {
            check_ply(read_file(file), file);
        } else if (is_gltf(file)) {
            check_gltf(file);
        }
        scene = importer.ReadFile(file.string(), aiProcess_ValidateDataStructure);
        if (scene != nullptr && has_empty_faces(*scene)) {
            refuse("a face without corners");  // which ends the program in Assimp's cutting of polygons
        }
        scene = scene == nullptr ? nullptr
                                 : importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_SortByPType |
                                                                aiProcess_JoinIdenticalVertices);
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {  // of a library that meets counts that cannot be
        refuse(error.what());
    }
    if (!files->refused().empty()) {
        throw InputError(fmt::format("{}: names {}, a device or a pipe, expected a file", file.string(),
                                     printable(files->refused().string())));
    }
    if (scene == nullptr || scene->mRootNode == nullptr) {
        refuse(importer.GetErrorString());
    }
    return *scene;
}

std::vector<std::string> ignored(const std::string& name, const aiScene& scene, std::size_t lines_and_points) {
    std::vector<std::string> remarks;
    const auto remark = [&](std::size_t count, const char* what) {
        if (count > 0) {
            remarks.push_back(fmt::format("{}: {} {}", name, count, what));
        }
    };
    // Assimp makes up a material where a file has none.
    const auto made_up = std::count_if(scene.mMaterials, scene.mMaterials + scene.mNumMaterials, [](aiMaterial* m) {
        return m->GetName() == aiString(AI_DEFAULT_MATERIAL_NAME) || m->GetName().length == 0;
    });
    remark(scene.mNumMaterials - static_cast<std::size_t>(made_up), "materials are ignored: the scene file says them");
    remark(lines_and_points, "lines and points are left out");
    remark(scene.mNumLights, "lights are ignored: the scene file says them");
    remark(scene.mNumCameras, "cameras are ignored: the scene file says one");
    remark(scene.mNumAnimations, "animations are ignored");
    return remarks;
}

}  // namespace

MeshFile read_mesh(const std::filesystem::path& file, const MeshOptions& options) {
    return files_are_distrusted() ? read_mesh_confined(file, options) : read_mesh_here(file, options);
}

MeshFile read_mesh_here(const std::filesystem::path& file, const MeshOptions& options) {
    check_regular(file, "a mesh's file");
    const std::string extension = lower_extension(file);
    if (!is_gltf(file) && extension != ".obj" && extension != ".ply") {
        throw InputError(
            fmt::format("{}: is no form of mesh that is known, expected .gltf, .glb, .obj or .ply", file.string()));
    }
    Assimp::Importer importer;
    const aiScene& scene = read_scene(importer, file);
    MeshFile read{.mesh = {.name = file.string()}};
    Collector collector(scene, options, read.mesh);
    constexpr double kMetre = 1000.0;
    const double scale = options.mm_per_unit.value_or(is_gltf(file) ? kMetre : 1.0);
    const AffineMap to_mm{.linear = {Vec3d{scale, 0, 0}, Vec3d{0, scale, 0}, Vec3d{0, 0, scale}}};
    collector.collect(*scene.mRootNode, to_mm, false);
    if (read.mesh.triangles.empty()) {
        const std::string known = fmt::format("{}", fmt::join(collector.part_names(), ", "));
        throw InputError(options.part.empty() ? fmt::format("{}: holds no triangles", file.string())
                                              : fmt::format("{}: holds no triangles in a part '{}', the parts are: {}",
                                                            file.string(), options.part, printable(known)));
    }
    read.remarks = ignored(read.mesh.name, scene, collector.lines_and_points());
    return read;
}

}  // namespace lensproof::scene
