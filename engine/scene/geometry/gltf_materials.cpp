#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/json.h"
#include "engine/base/text.h"
#include "engine/scene/geometry/gltf_document.h"
#include "engine/scene/geometry/mesh_material.h"

namespace lensproof::scene {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostMaterials = 4096;
constexpr double kUnbounded = 1e15;

/// Extensions of materials that are read.
constexpr std::array kKnownExtensions = {"KHR_materials_transmission", "KHR_materials_ior", "KHR_materials_volume",
                                         "KHR_materials_emissive_strength"};

/// A member of a glTF file, and where it stands, for messages.
class Place {
  public:
    Place(const Json& json, std::string name) : json_(&json), name_(std::move(name)) {}

    [[noreturn]] void fail(const std::string& why) const { throw InputError(fmt::format("{}: {}", name_, why)); }

    [[nodiscard]] bool is_there() const { return !json_->is_null(); }
    [[nodiscard]] const Json& json() const { return *json_; }
    [[nodiscard]] const std::string& name() const { return name_; }

    [[nodiscard]] Place in(std::string_view key) const { return {(*json_)[key], fmt::format("{}.{}", name_, key)}; }

    /// An element of a list; it has to be there.
    [[nodiscard]] Place at(std::size_t index) const {
        if (!json_->is_list() || index >= json_->size()) {
            fail(fmt::format("has {} entries, of which number {} is asked for", json_->is_list() ? json_->size() : 0,
                             index));
        }
        return {(*json_)[index], fmt::format("{}[{}]", name_, index)};
    }

    [[nodiscard]] double number(double low, double high) const {
        if (!json_->is_number() || !(json_->number() >= low && json_->number() <= high)) {
            fail(fmt::format("is {}, expected a number from {:g} to {:g}", shown(), low, high));
        }
        return json_->number();
    }
    [[nodiscard]] double number_or(std::string_view key, double otherwise, double low, double high) const {
        const Place member = in(key);
        return member.is_there() ? member.number(low, high) : otherwise;
    }
    [[nodiscard]] std::size_t index() const {
        if (!json_->is_whole()) {
            fail(fmt::format("is {}, expected an index", shown()));
        }
        return static_cast<std::size_t>(number(0.0, kUnbounded));
    }
    /// The first numbers of a list, which may be longer; `otherwise` where it is absent.
    template <std::size_t n>
    [[nodiscard]] std::array<double, n> numbers_or(std::string_view key, std::array<double, n> otherwise, double low,
                                                   double high) const {
        const Place list = in(key);
        for (std::size_t i = 0; list.is_there() && i < n; ++i) {
            otherwise[i] = list.at(i).number(low, high);
        }
        return otherwise;
    }
    [[nodiscard]] Vec3d colour_or(std::string_view key, const Vec3d& otherwise) const {
        const auto [r, g, b] = numbers_or<3>(key, {otherwise.x, otherwise.y, otherwise.z}, 0.0, 1.0);
        return {r, g, b};
    }

  private:
    [[nodiscard]] std::string shown() const { return printable(json_->dump().substr(0, 40)); }

    const Json* json_;
    std::string name_;
};

MeshWrap wrap_of(const Place& sampler, std::string_view key) {
    constexpr int kRepeat = 10497;
    constexpr int kClamp = 33071;
    constexpr int kMirror = 33648;
    const auto mode = static_cast<int>(sampler.number_or(key, kRepeat, 0, 65535));
    if (mode != kRepeat && mode != kClamp && mode != kMirror) {
        sampler.in(key).fail(fmt::format("is {}, expected {}, {} or {}", mode, kRepeat, kClamp, kMirror));
    }
    return mode == kRepeat ? MeshWrap::repeat : mode == kClamp ? MeshWrap::clamp : MeshWrap::mirror;
}

class MaterialsReader {
  public:
    MaterialsReader(const Json& top, const fs::path& file) : file_(file), top_(top, file.string()) {}

    GltfMaterials read() {
        const Place list = top_.in("materials");
        if (list.json().size() > kMostMaterials) {
            list.fail(fmt::format("are {}, expected at most {}", list.json().size(), kMostMaterials));
        }
        for (std::size_t i = 0; i < list.json().size(); ++i) {
            read_.materials.push_back(material(list.at(i)));
        }
        for (const auto& [what, count] : ignored_) {
            read_.remarks.push_back(fmt::format("{}: {} {} ignored, in {} of its materials", file_.string(),
                                                printable(what), what.ends_with('s') ? "are" : "is", count));
        }
        return std::move(read_);
    }

  private:
    MeshMaterial material(const Place& place) {
        if (!place.json().is_object()) {
            place.fail("is no material: expected an object");
        }
        uv_.reset();
        const Place pbr = place.in("pbrMetallicRoughness");
        const Place extensions = place.in("extensions");
        MeshMaterial material{.base_colour = pbr.colour_or("baseColorFactor", {1.0, 1.0, 1.0}),
                              .base_texture = texture(pbr.in("baseColorTexture")),
                              .metallic = pbr.number_or("metallicFactor", 1.0, 0.0, 1.0),
                              .roughness = pbr.number_or("roughnessFactor", 1.0, 0.0, 1.0),
                              .metallic_roughness = texture(pbr.in("metallicRoughnessTexture")),
                              .emission_texture = texture(place.in("emissiveTexture"))};
        read_glass(extensions, material);
        const double strength =
            extensions.in("KHR_materials_emissive_strength").number_or("emissiveStrength", 1.0, 0.0, kUnbounded);
        material.emission = strength * place.colour_or("emissiveFactor", {});
        const Json& two_sided = place.in("doubleSided").json();
        material.is_two_sided = two_sided.is_truth() && two_sided.truth();
        material.uv = uv_.value_or(UvMap());
        note_ignored(place);
        return material;
    }

    void read_glass(const Place& extensions, MeshMaterial& material) {
        const Place transmission = extensions.in("KHR_materials_transmission");
        material.transmission = transmission.number_or("transmissionFactor", 0.0, 0.0, 1.0);
        material.transmission_texture = texture(transmission.in("transmissionTexture"));
        // 0 and 1 stand for no Fresnel reflection or all of it, which glass has not.
        material.index = std::max(1.0001, extensions.in("KHR_materials_ior").number_or("ior", 1.5, 0.0, 5.0));
        const Place volume = extensions.in("KHR_materials_volume");
        material.is_body = volume.number_or("thicknessFactor", 0.0, 0.0, kUnbounded) > 0.0;
        material.body_colour = volume.colour_or("attenuationColor", material.body_colour);
        material.body_depth = volume.number_or("attenuationDistance", 0.0, 0.0, kUnbounded);
    }

    /// Nothing where it is absent, or laid out otherwise than the material's others.
    std::optional<MeshTexture> texture(const Place& info) {
        if (!info.is_there()) {
            return {};
        }
        const Place texture = top_.in("textures").at(info.in("index").index());
        if (!texture.in("source").is_there()) {
            note("pictures of forms that extensions name");
            return {};
        }
        const UvMap uv = uv_map(info);
        if (uv_.value_or(uv) != uv) {
            note("pictures that are laid out by other uvs than the material's first");
            return {};
        }
        uv_ = uv;
        MeshTexture read{.picture = picture(texture.in("source").index())};
        if (texture.in("sampler").is_there()) {
            const Place sampler = top_.in("samplers").at(texture.in("sampler").index());
            read.wrap_u = wrap_of(sampler, "wrapS");
            read.wrap_v = wrap_of(sampler, "wrapT");
        }
        return read;
    }

    static UvMap uv_map(const Place& info) {
        const Place transform = info.in("extensions").in("KHR_texture_transform");
        const Place& set = transform.in("texCoord").is_there() ? transform : info;
        const auto [x, y] = transform.numbers_or<2>("offset", {0.0, 0.0}, -kUnbounded, kUnbounded);
        const auto [along, down] = transform.numbers_or<2>("scale", {1.0, 1.0}, -kUnbounded, kUnbounded);
        return {.set = static_cast<std::uint32_t>(set.number_or("texCoord", 0.0, 0.0, 7.0)),
                .offset = {x, y},
                .scale = {along, down},
                .turn = transform.number_or("rotation", 0.0, -kUnbounded, kUnbounded)};
    }

    std::size_t picture(std::size_t image) {
        const Json& uri = top_.in("images").at(image).in("uri").json();
        const auto known = std::ranges::find(read_.pictures, image, &MeshPicture::image);
        if (known == read_.pictures.end()) {
            const bool has_file = uri.is_text() && !uri.text().starts_with("data:");
            read_.pictures.push_back(
                {image, has_file ? file_.parent_path() / percent_decoded(uri.text()) : fs::path()});
            return read_.pictures.size() - 1;
        }
        return static_cast<std::size_t>(known - read_.pictures.begin());
    }

    void note_ignored(const Place& place) {
        const Json& alpha = place.in("alphaMode").json();
        if (alpha.is_text() && alpha.text() != "OPAQUE") {
            note("alpha");
        }
        if (place.in("normalTexture").is_there()) {
            note("normal maps");
        }
        if (place.in("occlusionTexture").is_there()) {
            note("occlusion maps");
        }
        for (const auto& [name, value] : place.in("extensions").json().members()) {
            if (std::ranges::find(kKnownExtensions, name) == kKnownExtensions.end()) {
                note(name);
            }
        }
    }

    void note(const std::string& what) { ++ignored_[what]; }

    const fs::path& file_;
    Place top_;
    GltfMaterials read_;
    std::optional<UvMap> uv_;  // of the material's first picture
    std::map<std::string, std::size_t> ignored_;
};

std::string buffer_bytes(const Place& top, const fs::path& file, std::size_t index) {
    const Place uri = top.in("buffers").at(index).in("uri");
    if (!uri.is_there()) {
        return glb_buffer(file);
    }
    if (!uri.json().is_text()) {
        uri.fail("expected a text");
    }
    const std::string& text = uri.json().text();
    return text.starts_with("data:") ? data_uri_bytes(text, uri.name())
                                     : read_file(referred_file(file, percent_decoded(text)));
}

}  // namespace

Vec2<float> mapped(const UvMap& map, const Vec2<float>& uv) {
    const double u = map.scale.x * uv.x;
    const double down = map.scale.y * (1.0 - uv.y);
    const double cosine = std::cos(map.turn);
    const double sine = std::sin(map.turn);
    return {static_cast<float>(map.offset.x + cosine * u + sine * down),
            static_cast<float>(1.0 - (map.offset.y - sine * u + cosine * down))};
}

GltfMaterials read_gltf_materials(const fs::path& file) {
    const Json json = gltf_json(file);
    return MaterialsReader(json, file).read();
}

std::string embedded_picture(const fs::path& file, std::size_t image) {
    const Json json = gltf_json(file);
    const Place top(json, file.string());
    const Place place = top.in("images").at(image);
    const Place uri = place.in("uri");
    if (uri.is_there() && uri.json().is_text()) {
        return data_uri_bytes(uri.json().text(), uri.name());
    }
    const Place view = top.in("bufferViews").at(place.in("bufferView").index());
    const std::string buffer = buffer_bytes(top, file, view.in("buffer").index());
    const auto offset = static_cast<std::size_t>(view.number_or("byteOffset", 0.0, 0.0, kUnbounded));
    const std::size_t length = view.in("byteLength").index();
    if (offset > buffer.size() || length > buffer.size() - offset) {
        view.fail(fmt::format("is {} bytes from {} on, of a buffer of {}", length, offset, buffer.size()));
    }
    return buffer.substr(offset, length);
}

std::vector<fs::path> gltf_references(const fs::path& file, bool with_pictures) {
    const Json json = gltf_json(file);
    std::vector<fs::path> files;
    const auto add = [&](const Json& entries) {
        for (const Json& entry : entries) {
            const Json& uri = entry["uri"];
            if (uri.is_text() && !uri.text().starts_with("data:")) {
                files.push_back(file.parent_path() / percent_decoded(uri.text()));
            }
        }
    };
    add(json["buffers"]);
    if (with_pictures) {
        add(json["images"]);
    }
    return files;
}

std::string gltf_with_numbered_materials(const fs::path& file) {
    Json json = gltf_json(file);
    for (std::size_t i = 0; i < std::as_const(json)["materials"].size(); ++i) {
        json["materials"][i]["name"] = std::to_string(i);
    }
    return gltf_with_json(file, json);
}

}  // namespace lensproof::scene
