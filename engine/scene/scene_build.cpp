#include "engine/scene/scene_build.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/scene/mesh_materials.h"
#include "engine/scene/scene_shapes.h"
#include "engine/scene/spectra/scene_spectra.h"

namespace lensproof::scene {

namespace {

/// What `make` throws is said of the place in the scene file that asked for it.
template <class Make>
auto said_of(const std::string& where, const Make& make) {
    try {
        return make();
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", where, error.what()));
    }
}

class SceneBuilder {
  public:
    SceneBuilder(const SceneDescription& description, const spectral::SpectralGrid& grid, const Cache& cache)
        : description_(description), spectra_(grid, cache) {}

    BuiltScene build() {
        for (const MaterialDescription& material : description_.materials) {
            said_of(material.where, [&] {
                absorption_.push_back(absorption(material, spectra_));
                materials_.push_back(make_material(material, {spectra_, materials_}));
            });
        }
        add_objects();
        for (const LightDescription& light : description_.lights) {
            said_of(light.where, [&] { add_light(light); });
        }
        add_own_materials();
        if (lights_.empty() && !own_materials_.empty()) {
            throw InputError("there is no light: expected [[lights]], or a mesh's file with a material that emits");
        }
        find_uv_readers();
        BuiltScene built{.scene = {.grid = spectra_.grid(),
                                   .geometry = std::make_unique<SceneGeometry>(std::move(shapes_), std::move(objects_),
                                                                               description_.precision),
                                   .materials = std::move(materials_),
                                   .absorption = std::move(absorption_),
                                   .lights = {}},
                         .light_places = std::move(light_places_),
                         .remarks = std::move(remarks_)};
        built.scene.lights = Lights(*built.scene.geometry, std::move(lights_));
        const auto& repaired = built.scene.geometry->remarks();
        built.remarks.insert(built.remarks.end(), repaired.begin(), repaired.end());
        return built;
    }

  private:
    void add_objects() {
        SceneShapes loaded = load_shapes(description_);
        shapes_ = std::move(loaded.shapes);
        objects_ = std::move(loaded.objects);
        remarks_ = std::move(loaded.remarks);
        first_object_ = std::move(loaded.first_object);
        own_materials_ = std::move(loaded.own_materials);
        for (const std::size_t object : loaded.own_charts) {
            const auto& chart = chart_of(description_.objects[object]);
            add_own(DiffuseMaterial{
                chart_texture(chart.chart, chart.quad.width_mm, chart.quad.height_mm, spectra_.grid())});
        }
    }

    [[nodiscard]] const ChartOnQuad& chart_of(const ObjectDescription& object) const {
        const auto* instance = std::get_if<InstanceOf>(&object.shape);
        return std::get<ChartOnQuad>((instance != nullptr ? description_.objects[instance->object] : object).shape);
    }

    /// Returns the material's index.
    std::uint32_t add_own(DiffuseMaterial material) { return add_material({std::move(material)}, {}); }

    std::uint32_t add_material(Material material, std::optional<spectral::GridSpectrum> absorption) {
        materials_.push_back(std::move(material));
        absorption_.push_back(std::move(absorption));
        return static_cast<std::uint32_t>(materials_.size() - 1);
    }

    /// What glTF files say of meshes that the scene file gives no material, each file's and material's once. A light of
    /// the scene file takes the place of what an object emits.
    void add_own_materials() {
        std::map<std::filesystem::path, MeshMaterials> files;
        std::map<std::tuple<std::filesystem::path, std::size_t, double>, std::uint32_t> made;
        for (const OwnMaterial& own : own_materials_) {
            const std::filesystem::path& file = own.mesh->file;
            const auto [of_file, is_new_file] = files.try_emplace(file, file);
            MeshMaterials& materials = of_file->second;
            if (is_new_file) {
                remarks_.insert(remarks_.end(), materials.remarks().begin(), materials.remarks().end());
            }
            const double mm_per_unit = own.mesh->options.mm_per_unit.value_or(kGltfUnitMm);
            const auto [index, is_new] = made.try_emplace({file, own.material, mm_per_unit}, 0);
            if (is_new) {
                index->second = add_material(materials.material(own.material, spectra_),
                                             materials.absorption(own.material, mm_per_unit, spectra_));
            }
            objects_[own.object].material = index->second;
            const auto object = static_cast<std::uint32_t>(own.object);
            if (shining_objects_.contains(object)) {
                continue;
            }
            if (std::optional<AreaLight> light = materials.light(own.material, own.mesh->cd_m2_per_unit, spectra_)) {
                light->object = object;
                lights_.emplace_back(*std::move(light));
                light_places_.push_back(file.string());
            }
        }
    }

    /// Returns the object's index.
    std::uint32_t add_black_ball(const Vec3d& centre_mm, double radius_mm) {
        const std::uint32_t black = add_own(DiffuseMaterial{spectral::constant_spectrum(0.0, spectra_.grid())});
        shapes_.emplace_back(Sphere{radius_mm});
        objects_.push_back({.shape = static_cast<std::uint32_t>(shapes_.size() - 1),
                            .to_world = {.linear = kIdentity3, .translation = centre_mm},
                            .material = black});
        return static_cast<std::uint32_t>(objects_.size() - 1);
    }

    void add_light(const LightDescription& description) {
        const auto* area = std::get_if<AreaLightDescription>(&description.kind);
        if (area == nullptr) {
            add_one_light(description);
            return;
        }
        // An object of several materials shines with each of its parts.
        for (std::size_t i = first_object_[area->object]; i < first_object_[area->object + 1]; ++i) {
            LightDescription of_part = description;
            std::get<AreaLightDescription>(of_part.kind).object = i;
            add_one_light(of_part);
        }
    }

    void add_one_light(const LightDescription& description) {
        const LightMaker maker{.spectra = spectra_, .add_black_ball = [&](const Vec3d& centre_mm, double radius_mm) {
                                   return add_black_ball(centre_mm, radius_mm);
                               }};
        lights_.push_back(make_light(description, maker));
        light_places_.push_back(description.where);
        const auto* area = std::get_if<AreaLight>(&lights_.back());
        if (area != nullptr && !shining_objects_.insert(area->object).second) {
            throw InputError("the object shines already, by another light of the file; expected one light an object");
        }
    }

    void find_uv_readers() {
        for (SceneObject& object : objects_) {
            object.reads_uv = reads_uv(materials_[object.material]);
        }
        for (const LightSource& light : lights_) {
            if (const auto* area = std::get_if<AreaLight>(&light); area != nullptr && area->picture != nullptr) {
                objects_[area->object].reads_uv = true;
            }
        }
    }

    const SceneDescription& description_;
    SceneSpectra spectra_;
    std::vector<Shape> shapes_;
    std::vector<SceneObject> objects_;
    std::vector<std::size_t> first_object_;  // of each that is described
    std::vector<OwnMaterial> own_materials_;
    std::vector<Material> materials_;
    std::vector<std::optional<spectral::GridSpectrum>> absorption_;  // a material each
    std::vector<LightSource> lights_;
    std::vector<std::string> light_places_;
    std::set<std::uint32_t> shining_objects_;
    std::vector<std::string> remarks_;
};

}  // namespace

BuiltScene build_scene(const SceneDescription& description, const spectral::SpectralGrid& grid, const Cache& cache) {
    return SceneBuilder(description, grid, cache).build();
}

std::vector<std::filesystem::path> named_files(const SceneDescription& description) {
    std::set<std::filesystem::path> files;
    const auto insert = [&](const std::vector<std::filesystem::path>& more) { files.insert(more.begin(), more.end()); };
    for (const MaterialDescription& material : description.materials) {
        insert(named_files(material));
    }
    for (const ObjectDescription& object : description.objects) {
        if (const auto* mesh = std::get_if<MeshFromFile>(&object.shape)) {
            files.insert(mesh->file);
            if (is_gltf(mesh->file)) {
                insert(gltf_references(mesh->file, mesh->options.by_material));
            }
        }
    }
    for (const LightDescription& light : description.lights) {
        insert(named_files(light));
    }
    return {files.begin(), files.end()};
}

}  // namespace lensproof::scene
