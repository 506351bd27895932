#include "engine/render/camera/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "engine/optics/convert_lens.h"

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

// In packets each ray has the bits that it has by itself: those that arrive, those that rims stop and those that miss,
// more than fit in one go, and with dust before the lens. In double it is where the tracer of single rays brings it,
// the film's plane being met from some 50 mm before it with a few roundings of 40 px.
TEST(Camera, ManyRaysEndWhereEachEndsAlone) {
    for (const LensModel model : {LensModel::exact, LensModel::exact_float, LensModel::thin_lens}) {
        CameraSettings settings = tessar_camera();
        settings.model = model;
        std::optional<optics::Lens> lens = camera_lens(settings);
        lens->dust =
            optics::FrontDust{.covered = std::make_shared<const optics::ApertureTexture>(
                                  optics::ApertureTexture{.size_x = 3, .size_y = 1, .values = {1.0F, 0.0F, 0.25F}}),
                              .semi_diameter = lens->surfaces.front().semi_diameter,
                              .albedo = 0.9,
                              .through = 0.5};
        const Camera camera(settings, lens, {.layers = 4, .strata_per_layer = 16}, PixelFilter{}, Cache());
        std::vector<Ray<double>> rays;
        std::vector<spectral::PathWavelengths> paths;
        std::mt19937_64 random(1);
        std::uniform_real_distribution<double> across(-12.0, 12.0);
        std::uniform_real_distribution<double> slope(-0.3, 0.3);
        for (int i = 0; i < 1000; ++i) {
            rays.push_back(
                {{across(random), across(random), -20.0}, normalized(Vec3d{slope(random), slope(random), 1.0})});
            paths.push_back(camera.grid().path(i % camera.grid().size()));
        }
        std::vector<FilmImportance> found(rays.size());
        camera.importances(rays, paths, found);
        int arrived = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const FilmImportance alone = camera.importance(rays[i], paths[i]);
            EXPECT_EQ(found[i].at_px, alone.at_px) << name_of(model);
            EXPECT_EQ(found[i].transmittance, alone.transmittance);
            EXPECT_EQ(found[i].pdf, alone.pdf);
            arrived += alone.is_dark() ? 0 : 1;
            for (std::size_t m = 0; model == LensModel::exact && m < paths[i].index.size(); ++m) {
                const optics::TraceLens<double>& at = camera.exact().lens().at(paths[i].index[m]);
                const auto traced = optics::trace<optics::Direction::forward>(at, optics::convert_ray<double>(rays[i]));
                const bool arrives = traced.status == optics::RayStatus::ok;
                const double clear = lens->dust->clear(rays[i], camera.exact().lens().at().front());
                EXPECT_EQ(found[i].transmittance[m], arrives ? clear * traced.transmittance : 0.0);
                if (arrives) {
                    const Vec3d film = optics::meet_plane(traced.ray, at.image_z).point;
                    const Vec2d px = camera.sensor().pixel(Vec2d{film.x, film.y});
                    EXPECT_NEAR(found[i].at_px[m].x, px.x, 1e-11);
                    EXPECT_NEAR(found[i].at_px[m].y, px.y, 1e-11);
                }
            }
        }
        EXPECT_GT(arrived, 30) << name_of(model);
        EXPECT_TRUE(model == LensModel::thin_lens || arrived < 970) << name_of(model);
    }
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
