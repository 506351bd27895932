#include "engine/scene/scene_build.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <set>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/base/overloaded.h"
#include "engine/scene/scene_shapes.h"
#include "engine/scene/scene_spectra.h"
#include "engine/spectral/illuminant.h"

namespace lensproof::scene {

namespace {

constexpr double kPi = std::numbers::pi;

double radians(double degrees) {
    return degrees * kPi / 180.0;
}

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
            said_of(material.where, [&] { add_material(material); });
        }
        add_objects();
        for (const LightDescription& light : description_.lights) {
            said_of(light.where, [&] { add_light(light); });
        }
        BuiltScene built{.scene = {.grid = spectra_.grid(),
                                   .geometry = std::make_unique<SceneGeometry>(std::move(shapes_), std::move(objects_)),
                                   .materials = std::move(materials_),
                                   .absorption = std::move(absorption_),
                                   .lights = {}},
                         .remarks = std::move(remarks_)};
        built.scene.lights = Lights(*built.scene.geometry, std::move(lights_));
        const auto& repaired = built.scene.geometry->remarks();
        built.remarks.insert(built.remarks.end(), repaired.begin(), repaired.end());
        return built;
    }

  private:
    static Roughness roughness_of(const RoughnessDescription& roughness) {
        return {.alpha_x = roughness.along_u, .alpha_y = roughness.along_v};
    }

    void add_material(const MaterialDescription& description) {
        std::optional<spectral::GridSpectrum> absorption;
        materials_.push_back(std::visit(
            Overloaded{[&](const DiffuseDescription& diffuse) {
                           return Material{.surface = DiffuseMaterial{spectra_.texture(diffuse.reflectance)},
                                           .radiance = {}};
                       },
                       [&](const ConductorDescription& conductor) {
                           auto [n, k] = spectra_.metal(conductor.index);
                           return Material{.surface = conductor_material(std::move(n), std::move(k),
                                                                         roughness_of(conductor.roughness)),
                                           .radiance = {}};
                       },
                       [&](const DielectricDescription& dielectric) {
                           const auto* even = std::get_if<double>(&dielectric.absorption_per_mm);
                           if (even == nullptr || *even > 0.0) {
                               absorption = spectra_.at_midpoints(dielectric.absorption_per_mm);
                           }
                           return Material{.surface = dielectric_material(spectra_.index(dielectric.index),
                                                                          roughness_of(dielectric.roughness)),
                                           .radiance = {}};
                       },
                       [&](const PlasticDescription& plastic) {
                           // A coat is alike in every direction: as rough as the mean.
                           const double alpha = std::sqrt(plastic.roughness.along_u * plastic.roughness.along_v);
                           return Material{.surface = plastic_material(spectra_.texture(plastic.reflectance),
                                                                       SceneSpectra::index_at_d(plastic.index), alpha),
                                           .radiance = {}};
                       },
                       [&](const MixDescription& mix) {
                           return Material{.surface = mixed(materials_[mix.first], materials_[mix.second], mix.share),
                                           .radiance = {}};
                       }},
            description.kind));
        absorption_.push_back(std::move(absorption));
    }

    void add_objects() {
        SceneShapes loaded = load_shapes(description_);
        shapes_ = std::move(loaded.shapes);
        objects_ = std::move(loaded.objects);
        remarks_ = std::move(loaded.remarks);
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
    std::uint32_t add_own(DiffuseMaterial material) {
        materials_.push_back({.surface = std::move(material), .radiance = {}});
        absorption_.emplace_back();
        return static_cast<std::uint32_t>(materials_.size() - 1);
    }

    /// A light's spectrum on the grid, which has to send something there.
    static spectral::GridSpectrum shining(spectral::GridSpectrum spectrum) {
        for (const float value : spectrum.value) {
            if (value > 0.0F) {
                return spectrum;
            }
        }
        throw InputError("the light has no power between the render's wavelengths");
    }

    void add_light(const LightDescription& description) {
        std::visit([&](const auto& light) { add(light); }, description.kind);
    }

    void add(const AreaLightDescription& light) {
        if (!shining_objects_.insert(light.object).second) {
            throw InputError("the object shines already, by another light of the file; expected one light an object");
        }
        lights_.emplace_back(AreaLight{.object = static_cast<std::uint32_t>(light.object),
                                       .radiance = shining(spectra_.radiance(light.emission)),
                                       .is_two_sided = light.is_two_sided});
    }

    /// A black ball that shines.
    void add(const SphereLightDescription& light) {
        const std::uint32_t black = add_own(DiffuseMaterial{spectral::constant_spectrum(0.0, spectra_.grid())});
        shapes_.emplace_back(Sphere{light.radius_mm});
        objects_.push_back({.shape = static_cast<std::uint32_t>(shapes_.size() - 1),
                            .to_world = {.linear = kIdentity3, .translation = light.position_mm},
                            .material = black});
        lights_.emplace_back(AreaLight{.object = static_cast<std::uint32_t>(objects_.size() - 1),
                                       .radiance = shining(spectra_.radiance(light.emission))});
    }

    /// W·sr⁻¹·nm⁻¹ of so many candela: as radiance follows from cd/m².
    spectral::GridSpectrum intensity(const std::string& name, double intensity_cd) {
        return shining(
            spectral::stratum_means(spectral::radiance_of(spectral::illuminant(name), intensity_cd), spectra_.grid()));
    }

    void add(const PointLightDescription& light) {
        lights_.emplace_back(PointLight{light.position_mm, intensity(light.illuminant, light.intensity_cd)});
    }

    void add(const SpotLightDescription& light) {
        lights_.emplace_back(SpotLight{.position = light.position_mm,
                                       .axis = light.direction,
                                       .cos_inner = std::cos(radians(light.full_deg)),
                                       .cos_outer = std::cos(radians(light.cone_deg)),
                                       .intensity = intensity(light.illuminant, light.intensity_cd)});
    }

    /// An even disc of angular radius r gives a plane that faces it the irradiance L π sin²r.
    void add(const SunLightDescription& light) {
        const double radius = radians(0.5 * light.angular_diameter_deg);
        const double per_projected = 1.0 / (kPi * std::sin(radius) * std::sin(radius));
        const spectral::Spectrum irradiance =
            spectral::irradiance_of(spectral::illuminant(light.illuminant), light.illuminance_lx);
        lights_.emplace_back(
            SunLight{.towards = light.direction,
                     .cos_radius = std::cos(radius),
                     .radiance = shining(spectral::stratum_means(per_projected * irradiance, spectra_.grid()))});
    }

    void add(const EnvironmentLightDescription& light) {
        if (!light.image) {
            lights_.emplace_back(ConstantLight{shining(spectra_.radiance(light.emission))});
            return;
        }
        const spectral::Spectrum white = SceneSpectra::radiance_spectrum(light.emission);
        shining(spectral::stratum_means(white, spectra_.grid()));
        const formats::Image image = formats::read_image(*light.image);
        lights_.emplace_back(EnvironmentLight{std::make_shared<const Environment>(
            emission_texture(image, *light.image, Wrap::repeat, Wrap::clamp, white, spectra_.grid(), spectra_.uplift()),
            light.up, light.rotate_deg)});
    }

    const SceneDescription& description_;
    SceneSpectra spectra_;
    std::vector<Shape> shapes_;
    std::vector<SceneObject> objects_;
    std::vector<Material> materials_;
    std::vector<std::optional<spectral::GridSpectrum>> absorption_;  // a material each
    std::vector<LightSource> lights_;
    std::set<std::size_t> shining_objects_;
    std::vector<std::string> remarks_;
};

}  // namespace

BuiltScene build_scene(const SceneDescription& description, const spectral::SpectralGrid& grid, const Cache& cache) {
    return SceneBuilder(description, grid, cache).build();
}

std::vector<std::filesystem::path> named_files(const SceneDescription& description) {
    std::set<std::filesystem::path> files;
    const auto of_spectrum =
        Overloaded{[&](const SpectrumTable& table) { files.insert(table.file); },
                   [&](const ImageDescription& image) { files.insert(image.file); }, [](const auto& /*no file*/) {}};
    const auto of_emission = [&](const EmissionDescription& emission) {
        if (emission.radiance) {
            files.insert(emission.radiance->file);
        }
    };
    for (const MaterialDescription& material : description.materials) {
        std::visit(Overloaded{[&](const DiffuseDescription& diffuse) { std::visit(of_spectrum, diffuse.reflectance); },
                              [&](const PlasticDescription& plastic) { std::visit(of_spectrum, plastic.reflectance); },
                              [&](const DielectricDescription& dielectric) {
                                  std::visit(of_spectrum, dielectric.absorption_per_mm);
                              },
                              [&](const ConductorDescription& conductor) {
                                  std::visit(of_spectrum, conductor.index.n);
                                  std::visit(of_spectrum, conductor.index.k);
                              },
                              [](const MixDescription& /*of others*/) {}},
                   material.kind);
    }
    for (const ObjectDescription& object : description.objects) {
        if (const auto* mesh = std::get_if<MeshFromFile>(&object.shape)) {
            files.insert(mesh->file);
        }
    }
    for (const LightDescription& light : description.lights) {
        std::visit(Overloaded{[&](const AreaLightDescription& area) { of_emission(area.emission); },
                              [&](const SphereLightDescription& sphere) { of_emission(sphere.emission); },
                              [&](const EnvironmentLightDescription& sky) {
                                  of_emission(sky.emission);
                                  if (sky.image) {
                                      files.insert(*sky.image);
                                  }
                              },
                              [](const auto& /*no file*/) {}},
                   light.kind);
    }
    return {files.begin(), files.end()};
}

}  // namespace lensproof::scene
