#include "engine/scene/geometry/mesh_file.h"

#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <system_error>

#include "engine/base/affine.h"
#include "engine/base/confined.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/scene/geometry/confined_mesh.h"
#include "engine/scene/geometry/gltf_check.h"
#include "engine/scene/geometry/mesh_material.h"
#include "engine/scene/geometry/mesh_normals.h"
#include "engine/scene/geometry/obj_check.h"
#include "engine/scene/geometry/ply_check.h"

namespace lensproof::scene {

namespace {

constexpr std::size_t kMost = std::size_t{1} << 31;
/// With meshes that stand there more than once, each time for itself: a gigabyte of positions and normals.
constexpr std::size_t kMostRepeated = std::size_t{1} << 25;

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
    /// `materials`: what they are, where parts are asked for by material.
    Collector(const aiScene& scene, const MeshOptions& options, const std::vector<MeshMaterial>& materials,
              std::string name)
        : scene_(&scene),
          options_(options),
          materials_(&materials),
          name_(std::move(name)),
          // A mesh without normals among others that have them gets flat ones; without uvs, uvs of nothing.
          with_normals_(
              options.normals == MeshNormals::smooth ||
              (options.normals == MeshNormals::file && has(scene, [](const aiMesh& m) { return m.HasNormals(); }))),
          with_uvs_(options.by_material || has(scene, [](const aiMesh& m) { return m.HasTextureCoords(0); })) {}

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

    /// By their materials; of all of them one, of material 0, where parts are not asked for.
    [[nodiscard]] std::map<std::size_t, TriangleMesh> take() { return std::move(meshes_); }
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
        if (vertices_ + 3 * std::size_t{from.mNumFaces} > kMost) {
            throw InputError(fmt::format("{}: holds more than {} vertices", name_, kMost));
        }
        if (!added_.insert(&from).second && vertices_ + from.mNumVertices > kMostRepeated) {
            throw InputError(
                fmt::format("{}: repeats meshes until they have more than {} vertices, instances in the "
                            "scene file would share them",
                            name_, kMostRepeated));
        }
        const std::size_t material = material_of(from);
        const UvMap uv = material < materials_->size() ? (*materials_)[material].uv : UvMap();
        TriangleMesh part = with_vertices(from, map, uv);
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
        append(part, meshes_[material]);
    }

    /// By the name that gltf_with_numbered_materials has given it; one that Assimp made up has none.
    std::size_t material_of(const aiMesh& mesh) const {
        if (!options_.by_material) {
            return 0;
        }
        const std::string name = scene_->mMaterials[mesh.mMaterialIndex]->GetName().C_Str();
        std::size_t index = materials_->size();
        std::from_chars(name.data(), name.data() + name.size(), index);
        return std::min(index, materials_->size());
    }

    TriangleMesh with_vertices(const aiMesh& from, const AffineMap& map, const UvMap& uv) const {
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
                const bool has_uv = from.HasTextureCoords(uv.set);
                const aiVector3D at = has_uv ? from.mTextureCoords[uv.set][i] : aiVector3D();
                part.uvs.push_back(uv == UvMap() || !has_uv ? Vec2<float>{at.x, at.y} : mapped(uv, {at.x, at.y}));
            }
        }
        return part;
    }

    void append(const TriangleMesh& part, TriangleMesh& to) {
        const auto first = static_cast<std::uint32_t>(to.positions.size());
        const auto add_all = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
        add_all(to.positions, part.positions);
        add_all(to.normals, part.normals);
        add_all(to.uvs, part.uvs);
        for (const auto& [a, b, c] : part.triangles) {
            to.triangles.push_back({first + a, first + b, first + c});
        }
        to.name = name_;
        vertices_ += part.positions.size();
    }

    const aiScene* scene_;
    MeshOptions options_;
    const std::vector<MeshMaterial>* materials_;
    std::string name_;
    std::map<std::size_t, TriangleMesh> meshes_;
    std::size_t vertices_ = 0;  // of all of them
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
    /// `instead`: what `file` reads as, if that is not what it holds; outlives it.
    RegularFiles(const std::filesystem::path& file, const std::optional<std::string>& instead)
        : file_(file), instead_(instead) {}

    /// The first that is a device or a pipe; none is opened.
    [[nodiscard]] const std::filesystem::path& refused() const { return refused_; }

    [[nodiscard]] bool Exists(const char* file) const override {  // asked by opening it
        return is_regular(file) && DefaultIOSystem::Exists(file);
    }

    Assimp::IOStream* Open(const char* file, const char* mode) override {
        if (instead_ && file_ == file) {
            return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(instead_->data()),
                                              instead_->size());
        }
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

    std::filesystem::path file_;
    const std::optional<std::string>& instead_;
    mutable std::filesystem::path refused_;
};

/// Leaves the importer the one reader of such files: where that makes nothing of a file, Assimp would ask all others,
/// of which any may find something in it that it takes for its own kind. Of glTF that is version 2's: the reader of
/// version 1 takes a buffer for as long as an accessor says.
void keep_reader(Assimp::Importer& importer, const std::string& extension) {
    for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
        const aiImporterDesc& reader = *importer.GetImporterInfo(i);
        const std::vector<std::string_view> extensions = words_of(reader.mFileExtensions);
        const bool is_known = std::ranges::find(extensions, extension.substr(1)) != extensions.end();
        const bool is_version_1 = is_known && extension.starts_with(".gl") && !std::strchr(reader.mName, '2');
        if (!is_known || is_version_1) {
            const std::unique_ptr<Assimp::BaseImporter> unused(importer.GetImporter(i));
            importer.UnregisterLoader(unused.get());
        }
    }
}

const aiScene& read_scene(Assimp::Importer& importer, const std::filesystem::path& file,
                          const std::optional<std::string>& instead) {
    const auto refuse = [&](std::string_view reason) {
        throw InputError(fmt::format("{}: cannot be read as {}: {}", file.string(), lower_extension(file).substr(1),
                                     printable(trimmed(reason))));
    };
    auto* files = new RegularFiles(file, instead);
    importer.SetIOHandler(files);  // which it then owns
    keep_reader(importer, lower_extension(file));
    const aiScene* scene = nullptr;
    try {
        if (is_gltf(file)) {
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

std::vector<std::string> ignored(const std::string& name, const aiScene& scene, const MeshOptions& options,
                                 std::size_t lines_and_points) {
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
    if (options.by_material) {
        const auto coloured = std::count_if(scene.mMeshes, scene.mMeshes + scene.mNumMeshes,
                                            [](const aiMesh* mesh) { return mesh->HasVertexColors(0); });
        remark(static_cast<std::size_t>(coloured), "meshes have colours at their vertices, which are ignored");
    } else {
        remark(scene.mNumMaterials - static_cast<std::size_t>(made_up),
               "materials are ignored: the scene file says them");
    }
    remark(lines_and_points, "lines and points are left out");
    remark(scene.mNumLights, "lights are ignored: the scene file says them");
    remark(scene.mNumCameras, "cameras are ignored: the scene file says one");
    remark(scene.mNumAnimations, "animations are ignored");
    return remarks;
}

}  // namespace

bool is_gltf(const std::filesystem::path& file) {
    const std::string extension = lower_extension(file);
    return extension == ".gltf" || extension == ".glb";
}

MeshFile read_mesh(const std::filesystem::path& file, const MeshOptions& options) {
    if (!files_are_distrusted()) {
        return read_mesh_here(file, options);
    }
    if (is_gltf(file)) {
        for (const std::filesystem::path& buffer : gltf_references(file, false)) {
            check_reference(file, buffer);
        }
    }
    return read_mesh_confined(file, options);
}

MeshFile read_mesh_here(const std::filesystem::path& file, const MeshOptions& options) {
    check_regular(file, "a mesh's file");
    const std::string extension = lower_extension(file);
    if (!is_gltf(file) && extension != ".obj" && extension != ".ply") {
        throw InputError(
            fmt::format("{}: is no form of mesh that is known, expected .gltf, .glb, .obj or .ply", file.string()));
    }
    const bool by_material = options.by_material && is_gltf(file);
    const std::vector<MeshMaterial> materials =
        by_material ? read_gltf_materials(file).materials : std::vector<MeshMaterial>();
    std::optional<std::string> instead;
    std::size_t lines_and_points = 0;
    if (extension == ".obj") {
        CheckedObj obj = checked_obj(read_file(file), file);
        instead = std::move(obj.text);
        lines_and_points = obj.lines_and_points;
    } else if (extension == ".ply") {
        instead = checked_ply(read_file(file), file);
    } else if (by_material) {
        instead = gltf_with_numbered_materials(file);
    }
    Assimp::Importer importer;
    const aiScene& scene = read_scene(importer, file, instead);
    Collector collector(scene, options, materials, file.string());
    const double scale = options.mm_per_unit.value_or(is_gltf(file) ? kGltfUnitMm : 1.0);
    const AffineMap to_mm{.linear = {Vec3d{scale, 0, 0}, Vec3d{0, scale, 0}, Vec3d{0, 0, scale}}};
    collector.collect(*scene.mRootNode, to_mm, false);
    std::map<std::size_t, TriangleMesh> meshes = collector.take();
    if (meshes.empty()) {
        const std::string known = fmt::format("{}", fmt::join(collector.part_names(), ", "));
        throw InputError(options.part.empty() ? fmt::format("{}: holds no triangles", file.string())
                                              : fmt::format("{}: holds no triangles in a part '{}', the parts are: {}",
                                                            file.string(), options.part, printable(known)));
    }
    MeshFile read{.mesh = {.name = file.string()},
                  .parts = {},
                  .remarks = ignored(file.string(), scene, options, lines_and_points + collector.lines_and_points())};
    for (auto& [material, mesh] : meshes) {
        if (options.by_material) {
            read.parts.push_back({std::move(mesh), material});
        } else {
            read.mesh = std::move(mesh);
        }
    }
    return read;
}

}  // namespace lensproof::scene
