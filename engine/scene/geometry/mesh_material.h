// engine/scene/geometry/mesh_material.h — what glTF files say that their surfaces are made of.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/vec.h"

namespace lensproof::scene {

/// What lies beyond a picture's edge: the picture again, its edge's pixels for ever, or the picture's mirror image.
enum class MeshWrap : std::uint8_t { repeat, clamp, mirror };

/// Which of a mesh's uvs a material's pictures are laid out by, and what happens to them first
/// (KHR_texture_transform): scaled, turned counter-clockwise, moved; in glTF's own uv, whose v runs downwards.
struct UvMap {
    std::uint32_t set = 0;
    Vec2d offset;
    Vec2d scale{1.0, 1.0};
    double turn = 0.0;  // rad
    friend bool operator==(const UvMap&, const UvMap&) = default;
};

/// uv with v upwards, as a mesh has them, and as they come out.
Vec2<float> mapped(const UvMap& map, const Vec2<float>& uv);

/// A picture on a surface.
struct MeshTexture {
    std::size_t picture = 0;  // an index of `GltfMaterials::pictures`
    MeshWrap wrap_u = MeshWrap::repeat;
    MeshWrap wrap_v = MeshWrap::repeat;
};

/// The metallic-roughness material of glTF 2.0 (§3.9, Appendix B) with KHR_materials_transmission, _ior, _volume and
/// _emissive_strength. Numbers in [0, 1] where nothing else is said; each is a factor of its picture's, where it has
/// one. Colours are linear sRGB.
struct MeshMaterial {
    Vec3d base_colour{1.0, 1.0, 1.0};
    std::optional<MeshTexture> base_texture;  // sRGB
    double metallic = 1.0;
    double roughness = 1.0;                         // the root of GGX's α
    std::optional<MeshTexture> metallic_roughness;  // B and G, as stored
    double transmission = 0.0;
    std::optional<MeshTexture> transmission_texture;  // R, as stored
    double index = 1.5;                               // of the coat and of what light passes into; > 1
    bool is_body = false;                             // light that passes goes on inside; else a thin pane
    Vec3d body_colour{1.0, 1.0, 1.0};                 // of light after `body_depth` inside
    double body_depth = 0.0;                          // in the file's units; 0: no light is lost inside
    Vec3d emission;                                   // cd/m² of each, strength included; no bound
    std::optional<MeshTexture> emission_texture;      // sRGB
    bool is_two_sided = false;
    UvMap uv;  // of all of its pictures
};

/// Where a picture is.
struct MeshPicture {
    std::size_t image = 0;       // its index in the file, for messages and `embedded_picture`
    std::filesystem::path file;  // empty: within the mesh's file or its buffers
};

struct GltfMaterials {
    std::vector<MeshMaterial> materials;  // in the file's order
    std::vector<MeshPicture> pictures;
    std::vector<std::string> remarks;  // what of them is not used, a sentence each
};

/// Reads the materials of a .gltf or .glb file of version 2. Pictures are not opened, nor are their places checked.
/// Throws InputError naming the file and the place: a number out of its bounds, a reference to what the file has not,
/// more than 4096 materials, version 1.
GltfMaterials read_gltf_materials(const std::filesystem::path& file);

/// The bytes of a picture that a file has within itself or in a buffer of its own: a data URI, or a part of a buffer.
/// Throws InputError where they are not there.
std::string embedded_picture(const std::filesystem::path& file, std::size_t image);

/// The files of buffers that a glTF file names, and those of pictures too.
std::vector<std::filesystem::path> gltf_references(const std::filesystem::path& file, bool with_pictures);

/// The file with each material's name replaced by its index, by which its meshes' materials are told however a library
/// orders them.
std::string gltf_with_numbered_materials(const std::filesystem::path& file);

}  // namespace lensproof::scene
