// engine/render/camera/camera_settings.h — a camera and its spectral sampling as files state them.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/toml.h"
#include "engine/optics/ghost_path.h"
#include "engine/optics/lens.h"
#include "engine/render/film/sensor.h"
#include "engine/scene/chart/pose.h"
#include "engine/spectral/sensor_response.h"

namespace lensproof::render {

/// What stands for the lens. All are made from a lens and its settings, expose alike, and so can be compared:
///
///   exact              the lens itself, surface by surface: all places and angles in double; of a path's wavelengths
///                      but its hero how much arrives, in float
///   exact-double       all in double
///   exact-float        all in float
///   polynomial         sparse polynomials of its traced rays, of known error (engine/polynomial)
///   paraxial           its Gaussian optics at each wavelength: pupils, principal planes, axial and lateral colour of
///                      first order; no other aberration, no rims but the stop
///   thin-lens-profile  a thin lens with the distortion, the lateral colour and the brightness over the field that the
///                      lens has, and a pupil that moves with the field as the lens's does
///   thin-lens          focal length and entrance pupil of the reference line, at the front principal plane
///   pinhole-profile    the centre of the pupil of thin-lens-profile alone
///   pinhole            the thin lens's centre alone, with the light of its whole opening: no blur
///
/// Paraxial, thin lens and pinhole pass what the lens passes along its axis; the profiles what it passes anywhere.
enum class LensModel {
    exact,
    polynomial,
    paraxial,
    thin_lens,
    pinhole,
    exact_float,
    thin_lens_profile,
    pinhole_profile,
    exact_double
};

/// "exact", …, in the order of the enumeration; and what a name means: nothing for others.
const std::vector<std::string>& lens_model_names();
const std::string& name_of(LensModel model);
std::optional<LensModel> lens_model_named(const std::string& name);

/// Whether its rays are traced through the lens, surface by surface.
constexpr bool traces_surfaces(LensModel model) {
    return model == LensModel::exact || model == LensModel::exact_double || model == LensModel::exact_float;
}
/// And in double.
constexpr bool traces_in_double(LensModel model) {
    return traces_surfaces(model) && model != LensModel::exact_float;
}

/// Dust and scratches on the lens's first surface (optics::FrontDust), as a picture of its clear aperture has them.
struct DustSettings {
    std::filesystem::path picture;  // white where they cover the glass
    double albedo = 0.0;
    double through = 0.5;
};

struct CameraSettings {
    std::string lens;  // a file, or the name of a lens that ships; empty where a focal length stands for it
    std::string zoom;  // the position's name or number; empty: the first
    std::vector<std::string> coatings;  // in the place of its own: see formats::with_coatings
    /// Blades in place of what shape the lens's stop has, in the circle that the f-number says.
    std::optional<optics::PolygonStop> blades;
    optics::StrayMirrors<double> mirrors;        // what the sensor and the blades reflect
    std::optional<optics::BarrelFinish> barrel;  // in the place of the lens's own
    std::optional<DustSettings> dust;
    double f_number = 0.0;
    double focus_distance_mm = 0.0;  // from the first vertex; may be infinite
    Sensor sensor;
    spectral::Exposure exposure;
    bool is_exposure_automatic = false;  // its time is not yet known: `meter` finds it (engine/render/metering.h)
    std::string response;
    std::string white_balance = "D65";  // the illuminant in which a white surface is R = G = B
    LensModel model = LensModel::exact;
    std::optional<double> focal_length_mm;  // of a thin lens or a pinhole that stands for no lens

    // Where it stands in the world.
    Vec3d position_mm;  // of the vertex of the lens's first surface
    Vec3d look_at_mm{0, 0, 1};
    Vec3d up{0, 1, 0};
};

/// X_world = R · X_camera + t. The camera frame is that of pose.h.
AffineMap camera_to_world(const CameraSettings& camera);

/// Reads a camera's table: lens, zoom (optional), coating (optional), blades with blade_curvature and
/// blade_rotation_deg (optional), sensor_reflectance and blade_reflectance (optional), barrel (optional), dust
/// (optional), f_number, focus_distance_mm (inf allowed), sensor_mm = [w, h], pixels = [w, h], shutter_s, iso,
/// response. Throws InputError naming file, line and key; pixels have to be square.
CameraSettings read_camera_settings(TomlTable& table);

/// The same of a camera that stands in a world, whose exposure may be automatic: without shutter_s, and with exposure =
/// "auto" in its place or nothing, iso is 100 unless it is said. And: position_mm, look_at_mm, and up, model,
/// focal_length_mm in the place of a lens, white_balance (optional).
CameraSettings read_placed_camera(TomlTable& table);

/// What in a camera's settings makes no sense beside its model: the key, and what is wrong with it.
struct ModelConflict {
    std::string key;
    std::string message;
};
std::optional<ModelConflict> model_conflict(const CameraSettings& camera);

/// The camera's lens, which it has to have: loaded, given its blades and its dust, stopped down and focused.
optics::Lens camera_lens(const CameraSettings& camera);

/// How a render samples wavelengths: `layers` spectral layers of equal width, each made of `strata_per_layer` strata.
struct SpectralSampling {
    double min_nm = 400.0;
    double max_nm = 700.0;
    int layers = 32;  // with two strata each, as many as the default samples: each sample then has its own wavelength
    int strata_per_layer = 2;

    [[nodiscard]] int strata() const { return layers * strata_per_layer; }
};

/// Reads wavelengths_nm = [from, to], layers and strata_per_layer, all optional, over what `sampling` says.
void read_spectral_sampling(TomlTable& table, SpectralSampling& sampling);

}  // namespace lensproof::render
