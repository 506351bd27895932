#include "engine/render/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "engine/base/hash.h"
#include "engine/base/input_error.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/optics/lens_bytes.h"
#include "engine/optics/packet/spectral_lens.h"
#include "engine/pupil/kept_maps.h"
#include "engine/scene/illuminant_key.h"
#include "engine/spectral/illuminant.h"
#include "engine/spectral/spectral_exr.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::render {

namespace {

constexpr Bounds kSensorSide{.min = 0.0, .max = 1e4, .min_excluded = true};
constexpr double kMostPixels = 200e6;
constexpr double kMostValues = 2e9;  // 16 GB of sums

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

std::vector<optics::TraceLens<double>> lenses_of(const std::vector<WavelengthStratum>& strata) {
    std::vector<optics::TraceLens<double>> lenses;
    std::ranges::transform(strata, std::back_inserter(lenses), &WavelengthStratum::lens);
    return lenses;
}

SpectralStrata make_strata(const Camera& camera, const optics::Lens& lens, const Light& light,
                           const SpectralSampling& spectral) {
    const auto [min_nm, max_nm, clamp_note] = sampled_band(spectral, lens);
    const int count = spectral.layers * spectral.strata_per_layer;
    if (count > optics::SpectralLens<double>::kMostWavelengths) {
        throw InputError(fmt::format("{} layers of {} strata are {} wavelengths, expected {} at most", spectral.layers,
                                     spectral.strata_per_layer, count, optics::SpectralLens<double>::kMostWavelengths));
    }
    SpectralStrata made{.strata = {}, .layer_nm = {}, .clamp_note = clamp_note};
    const spectral::WavelengthStrata bands = spectral::wavelength_strata(min_nm, max_nm, count);
    const spectral::Illuminant source = spectral::illuminant(light.illuminant);
    const spectral::Spectrum radiance = spectral::radiance_of(source, light.luminance_cd_m2);
    const spectral::SensorResponse response = spectral::sensor_response(camera.response, camera.exposure, source);
    const std::vector<Vec3d> all_weights = spectral::stratum_weights(response, bands, source);
    for (int i = 0; i < bands.count; ++i) {
        const double nm = bands.midpoint(i);
        const Vec3d& weights = all_weights[i];
        made.strata.push_back(
            {.wavelength_nm = nm,
             .lens = optics::at_wavelength<double>(lens, nm),
             .white_radiance = radiance(nm),
             .rgb_weights = response.channels.size() == 1 ? Vec3d{weights.x, weights.x, weights.x} : weights});
    }
    made.width_nm = bands.width_nm();
    made.layer_nm = spectral::WavelengthStrata{min_nm, max_nm, spectral.layers}.midpoints();
    return made;
}

}  // namespace

SampledBand sampled_band(const SpectralSampling& sampling, const optics::Lens& lens) {
    const optics::WavelengthRange range = optics::wavelength_range(lens);
    SampledBand band{.min_nm = std::max(sampling.min_nm, range.min_nm),
                     .max_nm = std::min(sampling.max_nm, range.max_nm),
                     .clamp_note = {}};
    if (!(band.min_nm < band.max_nm)) {
        throw InputError(fmt::format("wavelengths of {} to {} nm: the glasses of {} are known from {} to {} nm only",
                                     sampling.min_nm, sampling.max_nm, lens.name, range.min_nm, range.max_nm));
    }
    if (band.min_nm != sampling.min_nm || band.max_nm != sampling.max_nm) {
        band.clamp_note = fmt::format("wavelengths clamped to {} to {} nm, where the glasses of {} are known",
                                      band.min_nm, band.max_nm, lens.name);
    }
    return band;
}

std::map<std::string, std::string> camera_metadata(const Camera& camera, const std::string& lens_name,
                                                   const std::string& illuminant, const PixelFilter& filter,
                                                   bool has_colour_space) {
    return {{"lensproof:lens", lens_name},
            {"lensproof:fNumber", fmt::format("{}", camera.f_number)},
            {"lensproof:focusDistance_mm", fmt::format("{}", camera.focus_distance_mm)},
            {"lensproof:pixelPitch_um", fmt::format("{}", 1e3 * camera.sensor.pixel_pitch_mm)},
            {"lensproof:shutter_s", fmt::format("{}", camera.exposure.time_s)},
            {"lensproof:iso", fmt::format("{}", camera.exposure.iso)},
            {"lensproof:response", camera.response},
            {"lensproof:illuminant", illuminant},
            {"lensproof:pixelFilter", filter.name()},
            {"lensproof:colourSpace", has_colour_space ? "linear, Rec. 709 primaries, the illuminant's white"
                                                       : "linear, the sensor's own, balanced to the illuminant"}};
}

Camera read_camera_keys(TomlTable& table, bool may_lack_lens) {
    Camera camera;
    camera.lens = may_lack_lens ? table.text_or("lens", "") : table.text("lens");
    camera.zoom = table.text_or("zoom", "");
    camera.blades = read_blades(table);
    camera.f_number = table.number("f_number", {.min = 0.1, .max = 1000.0});
    camera.focus_distance_mm = table.infinity("focus_distance_mm") > 0 ? std::numeric_limits<double>::infinity()
                                                                       : table.number("focus_distance_mm", kPositive);
    camera.sensor = read_sensor(table);
    camera.exposure.time_s = table.number("shutter_s", kPositive);
    camera.exposure.iso = table.number("iso", kPositive);
    camera.response = table.choice("response", spectral::known_sensors());
    return camera;
}

Camera read_camera(TomlTable& table) {
    Camera camera = read_camera_keys(table);
    table.finish();
    return camera;
}

Light read_light(TomlTable& table) {
    Light light;
    light.illuminant = scene::read_illuminant(table, "illuminant");
    light.luminance_cd_m2 = table.number_or("luminance_cd_m2", light.luminance_cd_m2, kPositive);
    table.finish();
    return light;
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
}

void read_render_table(TomlTable& table, ChartScene& scene) {
    scene.samples_per_pixel = table.integer_or("samples_per_pixel", scene.samples_per_pixel, 1, 1 << 20);
    read_spectral_sampling(table, scene.spectral);
    table.finish();
}

ChartScene read_chart_scene(const std::filesystem::path& file) {
    TomlTable top = TomlTable::read(file);
    ChartScene scene;
    TomlTable camera = top.table("camera");
    scene.camera = read_camera(camera);
    TomlTable chart = top.table("chart");
    scene.chart = scene::read_chart(chart);
    if (!std::holds_alternative<scene::FlatField>(scene.chart.pattern)) {
        TomlTable pose = top.table("pose");
        scene.placement = scene::read_placement(pose);
    }
    if (auto light = top.optional_table("light")) {
        scene.light = read_light(*light);
    }
    if (auto render = top.optional_table("render")) {
        read_render_table(*render, scene);
    }
    if (auto sensor = top.optional_table("sensor")) {
        scene.sensor = read_raw_sensor(*sensor, {.response = scene.camera.response,
                                                 .exposure = scene.camera.exposure,
                                                 .white = scene.light.illuminant,
                                                 .width = scene.camera.sensor.width,
                                                 .height = scene.camera.sensor.height});
    }
    top.finish();
    return scene;
}

optics::Lens camera_lens(const Camera& camera) {
    optics::Lens lens = formats::load_lens(camera.lens, {.zoom = camera.zoom});
    if (camera.blades) {
        lens.stop_mask = optics::StopMask(*camera.blades);
    }
    return optics::focused_at(optics::with_f_number(std::move(lens), camera.f_number), camera.focus_distance_mm);
}

ChartCamera::ChartCamera(const Camera& camera, const Light& light, const SpectralSampling& spectral, const Cache& cache,
                         const PixelFilter& filter)
    : camera_(camera),
      lens_(camera_lens(camera)),
      spectral_(make_strata(camera, lens_, light, spectral)),
      filter_(filter),
      // Pixels are areas: the corner of what the corner pixel's filter reaches is the farthest point sampled.
      pupil_(pupil::kept_pupil_map(cache, lenses_of(spectral_.strata), lens_.is_rotationally_symmetric,
                                   camera.sensor.half_diagonal_mm(filter.radius_px() - 0.5))),
      colours_(spectral::rgb_space(camera.response, spectral::illuminant(light.illuminant))) {
    const double values =
        static_cast<double>(camera.sensor.width) * camera.sensor.height * (6.0 + static_cast<double>(spectral.layers));
    if (values > kMostValues) {
        throw InputError(
            fmt::format("{} × {} pixels with {} spectral layers are {:.1f} billion values, expected {:.0f} billion "
                        "at most: fewer pixels or layers",
                        camera.sensor.width, camera.sensor.height, spectral.layers, values / 1e9, kMostValues / 1e9));
    }
    metadata_ = camera_metadata(camera, lens_.name, light.illuminant, filter, colours_.has_value());
}

SeenChart ChartCamera::view(const scene::Chart& chart, const scene::Placement& placement) const {
    return {.chart = chart,
            .pose = scene::place(placement),
            .sensor = camera_.sensor,
            .strata = spectral_.strata,
            .stratum_width_nm = spectral_.width_nm,
            .layer_nm = spectral_.layer_nm,
            .filter = filter_};
}

std::string ChartCamera::lens_hash() const {
    std::string bytes;
    for (const WavelengthStratum& stratum : spectral_.strata) {
        optics::append_lens_bytes(bytes, stratum.lens);
    }
    return hash_text(bytes);
}

formats::Image ChartCamera::render(const scene::Chart& chart, const scene::Placement& placement,
                                   const RenderSettings& settings, const std::function<void(double)>& progress) const {
    formats::Image image = render_chart(view(chart, placement), pupil_, settings, progress);
    image.metadata = metadata_;
    image.metadata.merge(spectral::spectral_attributes(spectral::kFilmIrradianceUnits));
    return image;
}

}  // namespace lensproof::render
