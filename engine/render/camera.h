// engine/render/camera.h — a camera, its light and its spectral sampling as files state them, and a chart scene from
// them.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/cache.h"
#include "engine/base/toml.h"
#include "engine/optics/lens.h"
#include "engine/render/chart_render.h"
#include "engine/render/raw_sensor.h"
#include "engine/scene/chart_file.h"
#include "engine/spectral/sensor_response.h"

namespace lensproof::render {

struct Camera {
    std::string lens;  // a file, or the name of a lens that ships
    std::string zoom;  // the position's name or number; empty: the first
    /// Blades in place of what shape the lens's stop has, in the circle that the f-number says.
    std::optional<optics::PolygonStop> blades;
    double f_number = 0.0;
    double focus_distance_mm = 0.0;  // from the first vertex; may be infinite
    Sensor sensor;
    spectral::Exposure exposure;
    std::string response;
};

/// Reads a camera's table: lens, zoom (optional), blades with blade_curvature and blade_rotation_deg (optional),
/// f_number, focus_distance_mm (inf allowed), sensor_mm = [w, h], pixels = [w, h], shutter_s, iso, response. Throws
/// InputError naming file, line and key; pixels have to be square.
Camera read_camera(TomlTable& table);

/// The same keys, for a table that has more; without a lens, if that `may_lack_lens`.
Camera read_camera_keys(TomlTable& table, bool may_lack_lens = false);

struct Light {
    std::string illuminant = "D65";
    double luminance_cd_m2 = 1000.0;  // of a perfect white in it
};

Light read_light(TomlTable& table);

/// How a render samples wavelengths: `layers` spectral layers of equal width, each made of `strata_per_layer` strata.
struct SpectralSampling {
    double min_nm = 400.0;
    double max_nm = 700.0;
    int layers = 32;  // with two strata each, as many as the default samples: each sample then has its own wavelength
    int strata_per_layer = 2;
};

/// Reads wavelengths_nm = [from, to], layers and strata_per_layer, all optional, over what `sampling` says.
void read_spectral_sampling(TomlTable& table, SpectralSampling& sampling);

/// The band of `sampling` that a lens's glasses are known in.
struct SampledBand {
    double min_nm = 0.0;
    double max_nm = 0.0;
    std::string clamp_note;  // says so where that is less than what was asked for
};

/// Throws InputError where they are known nowhere in it.
SampledBand sampled_band(const SpectralSampling& sampling, const optics::Lens& lens);

/// What a picture's file says of its camera: the balance's illuminant, what the pixels see, and whether R, G, B are in
/// a space of their own or in the sensor's.
std::map<std::string, std::string> camera_metadata(const Camera& camera, const std::string& lens_name,
                                                   const std::string& illuminant, const PixelFilter& filter,
                                                   bool has_colour_space);

/// What is rendered and how finely.
struct ChartScene {
    Camera camera;
    std::optional<RawSensor> sensor;  // behind the film, for its raw file
    Light light;
    SpectralSampling spectral;
    int samples_per_pixel = 64;
    scene::Chart chart;
    scene::Placement placement;
};

/// Reads the optional table [render]: samples_per_pixel, wavelengths_nm = [from, to], layers, strata_per_layer.
void read_render_table(TomlTable& table, ChartScene& scene);

/// Reads a scene file: [camera], [light], [chart], [pose], [render] and [sensor] (`read_raw_sensor`); all but [camera]
/// and [chart] optional, [pose] for a flat field alone.
ChartScene read_chart_scene(const std::filesystem::path& file);

/// The camera's lens: loaded, given its blades, stopped down and focused.
optics::Lens camera_lens(const Camera& camera);

/// A lens at the wavelengths that a render samples.
struct SpectralStrata {
    std::vector<WavelengthStratum> strata;
    double width_nm = 0.0;
    std::vector<double> layer_nm;
    std::string clamp_note;  // says so where wavelengths were clamped to the range of the lens's glasses
};

/// A camera with everything about its lens computed once, ready for any number of charts.
class ChartCamera {
  public:
    /// `cache`: for what is found by tracing the lens; the same pictures come from any.
    ChartCamera(const Camera& camera, const Light& light, const SpectralSampling& spectral, const Cache& cache = {},
                const PixelFilter& filter = {});

    [[nodiscard]] formats::Image render(const scene::Chart& chart, const scene::Placement& placement,
                                        const RenderSettings& settings,
                                        const std::function<void(double)>& progress = {}) const;

    /// What this camera sees of a chart, and the map of its pupil to render it with.
    [[nodiscard]] SeenChart view(const scene::Chart& chart, const scene::Placement& placement) const;
    [[nodiscard]] const pupil::PupilMap& pupil() const { return pupil_; }

    /// What a picture's file says of the camera, and the space of its R, G, B where they are not the camera's own.
    [[nodiscard]] const std::map<std::string, std::string>& metadata() const { return metadata_; }
    [[nodiscard]] const std::optional<spectral::RgbSpace>& colours() const { return colours_; }

    /// A hash of all that rays meet in the lens, at every wavelength.
    [[nodiscard]] std::string lens_hash() const;

    [[nodiscard]] const optics::Lens& lens() const { return lens_; }
    [[nodiscard]] const Sensor& sensor() const { return camera_.sensor; }
    [[nodiscard]] const SpectralStrata& spectral() const { return spectral_; }

  private:
    Camera camera_;
    optics::Lens lens_;
    SpectralStrata spectral_;
    PixelFilter filter_;
    pupil::PupilMap pupil_;  // over the band of the strata
    std::map<std::string, std::string> metadata_;
    std::optional<spectral::RgbSpace> colours_;
};

}  // namespace lensproof::render
