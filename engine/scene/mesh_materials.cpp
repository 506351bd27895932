#include "engine/scene/mesh_materials.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/spectral/illuminant.h"

namespace lensproof::scene {

namespace {

namespace fs = std::filesystem;

constexpr double kMostTexels = 200e6;  // as of one picture
constexpr std::size_t kRed = 0;
constexpr std::size_t kGreen = 1;
constexpr std::size_t kBlue = 2;

/// A file that holds these bytes while this lives.
class PassingFile {
  public:
    explicit PassingFile(const std::string& bytes) : name_((fs::temp_directory_path() / "lensproof-XXXXXX").string()) {
        const int descriptor = ::mkstemp(name_.data());
        if (descriptor < 0) {
            throw std::runtime_error(fmt::format("{}: cannot be made", name_));
        }
        ::close(descriptor);
        std::ofstream stream(name_, std::ios::binary);
        if (!stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush()) {
            fs::remove(name_);
            throw std::runtime_error(fmt::format("{}: cannot be written", name_));
        }
    }
    PassingFile(const PassingFile&) = delete;
    PassingFile& operator=(const PassingFile&) = delete;
    ~PassingFile() {
        std::error_code ignored;
        fs::remove(name_, ignored);
    }

    [[nodiscard]] const std::string& name() const { return name_; }

  private:
    std::string name_;
};

/// A picture within a file, by the one reader that pictures have: what is wrong is said of `name`.
formats::Image read_embedded(const std::string& bytes, const std::string& name) {
    const PassingFile passing(bytes);
    try {
        return formats::read_image(passing.name());
    } catch (const InputError& error) {
        std::string message = error.what();
        const std::size_t at = message.find(passing.name());
        throw InputError(at == std::string::npos ? fmt::format("{}: {}", name, message)
                                                 : message.replace(at, passing.name().size(), name));
    }
}

Wrap wrap_of(MeshWrap wrap) {
    return wrap == MeshWrap::repeat ? Wrap::repeat : wrap == MeshWrap::clamp ? Wrap::clamp : Wrap::mirror;
}

bool is_black(const Vec3d& rgb) {
    return rgb == Vec3d();
}

}  // namespace

MeshMaterials::MeshMaterials(fs::path file) : file_(std::move(file)), gltf_(read_gltf_materials(file_)) {}

const MeshMaterial& MeshMaterials::at(std::size_t index) const {
    static const MeshMaterial kDefault;
    return index < gltf_.materials.size() ? gltf_.materials[index] : kDefault;
}

const MeshMaterials::Picture& MeshMaterials::picture(std::size_t index) {
    const auto known = pictures_.find(index);
    if (known != pictures_.end()) {
        return known->second;
    }
    const MeshPicture& from = gltf_.pictures[index];
    if (from.file.empty()) {
        const std::string name = fmt::format("{}: images[{}]", file_.string(), from.image);
        return pictures_[index] = {read_embedded(embedded_picture(file_, from.image), name), name};
    }
    check_reference(file_, from.file);
    return pictures_[index] = {formats::read_image(from.file), from.file.string()};
}

TexelGrid MeshMaterials::texels(const MeshTexture& texture, const formats::Image& image) {
    texels_ += static_cast<double>(image.width) * image.height;
    if (texels_ > kMostTexels) {
        throw InputError(
            fmt::format("{}: the pictures of its materials have more than {:.0f} million pixels, each "
                        "counted for every material that has it",
                        file_.string(), kMostTexels / 1e6));
    }
    return {image.width, image.height, wrap_of(texture.wrap_u), wrap_of(texture.wrap_v)};
}

Texture MeshMaterials::reflectance(const MeshMaterial& material, SceneSpectra& spectra) {
    if (!material.base_texture) {
        return rgb_reflectance(material.base_colour, spectra.grid(), spectra.uplift());
    }
    const auto& [image, name] = picture(material.base_texture->picture);
    return reflectance_texture(image, name, texels(*material.base_texture, image), material.base_colour, spectra.grid(),
                               spectra.uplift());
}

VaryingNumber MeshMaterials::number(double factor, const std::optional<MeshTexture>& texture, std::size_t channel) {
    if (!texture || factor == 0.0) {
        return {.factor = factor};
    }
    const auto& [image, name] = picture(texture->picture);
    return {.factor = factor,
            .picture =
                std::make_shared<const NumberTexture>(number_texture(image, name, texels(*texture, image), channel))};
}

Material MeshMaterials::material(std::size_t index, SceneSpectra& spectra) {
    const MeshMaterial& from = at(index);
    MetallicMaterial made{.base_colour = reflectance(from, spectra),
                          .metallic = number(from.metallic, from.metallic_roughness, kBlue),
                          .roughness = number(from.roughness, from.metallic_roughness, kGreen),
                          .transmission = number(from.transmission, from.transmission_texture, kRed),
                          .eta = from.index,
                          .is_body = from.is_body,
                          .facets = {},
                          .metal_means = {}};
    prepare(made);
    return {std::move(made)};
}

std::optional<spectral::GridSpectrum> MeshMaterials::absorption(std::size_t index, double mm_per_unit,
                                                                SceneSpectra& spectra) const {
    const MeshMaterial& from = at(index);
    if (!from.is_body || !(from.transmission > 0.0) || !(from.body_depth > 0.0)) {
        return {};
    }
    spectral::GridSpectrum passing = rgb_reflectance(from.body_colour, spectra.grid(), spectra.uplift());
    for (float& value : passing.value) {
        constexpr float kDarkest = 1e-6F;  // a black that still has a logarithm
        value = -std::log(std::clamp(value, kDarkest, 1.0F)) / static_cast<float>(from.body_depth * mm_per_unit);
    }
    return passing;
}

std::optional<AreaLight> MeshMaterials::light(std::size_t index, double cd_m2_per_unit, SceneSpectra& spectra) {
    const MeshMaterial& from = at(index);
    if (is_black(from.emission)) {
        return {};
    }
    const spectral::Spectrum white = spectral::radiance_of(spectral::illuminant("D65"), cd_m2_per_unit);
    const auto shining = [&](const formats::Image& image, const std::string& name, const TexelGrid& grid) {
        return std::make_shared<const ImageTexture>(
            emission_texture(image, name, grid, from.emission, white, spectra.grid(), spectra.uplift()));
    };
    AreaLight light{.is_two_sided = from.is_two_sided};
    if (from.emission_texture) {
        const auto& [image, name] = picture(from.emission_texture->picture);
        light.picture = shining(image, name, texels(*from.emission_texture, image));
        const std::vector<float> means = mean_over_grid(*light.picture);
        return std::ranges::any_of(means, [](float mean) { return mean > 0.0F; }) ? std::optional(light) : std::nullopt;
    }
    const spectral::UpliftedLight even = spectral::uplifted_light(spectra.uplift(), from.emission);
    light.radiance = spectral::stratum_means(white, spectra.grid());
    for (int i = 0; i < spectra.grid().size(); ++i) {
        light.radiance.value[static_cast<std::size_t>(i)] *=
            static_cast<float>(even.scale * even.shape(spectra.grid().strata.midpoint(i)));
    }
    return light;
}

}  // namespace lensproof::scene
