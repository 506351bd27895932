// Films of light that the barrel scatters, against paths that run the other way.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/base/angle.h"
#include "engine/optics/stray_walk.h"
#include "engine/pupil/rear_disc.h"
#include "engine/render/integrators/passes.h"
#include "tests/validation/rendered_scene.h"
#include "tests/validation/small_scene.h"

namespace lensproof::barrel_light_test {

const spectral::SpectralGrid kGrid = spectral::spectral_grid(500.0, 600.0, 4);
constexpr double kSunRadius = 50.0 * kDegree;
constexpr int kPixels = 8;

render::CameraSettings grey_tessar(const optics::WallFinish& walls) {
    return {.lens = "tessar",
            .barrel = optics::BarrelFinish{.tube = walls, .edges = walls, .blades = walls},
            .f_number = 4.0,
            .focus_distance_mm = kInfinity,
            .sensor = {.width = kPixels, .height = kPixels, .pixel_pitch_mm = 8.0},
            .response = "luminance"};
}

/// Mean irradiance of the film, and its standard error.
struct Irradiance {
    double mean = 0.0;
    double error = 0.0;
};

/// By light paths from a sun that fills half of the view and more, of radiance 1.
Irradiance by_light(const render::Camera& camera, const render::World& world, std::uint32_t samples) {
    const render::View view{.world = &world, .camera = &camera, .seed = 1, .paths = {.max_bounces = 1}};
    render::Render render = render::pass_named("barrel").render(view, render::integrator_named("camera"));
    const double per_nm = 1.0 / render.film.band_nm;
    render.film.rgb_weights.assign(render.film.rgb_weights.size(), {per_nm, per_nm, per_nm});
    const render::PixelRect all{.width = kPixels, .height = kPixels};
    const render::Film film = rendered(render, {&all, 1}, samples);
    Irradiance found;
    for (int y = 0; y < kPixels; ++y) {
        for (int x = 0; x < kPixels; ++x) {
            found.mean += film.estimate(x, y).rgb.x / (kPixels * kPixels);
            found.error += film.estimate(x, y).variance.x / std::pow(kPixels, 4);
        }
    }
    found.error = std::sqrt(found.error);
    return found;
}

/// The same from the film outwards, evenly over it and over all wavelengths, to an even disc that holds the lens's
/// rear.
Irradiance from_film(const render::Camera& camera, int paths) {
    const optics::Barrel barrel(*camera.lens());
    const optics::StrayMirrors<double> mirrors;
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const auto numbers = [&] { return uniform(random); };
    const double half = 0.5 * kPixels * camera.sensor().pixel_pitch_mm;
    const pupil::RearDisc disc = pupil::rear_disc(camera.exact().lens().at(0), camera.sensor().half_diagonal_mm());
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < paths; ++i) {
        const optics::TraceLens<double>& lens = camera.exact().lens().at(i % kGrid.size());
        const double x = half * (2.0 * numbers() - 1.0);
        const double y = half * (2.0 * numbers() - 1.0);
        const double u = numbers();
        const Vec2d place = disc.warped(u, numbers());
        const Vec3d towards{place.x - x, place.y - y, disc.plane_z - lens.image_z};
        optics::StrayLight light{.ray = {{x, y, lens.image_z}, normalized(towards)}};
        const double projected = disc.area() * std::pow(towards.z, 2) / std::pow(dot(towards, towards), 2);
        optics::StrayWalk walk(lens, barrel, mirrors, numbers);
        const bool leaves = walk.follow(light, false, [](const optics::StrayLight&) {}) == optics::StrayEnd::front;
        if (leaves && light.walls > 0 && -light.ray.direction.z > std::cos(kSunRadius)) {
            const double seen = projected * light.weight;
            sum += seen;
            squares += seen * seen;
        }
    }
    const double mean = sum / paths;
    return {mean, std::sqrt((squares / paths - mean * mean) / paths)};
}

// What the barrel scatters onto a film, from a sun of known radiance, is what leaves the film towards it by way of the
// barrel's walls: each wavelength's path, its weight and its place. Four standard errors.
TEST(BarrelLight, IsWhatLeavesTheFilmByWayOfTheWalls) {
    const render::Camera camera(grey_tessar({.albedo = 0.8, .gloss = 0.5, .roughness = 0.3}), {500.0, 600.0, 4, 1}, {},
                                {});
    SceneParts parts(kGrid);
    parts.add(scene::Sphere{1.0}, {.linear = kIdentity3, .translation = {0.0, 0.0, -1e4}}, 0.0);
    parts.lights.emplace_back(
        scene::SunLight{{0.0, 0.0, 1.0}, std::cos(kSunRadius), spectral::constant_spectrum(1.0, kGrid)});
    const render::World world = parts.scene();
    const Irradiance there = by_light(camera, world, 1000);
    const Irradiance back = from_film(camera, 100'000);
    EXPECT_NEAR(there.mean, back.mean, 4.0 * std::hypot(there.error, back.error));
    EXPECT_LT(there.error, 0.05 * there.mean);
    EXPECT_LT(back.error, 0.03 * back.mean);
}

// Black walls scatter nothing.
TEST(BarrelLight, IsNoneWhereWallsAreBlack) {
    const render::Camera camera(grey_tessar({}), {500.0, 600.0, 4, 1}, {}, {});
    SceneParts parts(kGrid);
    parts.lights.emplace_back(
        scene::SunLight{{0.0, 0.0, 1.0}, std::cos(kSunRadius), spectral::constant_spectrum(1.0, kGrid)});
    parts.add(scene::Sphere{1.0}, {.linear = kIdentity3, .translation = {0.0, 0.0, -1e4}}, 0.0);
    const render::World world = parts.scene();
    EXPECT_EQ(by_light(camera, world, 4).mean, 0.0);
}

}  // namespace lensproof::barrel_light_test
