#include "engine/render/camera/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lensproof::render::camera_test {
namespace {

CameraSettings tessar_camera() {
    CameraSettings settings;
    settings.lens = "tessar";
    settings.f_number = 8.0;
    settings.focus_distance_mm = 3000.0;
    settings.sensor = {.width = 40, .height = 30, .pixel_pitch_mm = 0.6};
    settings.exposure = {.time_s = 0.01, .iso = 100.0};
    settings.response = "luminance";
    return settings;
}

constexpr SpectralSampling kFourWavelengths{.layers = 4, .strata_per_layer = 1};

TEST(Camera, PathsOfASensorBesideTheAxisComeBackToTheirPixels) {
    CameraSettings settings = tessar_camera();
    settings.sensor.axis_from_middle_px = {12.25, -7.5};
    const Camera camera(settings, kFourWavelengths, PixelFilter{}, Cache());
    CameraPaths paths = camera.paths(1, PathCarry::hero);
    paths.start({.pixels = 40 * 30, .samples = 2});
    CameraPathBuffer buffer;
    int seen = 0;
    Vec2d mean;
    while (paths.fill(buffer)) {
        for (int n = 0; n < buffer.size; ++n) {
            const auto i = static_cast<std::size_t>(n);
            const std::uint16_t hero = buffer.wavelength[i];
            const Ray<double> out = buffer.ray(i);
            const FilmImportance back =
                camera.importance({out.origin, -1.0 * out.direction}, {{hero, hero, hero, hero}});
            const std::uint32_t pixel = buffer.pixel[i];
            const std::uint32_t row = pixel / 40;
            // Boxes of a pixel each, and the rounding of packets in float.
            EXPECT_NEAR(back.at_px[0].x, pixel % 40, 0.5 + 1e-3);
            EXPECT_NEAR(back.at_px[0].y, row, 0.5 + 1e-3);
            mean = mean + Vec2d{buffer.film_x[i], buffer.film_y[i]};
            ++seen;
        }
    }
    ASSERT_GT(seen, 2000);
    // The middle of the frame lies left of the axis and above it on the sensor, by what the axis lies right and below.
    const double within = 6.0 * 0.6 * 40.0 / std::sqrt(12.0 * seen);
    EXPECT_NEAR(mean.x / seen, 12.25 * 0.6, within);
    EXPECT_NEAR(mean.y / seen, 7.5 * 0.6, within);
    EXPECT_DOUBLE_EQ(settings.sensor.half_diagonal_mm(), 0.6 * std::hypot(32.25, 22.5));
}

TEST(Camera, TakesALensInThePlaceOfTheOneNamed) {
    const CameraSettings settings = tessar_camera();
    const Camera named(settings, kFourWavelengths, PixelFilter{}, Cache());
    optics::Lens lens = camera_lens(settings);
    EXPECT_EQ(named.hash(), Camera(settings, lens, kFourWavelengths, PixelFilter{}, Cache()).hash());
    lens.image_z += 0.1;
    EXPECT_NE(named.hash(), Camera(settings, lens, kFourWavelengths, PixelFilter{}, Cache()).hash());
}

}  // namespace
}  // namespace lensproof::render::camera_test
