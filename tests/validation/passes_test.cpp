// Classes of light paths, each rendered by itself, and all of them at once by chance: one image.
#include "engine/render/integrators/passes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/validation/studio.h"

namespace lensproof::passes_test {

const spectral::SpectralGrid kGrid = spectral::spectral_grid(420.0, 680.0, 16);
const render::Sensor kSensor{.width = 9, .height = 6, .pixel_pitch_mm = 4.0};
// As bright as a bare mirror, so that ghosts stand out.
constexpr optics::StrayMirrors<double> kMirrors{.sensor = 0.9, .blades = 0.5};

SceneParts sun_from(const Vec3d& towards) {
    SceneParts parts(kGrid);
    parts.lights.emplace_back(
        scene::SunLight{normalized(towards), std::cos(0.005), spectral::constant_spectrum(1000.0, kGrid)});
    return parts;
}

// All that reaches the film of a sun beside the picture has gone astray. What guides its paths to it knows neither the
// sun's angle nor what more reflections do; chance alone knows nothing.
TEST(Passes, GhostsOfASunBesideThePictureAreAllThatChanceFinds) {
    const Studio studio({.lens = "tessar", .f_number = 4.0, .sensor = kSensor, .grid = kGrid, .mirrors = kMirrors},
                        sun_from({-0.15, 0.22, 1.0}));
    const render::Film ghosts = studio.by_pass("ghosts", 2000);
    const render::Film faint = studio.by_pass("faint-ghosts", 20000);
    expect_same_image(render::Picture({{"ghosts", &ghosts}, {"faint-ghosts", &faint}}),
                      studio.by_pass("everything", 40000), 0.05);
}

// A barrel that scatters leaves the ghosts as they are and adds its own light: of mirrors and blades too.
TEST(Passes, ASunsGhostsAndBarrelAreAllThatChanceFinds) {
    constexpr optics::WallFinish kGrey{.albedo = 0.6, .gloss = 0.5, .roughness = 0.3};
    const Studio studio({.lens = "tessar",
                         .f_number = 4.0,
                         .sensor = kSensor,
                         .grid = kGrid,
                         .mirrors = kMirrors,
                         .barrel = {.tube = kGrey, .edges = kGrey, .blades = kGrey}},
                        sun_from({-0.15, 0.22, 1.0}));
    const render::Film ghosts = studio.by_pass("ghosts", 500);
    const render::Film barrel = studio.by_pass("barrel", 2000);
    expect_same_image(render::Picture({{"ghosts", &ghosts}, {"barrel", &barrel}}), studio.by_pass("everything", 4000),
                      0.1);
}

// A wall under a lamp that is seen, before a mirror of a sensor.
TEST(Passes, AddUpToEverything) {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{4000.0, 4000.0}, {.linear = about_x(180.0), .translation = {0.0, 0.0, 2000.0}}, 0.7);
    const std::uint32_t lamp =
        parts.add(scene::Quad{300.0, 300.0}, {.linear = about_x(135.0), .translation = {0.0, 200.0, 1800.0}}, 0.0);
    parts.lights.emplace_back(scene::AreaLight{.object = lamp, .radiance = spectral::constant_spectrum(20.0, kGrid)});
    const Studio studio({.lens = "tessar", .f_number = 4.0, .sensor = kSensor, .grid = kGrid, .mirrors = kMirrors},
                        parts);
    const render::Film imaged = studio.by_pass("imaged", 512);
    const render::Film direct = studio.by_pass("direct", 512);
    const render::Film ghosts = studio.by_pass("ghosts", 2000);
    const render::Film faint = studio.by_pass("faint-ghosts", 5000);
    const render::Film everything = studio.by_pass("everything", 20000);
    expect_same_image(render::Picture({{"imaged", &imaged}, {"direct", &direct}, {"ghosts", &ghosts}}), everything,
                      0.05);
    // As films they are what the camera makes of both.
    expect_same_image(render::Picture({{"imaged", &imaged}, {"direct", &direct}}), studio.by_camera(512));
}

}  // namespace lensproof::passes_test
