// engine/scene/scene_description.h — a scene as a file states it: values that name what is meant, checked, but nothing
// looked up or loaded. `engine/scene/README.md` documents every key.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/base/affine.h"
#include "engine/scene/chart.h"
#include "engine/scene/lens_model.h"
#include "engine/scene/mesh_file.h"
#include "engine/scene/pose.h"
#include "engine/scene/shapes.h"

namespace lensproof::scene {

// --- Spectra -------------------------------------------------------------------------------------------------------

/// Linear sRGB, to be uplifted to a spectrum.
struct RgbColour {
    Vec3d rgb;
};

/// A spectrum by its name among the project's data, say "metal:Ag".
struct SpectrumName {
    std::string name;
};

/// A column of a CSV table over `wavelength_nm`.
struct SpectrumTable {
    std::filesystem::path file;
    std::string column;
};

/// A number is the same at every wavelength.
using SpectrumDescription = std::variant<double, RgbColour, SpectrumName, SpectrumTable>;

/// A picture on the surface, uplifted texel by texel. uv (0, 0) is its lower left corner.
struct ImageDescription {
    std::filesystem::path file;
    double scale = 1.0;       // of its linear values
    Vec2d repeats{1.0, 1.0};  // how often it stands side by side along u and v
};

using TextureDescription = std::variant<double, RgbColour, SpectrumName, SpectrumTable, ImageDescription>;

// --- Materials -----------------------------------------------------------------------------------------------------

/// The optical constants of a metal by the name of the data for both, or each as a spectrum.
struct ConductorIndex {
    std::string name;  // "metal:Ag"; empty: n and k say it
    SpectrumDescription n = 1.0;
    SpectrumDescription k = 0.0;
};

/// A dielectric's index: the same at every wavelength, or a glass of the catalogues.
using DielectricIndex = std::variant<double, SpectrumName>;

/// GGX's α along u and across it; 0: smooth.
struct RoughnessDescription {
    double along_u = 0.0;
    double along_v = 0.0;
};

struct DiffuseDescription {
    TextureDescription reflectance = 0.5;
};

struct ConductorDescription {
    ConductorIndex index;
    RoughnessDescription roughness;
};

struct DielectricDescription {
    DielectricIndex index = 1.5;
    SpectrumDescription absorption_per_mm = 0.0;  // inside
    RoughnessDescription roughness;
};

/// A diffuse body under a clear coat.
struct PlasticDescription {
    TextureDescription reflectance = 0.5;
    DielectricIndex index = 1.5;
    RoughnessDescription roughness;
};

/// `share` of the second of two materials, the rest of the first; both indices of `SceneDescription::materials`, below
/// the mixture's own.
struct MixDescription {
    std::size_t first = 0;
    std::size_t second = 0;
    double share = 0.5;
};

using MaterialKind =
    std::variant<DiffuseDescription, ConductorDescription, DielectricDescription, PlasticDescription, MixDescription>;

struct MaterialDescription {
    std::string name;
    MaterialKind kind;
    std::string where;  // "scene.toml:12: materials[2]", for later complaints
};

// --- Objects -------------------------------------------------------------------------------------------------------

struct MeshFromFile {
    std::filesystem::path file;
    MeshOptions options;
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
    /// An index of `SceneDescription::materials`. Nothing: a chart that is its own material, with its two reflectances.
    std::optional<std::size_t> material;
    std::string where;
};

// --- Lights --------------------------------------------------------------------------------------------------------

/// A surface's or the sky's light: an illuminant's spectrum, or a table of radiance; at a luminance, or as the table
/// says.
struct EmissionDescription {
    std::string illuminant = "D65";         // unused with a table
    double luminance_cd_m2 = 0.0;           // 0: the table is absolute
    std::optional<SpectrumTable> radiance;  // W·m⁻²·sr⁻¹·nm⁻¹, or relative
};

/// An object that shines on its outward side, or on both; evenly in every direction.
struct AreaLightDescription {
    std::size_t object = 0;
    EmissionDescription emission;
    bool is_two_sided = false;
};

struct SphereLightDescription {
    Vec3d position_mm;
    double radius_mm = 0.0;
    EmissionDescription emission;
};

struct PointLightDescription {
    Vec3d position_mm;
    std::string illuminant;
    double intensity_cd = 0.0;
};

/// Full intensity within `full_deg` of the direction, none beyond `cone_deg`, smooth between.
struct SpotLightDescription {
    Vec3d position_mm;
    Vec3d direction;  // of unit length, that of the light
    double cone_deg = 0.0;
    double full_deg = 0.0;
    std::string illuminant;
    double intensity_cd = 0.0;
};

/// A disc at infinity of even radiance.
struct SunLightDescription {
    Vec3d direction;  // of unit length, towards the sun
    double angular_diameter_deg = 0.53;
    std::string illuminant;
    double illuminance_lx = 0.0;  // on a plane that faces it
};

/// Light from every direction: the same, or as a picture in equirectangular projection, whose white (1, 1, 1) has the
/// luminance and the illuminant. The picture's middle row is the horizon, its middle column the direction +x turned
/// about +z by `rotate_deg`; columns to the left of it lie towards +y. `up` is the direction that the top row shows.
struct EnvironmentLightDescription {
    std::optional<std::filesystem::path> image;
    EmissionDescription emission;
    double rotate_deg = 0.0;
    Vec3d up{0, 0, 1};
};

using LightKind = std::variant<AreaLightDescription, SphereLightDescription, PointLightDescription,
                               SpotLightDescription, SunLightDescription, EnvironmentLightDescription>;

struct LightDescription {
    LightKind kind;
    std::string where;
};

// --- Camera --------------------------------------------------------------------------------------------------------

/// Where the camera stands in the world, and how it images.
struct CameraView {
    LensModel model = LensModel::exact;
    Vec3d position_mm;  // of the vertex of the lens's first surface
    Vec3d look_at_mm{0, 0, 1};
    Vec3d up{0, 1, 0};
    /// Of a thin lens or a pinhole that stands for no lens.
    std::optional<double> focal_length_mm;
};

/// X_world = R · X_camera + t. The camera frame: x to the right of the picture, y down, z into the scene.
RigidMotion camera_to_world(const CameraView& view);

struct SceneDescription {
    std::vector<MaterialDescription> materials;
    std::vector<ObjectDescription> objects;
    std::vector<LightDescription> lights;
};

}  // namespace lensproof::scene
