#include "engine/render/metering.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/input_error.h"
#include "engine/render/prepared_scene.h"

namespace lensproof::render {

namespace {

constexpr double kMostSide = 96.0;
constexpr std::uint32_t kSamples = 64;
constexpr double kDarkest = 1e-3;  // of the mean

/// The scene as the pilot sees it, at an exposure of a second.
SceneSetup pilot_of(const SceneSetup& setup) {
    SceneSetup pilot = setup;
    CameraSettings& camera = pilot.camera;
    camera.model = LensModel::thin_lens;
    camera.blades.reset();
    camera.barrel.reset();
    camera.dust.reset();
    camera.exposure.time_s = 1.0;
    camera.is_exposure_automatic = false;
    const double coarser = std::max({1.0, camera.sensor.width / kMostSide, camera.sensor.height / kMostSide});
    camera.sensor.width = std::max(1, static_cast<int>(std::lround(camera.sensor.width / coarser)));
    camera.sensor.height = std::max(1, static_cast<int>(std::lround(camera.sensor.height / coarser)));
    camera.sensor.pixel_pitch_mm *= coarser;
    camera.sensor.axis_from_middle_px = (1.0 / coarser) * camera.sensor.axis_from_middle_px;
    return pilot;
}

/// Of its pixels' means of R, G and B; what lies outside the response's primaries may be below 0.
double log_average(const Film& film) {
    std::vector<double> brightness;
    double sum = 0.0;
    for (int y = 0; y < film.height(); ++y) {
        for (int x = 0; x < film.width(); ++x) {
            const Vec3d rgb = film.estimate(x, y).rgb;
            brightness.push_back(std::max(0.0, (rgb.x + rgb.y + rgb.z) / 3.0));
            sum += brightness.back();
        }
    }
    const double darkest = kDarkest * sum / static_cast<double>(brightness.size());
    if (!(darkest > 0.0)) {
        throw InputError("the exposure is automatic, but no light is seen that it could follow; expected shutter_s");
    }
    double logarithms = 0.0;
    for (const double value : brightness) {
        logarithms += std::log(std::max(value, darkest));
    }
    return std::exp(logarithms / static_cast<double>(brightness.size()));
}

}  // namespace

bool meter(SceneSetup& setup, const Cache& cache, int threads) {
    if (!setup.camera.is_exposure_automatic) {
        return false;
    }
    const PreparedScene scene(pilot_of(setup), PixelFilter{}, cache);
    const double seen = log_average(render_film(scene.render(0, false), {.first = 0, .end = kSamples}, threads));
    const double third_stops = std::round(3.0 * std::log2(kMiddleGrey / seen));
    setup.camera.exposure.time_s = std::exp2(third_stops / 3.0);
    setup.camera.is_exposure_automatic = false;
    if (setup.sensor) {
        setup.sensor->camera.exposure = setup.camera.exposure;
    }
    return true;
}

void expect_stated_exposure(const SceneSetup& setup, const std::filesystem::path& file) {
    if (setup.camera.is_exposure_automatic) {
        throw InputError(
            fmt::format("{}: camera: its exposure is automatic, but pictures that are compared share one; "
                        "expected shutter_s and iso",
                        file.string()));
    }
}

}  // namespace lensproof::render
