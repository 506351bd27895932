#include "engine/render/stray/wave_entrance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/render/integrators/passes.h"
#include "tests/validation/small_scene.h"

namespace lensproof::render::wave_entrance_test {
namespace {

const spectral::SpectralGrid kGrid = spectral::spectral_grid(545.0, 555.0, 4);
constexpr Vec3d kStraight{0.0, 0.0, 1.0};

CameraSettings tessar(double f_number, double focus_mm) {
    return {.lens = "tessar",
            .f_number = f_number,
            .focus_distance_mm = focus_mm,
            .sensor = {.width = 16, .height = 16, .pixel_pitch_mm = 1e-3},
            .response = "luminance"};
}

scene::SunLight sun(const Vec3d& towards, double across_deg) {
    return {.towards = towards,
            .cos_radius = std::cos(radians(0.5 * across_deg)),
            .radiance = spectral::constant_spectrum(1.0, kGrid)};
}

TEST(WaveEntrance, SaysWhatRaysImage) {
    const Camera camera(tessar(8.0, kInfinity), {545.0, 555.0, 4, 1}, {}, {});
    const auto refused = [](const Camera& by, const scene::SunLight& of) {
        EXPECT_THROW(WaveEntrance(by, {of}, {}), InputError);
    };
    refused(camera, sun(kStraight, 1.5));
    refused(camera, sun({0.0, std::sin(radians(80.0)), std::cos(radians(80.0))}, 0.5));
    refused(camera, sun({0.0, 0.0, -1.0}, 0.5));
    refused(Camera(tessar(2.8, 500.0), {545.0, 555.0, 4, 1}, {}, {}), sun(kStraight, 0.5));
    SceneParts parts(kGrid);
    parts.add(scene::Sphere{1.0}, {.linear = kIdentity3, .translation = {0.0, 0.0, -500.0}}, 0.5);
    const World dark = parts.scene();
    const View view{.world = &dark, .camera = &camera, .seed = 1, .paths = {}};
    EXPECT_THROW(renders_of({"waves"}, view, {}), InputError);
}

}  // namespace
}  // namespace lensproof::render::wave_entrance_test
