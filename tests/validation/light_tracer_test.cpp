// Light traced to the film from the lights, and radiance fetched from the scene by the camera: one image.
#include "engine/render/light_tracer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/optics/focus.h"
#include "engine/optics/lens.h"
#include "engine/render/scene_render.h"
#include "engine/scene/scene_description.h"
#include "tests/validation/small_scene.h"

namespace lensproof {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const SpectralGrid kGrid = spectral_grid(420.0, 680.0, 16);

/// A lens before a scene, and a film of few, large pixels.
class Studio {
  public:
    Studio(const std::string& name, double f_number, double focus_mm, const Sensor& sensor, SceneParts& parts)
        : sensor_(sensor),
          traced_(at_wavelengths<double>(focused_at(with_f_number(load_lens(name), f_number), focus_mm),
                                         kGrid.strata.midpoints())),
          pupil_(traced_.at(), true, sensor.half_diagonal_mm()),
          slices_(pupil_, kGrid.size()),
          entrance_(traced_.at(), true, kInfinity, {.defensive_share = 0.2}),
          scene_(parts.scene()),
          camera_(ExactCamera{&traced_, &slices_}) {}

    Film by_camera(std::uint32_t samples) const {
        return filled(samples, [&](FilmTile& tile) {
            SceneView view{.scene = &scene_,
                           .camera = &camera_,
                           .camera_to_world = camera_to_world({}),
                           .sensor = sensor_,
                           .film = layout(),
                           .albedo_weights = {},
                           .paths = kPaths,
                           .seed = 1};
            scene_renderer(view)({tile.rect(), 0, samples}, tile);
        });
    }

    Film by_lights(std::uint32_t paths) const {
        const LensEntrance entrance{.lens = &traced_,
                                    .map = &entrance_,
                                    .front = front_sphere(traced_.at(0)),
                                    .camera_to_world = camera_to_world({}),
                                    .sensor = sensor_};
        return filled(0, [&](FilmTile& tile) {
            for (std::uint32_t i = 0; i < paths; ++i) {
                PathSampler numbers(2, 0, i);
                tile.begin_light_path();
                // By a number of its own: the index itself goes with the strata of every other number.
                const PathWavelengths strata = kGrid.path(static_cast<int>(numbers.next()[0] * kGrid.size()));
                trace_light_path(scene_, entrance, strata, kPaths, numbers, tile);
            }
        });
    }

  private:
    static constexpr PathSettings kPaths{.max_bounces = 3};

    [[nodiscard]] FilmLayout layout() const {
        // R, G and B all are the mean irradiance over the band.
        const double band = kGrid.strata.max_nm - kGrid.strata.min_nm;
        return {.width = sensor_.width,
                .height = sensor_.height,
                .layer_nm = kGrid.strata.midpoints(),
                .rgb_weights = std::vector<Vec3d>(16, {1.0 / band, 1.0 / band, 1.0 / band}),
                .band_nm = band,
                .filter = {},
                .has_splats = true};
    }

    template <class Fill>
    Film filled(std::uint32_t samples, const Fill& fill) const {
        Film film(layout());
        FilmTile tile(film.layout());
        film.load({.rect = {0, 0, sensor_.width, sensor_.height}, .first = 0, .end = samples}, tile);
        fill(tile);
        tile.finish();
        film.store(tile);
        return film;
    }

    Sensor sensor_;
    SpectralLens<double> traced_;
    PupilMap pupil_;
    PupilSlices slices_;
    EntranceMap entrance_;
    Scene scene_;
    SceneCamera camera_;
};

// The camera fetches radiance by paths from the film, reversed through the lens; lights send theirs forward through it.
// Both are unbiased estimates of one film irradiance, so in each pixel they differ by no more than their standard
// errors say: χ² over the pixels lies within five of its standard deviations √(2n), and the totals within four errors.
void expect_same_image(const Studio& studio, const Sensor& sensor, std::uint32_t samples, std::uint32_t light_paths) {
    const Film camera = studio.by_camera(samples);
    const Film light = studio.by_lights(light_paths);
    double chi2 = 0.0;
    int lit = 0;
    Vec2d totals;
    double variance = 0.0;
    for (int y = 0; y < sensor.height; ++y) {
        for (int x = 0; x < sensor.width; ++x) {
            const PixelEstimate a = camera.camera_estimate(x, y);
            const PixelEstimate b = light.light_estimate(x, y);
            const double both = a.variance.x + b.variance.x;
            totals = {totals.x + a.rgb.x, totals.y + b.rgb.x};
            variance += both;
            if (both > 0.0) {
                ++lit;
                chi2 += (a.rgb.x - b.rgb.x) * (a.rgb.x - b.rgb.x) / both;
            }
        }
    }
    fmt::print("totals {:.5g} and {:.5g}, standard error {:.2f} %, chi² {:.1f} of {} pixels\n", totals.x, totals.y,
               100.0 * std::sqrt(variance) / totals.x, chi2, lit);
    EXPECT_NEAR(totals.x, totals.y, 4.0 * std::sqrt(variance));
    EXPECT_LT(std::sqrt(variance), 0.015 * totals.x);
    EXPECT_GT(lit, sensor.width * sensor.height / 2);
    EXPECT_LT(chi2, lit + 5.0 * std::sqrt(2.0 * lit));
}

TEST(LightTracer, MakesTheCamerasImageOfALitWall) {
    const Sensor sensor{.width = 9, .height = 6, .pixel_pitch_mm = 4.0};
    SceneParts parts(kGrid);
    AffineMap towards_camera{.linear = about_x(180.0), .translation = {0.0, 0.0, 2000.0}};
    parts.add(Quad{4000.0, 4000.0}, towards_camera, 0.7);
    parts.add(Sphere{200.0}, {.linear = kIdentity3, .translation = {150.0, 0.0, 1700.0}}, 0.5);
    const std::uint32_t lamp =
        parts.add(Quad{500.0, 500.0}, {.linear = about_x(90.0), .translation = {0.0, 800.0, 1500.0}}, 0.0);
    parts.lights.emplace_back(AreaLight{.object = lamp, .radiance = constant_spectrum(20.0, kGrid)});
    const Studio studio("double-gauss-tronnier", 2.0, 2000.0, sensor, parts);
    expect_same_image(studio, sensor, 512, 100000);
}

// The sun and an even sky, the latter seen directly too, and a point light and a spot behind the camera, since camera
// paths see no points.
TEST(LightTracer, MakesTheCamerasImageUnderTheSky) {
    const Sensor sensor{.width = 9, .height = 6, .pixel_pitch_mm = 4.0};
    SceneParts parts(kGrid);
    parts.add(Quad{3000.0, 3000.0}, {.linear = about_x(-90.0), .translation = {0.0, -400.0, 2500.0}}, 0.6);
    parts.add(Sphere{400.0}, {.linear = kIdentity3, .translation = {-200.0, 0.0, 2500.0}}, 0.8);
    parts.lights.emplace_back(ConstantLight{constant_spectrum(1.0, kGrid)});
    parts.lights.emplace_back(
        SunLight{normalized(Vec3d{1.0, 2.0, -1.0}), std::cos(0.02), constant_spectrum(3000.0, kGrid)});
    parts.lights.emplace_back(PointLight{{300.0, 300.0, -500.0}, constant_spectrum(5.0, kGrid)});
    parts.lights.emplace_back(
        SpotLight{{0.0, 900.0, -600.0}, normalized(Vec3d{0.0, -0.5, 1.0}), 0.95, 0.8, constant_spectrum(9.0, kGrid)});
    const Studio studio("muller-fisheye", 4.0, 2500.0, sensor, parts);
    expect_same_image(studio, sensor, 256, 200000);
}

// Glass before the wall: light that it gathers reaches the camera's paths by chance alone, and light paths with ease.
// Rough enough that both see all of it.
TEST(LightTracer, MakesTheCamerasImageOfRoughGlass) {
    const Sensor sensor{.width = 9, .height = 6, .pixel_pitch_mm = 4.0};
    SceneParts parts(kGrid);
    parts.add(Quad{4000.0, 4000.0}, {.linear = about_x(180.0), .translation = {0.0, 0.0, 2300.0}}, 0.7);
    parts.add(Sphere{250.0}, {.linear = kIdentity3, .translation = {0.0, 0.0, 1900.0}},
              Material{.surface = DielectricMaterial{.eta = constant_spectrum(1.5, kGrid),
                                                     .roughness = Roughness{.alpha_x = 0.4, .alpha_y = 0.4}},
                       .radiance = {}});
    const std::uint32_t lamp =
        parts.add(Quad{900.0, 900.0}, {.linear = about_x(90.0), .translation = {0.0, 900.0, 1500.0}}, 0.0);
    parts.lights.emplace_back(AreaLight{.object = lamp, .radiance = constant_spectrum(20.0, kGrid)});
    const Studio studio("double-gauss-tronnier", 2.0, 2000.0, sensor, parts);
    expect_same_image(studio, sensor, 1024, 250000);
}

}  // namespace
}  // namespace lensproof
