#include "engine/render/camera/camera_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/formats/prescription/barrel_toml.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/optics/packet/spectral_lens.h"
#include "engine/scene/scene_file_parts.h"
#include "engine/scene/spectra/spectrum_keys.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::render {

namespace {

constexpr Bounds kSensorSide{.min = 0.0, .max = 1e4, .min_excluded = true};
constexpr double kMostPixels = 200e6;

Sensor read_sensor(TomlTable& table) {
    const std::vector<double> size = table.numbers("sensor_mm", 2, kSensorSide);
    const std::vector<double> pixels = table.numbers("pixels", 2, {.min = 1.0, .max = 1e5});
    const Sensor sensor{.width = static_cast<int>(pixels[0]),
                        .height = static_cast<int>(pixels[1]),
                        .pixel_pitch_mm = size[0] / pixels[0]};
    if (sensor.width != pixels[0] || sensor.height != pixels[1] || pixels[0] * pixels[1] > kMostPixels) {
        table.fail("pixels", fmt::format("is [{}, {}], expected two whole numbers, {:.0f} million pixels at most",
                                         pixels[0], pixels[1], kMostPixels / 1e6));
    }
    if (std::abs(size[1] / pixels[1] / sensor.pixel_pitch_mm - 1.0) > 1e-6) {
        table.fail("pixels", fmt::format("makes pixels of {} × {} mm with sensor_mm, expected square ones",
                                         sensor.pixel_pitch_mm, size[1] / pixels[1]));
    }
    return sensor;
}

std::optional<optics::PolygonStop> read_blades(TomlTable& table) {
    if (table.has("blades")) {
        return optics::PolygonStop{.blades = table.integer("blades", 3, 64),
                                   .curvature = table.number_or("blade_curvature", 0.0, {.min = 0.0, .max = 1.0}),
                                   .rotation_deg = table.number_or("blade_rotation_deg", 0.0)};
    }
    for (const char* key : {"blade_curvature", "blade_rotation_deg"}) {
        if (table.has(key)) {
            table.fail(key, "stands without blades, expected their number too");
        }
    }
    return std::nullopt;
}

DustSettings read_dust(TomlTable& table) {
    constexpr Bounds kFraction{.min = 0.0, .max = 1.0};
    DustSettings dust{.picture = read_file_name(table, "picture"),
                      .albedo = table.number("albedo", kFraction),
                      .through = table.number_or("through", DustSettings{}.through, kFraction)};
    table.finish();
    return dust;
}

/// What stands between lens and film.
void read_exposure(TomlTable& table, CameraSettings& camera) {
    camera.zoom = table.text_or("zoom", "");
    if (table.has("coating")) {
        camera.coatings = {table.text("coating")};
    }
    camera.blades = read_blades(table);
    constexpr Bounds kReflectance{.min = 0.0, .max = 1.0};
    camera.mirrors = {.sensor = table.number_or("sensor_reflectance", 0.0, kReflectance),
                      .blades = table.number_or("blade_reflectance", 0.0, kReflectance)};
    if (auto barrel = table.optional_table("barrel")) {
        camera.barrel = formats::read_barrel(*barrel);
    }
    if (auto dust = table.optional_table("dust")) {
        camera.dust = read_dust(*dust);
    }
    camera.f_number = table.number("f_number", {.min = 0.1, .max = 1000.0});
    camera.focus_distance_mm = table.infinity("focus_distance_mm") > 0 ? std::numeric_limits<double>::infinity()
                                                                       : table.number("focus_distance_mm", kPositive);
    camera.sensor = read_sensor(table);
    if (camera.is_exposure_automatic) {
        camera.exposure.iso = table.number_or("iso", camera.exposure.iso, kPositive);
    } else {
        camera.exposure = {.time_s = table.number("shutter_s", kPositive), .iso = table.number("iso", kPositive)};
    }
    camera.response = table.choice("response", spectral::known_sensors());
}

void read_place(TomlTable& table, CameraSettings& camera) {
    camera.position_mm = read_vector(table, "position_mm");
    camera.look_at_mm = read_vector(table, "look_at_mm");
    camera.up = table.has("up") ? read_direction(table, "up") : camera.up;
    const Vec3d forwards = camera.look_at_mm - camera.position_mm;
    if (!(length(forwards) > 1e-9)) {
        table.fail("look_at_mm", "is where the camera stands, expected another place");
    }
    constexpr double kSmallestSine = 1e-6;
    if (length(cross(normalized(forwards), camera.up)) < kSmallestSine) {
        table.fail(table.has("up") ? "up" : "look_at_mm", "the camera looks along up, expected another direction");
    }
}

/// The model, and a focal length that stands in the place of a lens.
void read_model(TomlTable& table, CameraSettings& camera) {
    if (table.has("model")) {
        camera.model = lens_model_named(table.choice("model", lens_model_names())).value();
    }
    camera.focal_length_mm = table.optional_number("focal_length_mm", kPositive);
}

void check_model(TomlTable& table, const CameraSettings& camera) {
    if (const auto conflict = model_conflict(camera)) {
        table.fail(conflict->key, conflict->message);
    }
}

}  // namespace

const std::vector<std::string>& lens_model_names() {
    static const std::vector<std::string> names = {"exact",       "polynomial",  "paraxial",          "thin-lens",
                                                   "pinhole",     "exact-float", "thin-lens-profile", "pinhole-profile",
                                                   "exact-double"};
    return names;
}

const std::string& name_of(LensModel model) {
    return lens_model_names()[static_cast<std::size_t>(model)];
}

std::optional<LensModel> lens_model_named(const std::string& name) {
    const std::vector<std::string>& names = lens_model_names();
    const auto found = std::ranges::find(names, name);
    return found != names.end() ? std::optional(static_cast<LensModel>(found - names.begin())) : std::nullopt;
}

std::optional<ModelConflict> model_conflict(const CameraSettings& camera) {
    const std::string& name = name_of(camera.model);
    if (camera.focal_length_mm && camera.model != LensModel::thin_lens && camera.model != LensModel::pinhole) {
        return ModelConflict{"focal_length_mm", "is for the models thin-lens and pinhole; here the lens says it"};
    }
    if (camera.blades && !traces_surfaces(camera.model)) {
        return ModelConflict{"blades", fmt::format("stands beside model = \"{}\", whose pupil is round; expected the "
                                                   "exact model",
                                                   name)};
    }
    if (camera.barrel && !traces_surfaces(camera.model)) {
        return ModelConflict{
            "barrel", fmt::format("stands beside model = \"{}\", which has no walls; expected the exact model", name)};
    }
    if (camera.dust && !traces_surfaces(camera.model)) {
        return ModelConflict{"dust", fmt::format("stands beside model = \"{}\", which has no front to lie on; expected "
                                                 "the exact model",
                                                 name)};
    }
    return std::nullopt;
}

AffineMap camera_to_world(const CameraSettings& camera) {
    const Vec3d z = normalized(camera.look_at_mm - camera.position_mm);
    const Vec3d x = normalized(cross(z, camera.up));
    const Vec3d y = cross(z, x);
    return {.linear = {Vec3d{x.x, y.x, z.x}, Vec3d{x.y, y.y, z.y}, Vec3d{x.z, y.z, z.z}},
            .translation = camera.position_mm};
}

CameraSettings read_camera_settings(TomlTable& table) {
    CameraSettings camera;
    camera.lens = formats::read_lens_name(table);
    read_exposure(table, camera);
    table.finish();
    return camera;
}

CameraSettings read_placed_camera(TomlTable& table) {
    CameraSettings camera;
    camera.is_exposure_automatic = !table.has("shutter_s");
    if (table.has("exposure")) {
        table.choice("exposure", {"auto"});
        if (!camera.is_exposure_automatic) {
            table.fail("exposure", "stands beside shutter_s, which says it; expected one or the other");
        }
    }
    read_place(table, camera);
    read_model(table, camera);
    camera.lens = camera.focal_length_mm && !table.has("lens") ? "" : formats::read_lens_name(table);
    read_exposure(table, camera);
    camera.white_balance = scene::read_illuminant(table, "white_balance");
    check_model(table, camera);
    if (camera.focal_length_mm && !camera.lens.empty()) {
        table.fail("focal_length_mm", "stands beside lens, expected one or the other");
    }
    table.finish();
    return camera;
}

optics::Lens camera_lens(const CameraSettings& camera) {
    optics::Lens lens = formats::load_lens(camera.lens, {.zoom = camera.zoom, .coatings = camera.coatings});
    if (camera.blades) {
        lens.stop_mask = optics::StopMask(*camera.blades);
    }
    lens.barrel = camera.barrel.value_or(lens.barrel);
    if (camera.dust) {
        const optics::LensSurface& first = lens.surfaces.front();
        if (first.medium.formula == lens.object_medium.formula) {
            throw InputError(fmt::format("{}: its first surface is no face of glass, expected one for the dust of {}",
                                         lens.name, camera.dust->picture.string()));
        }
        lens.dust = optics::FrontDust{.covered = std::make_shared<const optics::ApertureTexture>(
                                          formats::read_aperture_texture(camera.dust->picture)),
                                      .semi_diameter = first.semi_diameter,
                                      .albedo = camera.dust->albedo,
                                      .through = camera.dust->through};
    }
    optics::require_air_in_front(lens, "a camera");
    optics::require_no_gratings(lens, "a camera's field");
    if (optics::refractive_index(lens.surfaces.back().medium.formula, spectral::kLineD) != 1.0) {
        throw InputError(fmt::format("{}: its last surface is followed by {}; cameras have their sensors in air",
                                     lens.name, lens.surfaces.back().medium.name));
    }
    return optics::focused_at(optics::with_f_number(std::move(lens), camera.f_number), camera.focus_distance_mm);
}

void read_spectral_sampling(TomlTable& table, SpectralSampling& sampling) {
    if (table.has("wavelengths_nm")) {
        const std::vector<double> range = table.numbers("wavelengths_nm", 2, {.min = 100.0, .max = 20000.0});
        sampling.min_nm = range[0];
        sampling.max_nm = range[1];
        if (!(range[0] < range[1])) {
            table.fail("wavelengths_nm", fmt::format("is [{}, {}], expected the shorter first", range[0], range[1]));
        }
    }
    sampling.layers = table.integer_or("layers", sampling.layers, 1, 1000);
    sampling.strata_per_layer = table.integer_or("strata_per_layer", sampling.strata_per_layer, 1, 100);
    constexpr int kMost = optics::SpectralLens<double>::kMostWavelengths;
    if (sampling.strata() > kMost) {
        table.fail("layers", fmt::format("{} layers of {} strata are {} wavelengths, expected {} at most",
                                         sampling.layers, sampling.strata_per_layer, sampling.strata(), kMost));
    }
}

}  // namespace lensproof::render
