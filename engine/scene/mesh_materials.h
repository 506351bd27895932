// engine/scene/mesh_materials.h — materials and lights of what glTF files say of their surfaces.
#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/geometry/mesh_material.h"
#include "engine/scene/light/area_light.h"
#include "engine/scene/material/material.h"

namespace lensproof::scene {

/// The materials of one glTF file, made as they are asked for.
class MeshMaterials {
  public:
    /// Throws InputError as read_gltf_materials does.
    explicit MeshMaterials(std::filesystem::path file);

    [[nodiscard]] const std::vector<std::string>& remarks() const { return gltf_.remarks; }

    /// `index`: as `MeshPart::material`. Throws InputError for a picture that cannot be used, and where the pictures of
    /// the file's materials together have more texels than a picture may.
    Material material(std::size_t index, SceneSpectra& spectra);
    /// What light loses inside, 1/mm; `mm_per_unit`: of the file. Nothing where it loses none.
    [[nodiscard]] std::optional<spectral::GridSpectrum> absorption(std::size_t index, double mm_per_unit,
                                                                   SceneSpectra& spectra) const;
    /// What it shines, without its object; nothing where it does not.
    std::optional<AreaLight> light(std::size_t index, double cd_m2_per_unit, SceneSpectra& spectra);

  private:
    [[nodiscard]] const MeshMaterial& at(std::size_t index) const;
    Texture reflectance(const MeshMaterial& material, SceneSpectra& spectra);
    VaryingNumber number(double factor, const std::optional<MeshTexture>& texture, std::size_t channel);
    /// A picture in linear light, and its name for messages.
    struct Picture {
        formats::Image image;
        std::string name;
    };
    const Picture& picture(std::size_t index);
    /// Its size and wraps, once they are counted.
    TexelGrid texels(const MeshTexture& texture, const formats::Image& image);

    std::filesystem::path file_;
    GltfMaterials gltf_;
    std::map<std::size_t, Picture> pictures_;  // by their index
    double texels_ = 0.0;                      // of all that was made
};

}  // namespace lensproof::scene
