// Classes of light paths, each rendered by itself, and all of them at once by chance: one image.
#include "engine/render/integrators/passes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/formats/image/image.h"
#include "tests/test_folder.h"
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

// A wide sun that the lens sees in a mirror alone: camera paths find it, to which light paths come by chance.
TEST(Passes, GhostsOfWhatAMirrorShowsAreAllThatChanceFinds) {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{150.0, 150.0}, {.linear = about_x(225.0), .translation = {0.0, 0.0, 90.0}},
              scene::Material{scene::ConductorMaterial{.n = spectral::constant_spectrum(0.1, kGrid),
                                                       .k = spectral::constant_spectrum(4.0, kGrid),
                                                       .roughness = {}}});
    parts.lights.emplace_back(
        scene::SunLight{normalized(Vec3d{0.15, 1.0, 0.1}), std::cos(0.1), spectral::constant_spectrum(10.0, kGrid)});
    const Studio studio({.lens = "tessar", .f_number = 4.0, .sensor = kSensor, .grid = kGrid, .mirrors = kMirrors},
                        parts);
    const render::Film ghosts = studio.by_pass("ghosts", 20000);
    expect_same_image(ghosts, studio.ghosts_by_light_paths(40000), 0.05);
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

// From both ends: a lit wall by camera paths, a lamp by light paths, and a point light in a mirror, which no camera
// path finds, by light paths too. A wall that the point lights through the mirror is of these.
TEST(Passes, OfWallsFromBothEndsAreWhatLightPathsBring) {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{4000.0, 4000.0}, {.linear = about_x(180.0), .translation = {0.0, 0.0, 2000.0}}, 0.7);
    parts.add(scene::Quad{2000.0, 2000.0}, {.linear = kIdentity3, .translation = {0.0, 0.0, -100.0}},
              scene::Material{scene::ConductorMaterial{.n = spectral::constant_spectrum(0.1, kGrid),
                                                       .k = spectral::constant_spectrum(4.0, kGrid),
                                                       .roughness = {}}});
    const std::uint32_t lamp =
        parts.add(scene::Quad{300.0, 300.0}, {.linear = about_x(135.0), .translation = {0.0, 200.0, 1800.0}}, 0.0);
    parts.lights.emplace_back(scene::AreaLight{.object = lamp, .radiance = spectral::constant_spectrum(2.0, kGrid)});
    parts.lights.emplace_back(
        scene::PointLight{.position = {0.0, 300.0, -50.0}, .intensity = spectral::constant_spectrum(10.0, kGrid)});
    const optics::WallFinish grey{.albedo = 0.8, .gloss = 0.2};
    const Studio studio({.lens = "tessar",
                         .f_number = 4.0,
                         .sensor = kSensor,
                         .grid = kGrid,
                         .barrel = optics::BarrelFinish{.tube = grey, .edges = grey, .blades = grey}},
                        parts);
    expect_same_image(studio.by_pass("barrel", 12000), studio.by_light_paths(render::StrayClass::walls, 24000), 0.12);
}

/// A third of the front under grains and haze.
render::DustSettings dust_in(const TestFolder& folder) {
    formats::Image picture = formats::make_image(3, 2, {"Y"});
    picture.pixels = {1.0F, 0.0F, 0.25F, 0.0F, 0.75F, 0.0F};
    formats::write_exr(picture, folder.path() / "dust.exr");
    return {.picture = folder.path() / "dust.exr", .albedo = 0.8, .through = 0.6};
}

/// A lit wall under a lamp, a sun and a sky; and, with a mirror that shows it, a point light.
SceneParts lit_from_everywhere(bool has_point) {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{4000.0, 4000.0}, {.linear = about_x(180.0), .translation = {0.0, 0.0, 2000.0}}, 0.7);
    const std::uint32_t lamp =
        parts.add(scene::Quad{300.0, 300.0}, {.linear = about_x(135.0), .translation = {0.0, 200.0, 1800.0}}, 0.0);
    parts.lights.emplace_back(scene::AreaLight{.object = lamp, .radiance = spectral::constant_spectrum(20.0, kGrid)});
    if (has_point) {
        parts.add(scene::Quad{2000.0, 2000.0}, {.linear = kIdentity3, .translation = {0.0, 0.0, -100.0}},
                  scene::Material{scene::ConductorMaterial{.n = spectral::constant_spectrum(0.1, kGrid),
                                                           .k = spectral::constant_spectrum(4.0, kGrid),
                                                           .roughness = {}}});
        parts.lights.emplace_back(
            scene::PointLight{.position = {0.0, 300.0, -50.0}, .intensity = spectral::constant_spectrum(0.1, kGrid)});
    }
    parts.lights.emplace_back(
        scene::SunLight{normalized(Vec3d{-0.9, 0.22, 0.3}), std::cos(0.005), spectral::constant_spectrum(1e4, kGrid)});
    parts.lights.emplace_back(scene::ConstantLight{spectral::constant_spectrum(0.2, kGrid)});
    return parts;
}

// Dust is lit by all lights of a scene, straight and by way of walls and mirrors.
TEST(Passes, OfDustFromBothEndsAreWhatLightPathsBring) {
    const TestFolder folder;
    const Studio studio({.lens = "tessar", .f_number = 4.0, .sensor = kSensor, .grid = kGrid, .dust = dust_in(folder)},
                        lit_from_everywhere(true));
    const render::Film barrel = studio.by_pass("barrel", 2000);
    const render::Film judge = studio.by_light_paths(render::StrayClass::walls, 40000);
    const FilmDifference found = difference(barrel, judge);
    EXPECT_NEAR(found.first, found.second, 4.0 * found.error);
    EXPECT_LT(found.error, 0.12 * found.first);
}

// It veils the picture, and dims it where it covers the front.
TEST(Passes, OfADustyLensAddUpToEverything) {
    const TestFolder folder;
    const Studio studio({.lens = "tessar", .f_number = 4.0, .sensor = kSensor, .grid = kGrid, .dust = dust_in(folder)},
                        lit_from_everywhere(false));
    const render::Film imaged = studio.by_pass("imaged", 512);
    const render::Film direct = studio.by_pass("direct", 512);
    const render::Film ghosts = studio.by_pass("ghosts", 500);
    const render::Film barrel = studio.by_pass("barrel", 1000);
    expect_same_image(
        render::Picture({{"imaged", &imaged}, {"direct", &direct}, {"ghosts", &ghosts}, {"barrel", &barrel}}),
        studio.by_pass("everything", 20000), 0.05);
}

// A sky above a wall: camera paths see it for all that it sends, an even one nearly by themselves.
TEST(Passes, OfWallsAndASkyAreWhatLightPathsBring) {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{4000.0, 4000.0}, {.linear = about_x(180.0), .translation = {0.0, -2200.0, 2000.0}}, 0.7);
    parts.lights.emplace_back(scene::ConstantLight{spectral::constant_spectrum(1.0, kGrid)});
    const optics::WallFinish grey{.albedo = 0.8, .gloss = 0.2};
    const Studio studio({.lens = "tessar",
                         .f_number = 4.0,
                         .sensor = kSensor,
                         .grid = kGrid,
                         .barrel = optics::BarrelFinish{.tube = grey, .edges = grey, .blades = grey}},
                        parts);
    const render::Film film = studio.by_pass("barrel", 1000);
    const render::Film judge = studio.by_light_paths(render::StrayClass::walls, 16000);
    // Of the totals alone: few light paths land, each as bright as many, so that the variance of a pixel is not known.
    const FilmDifference found = difference(film, judge);
    EXPECT_NEAR(found.first, found.second, 4.0 * found.error);
    EXPECT_LT(found.error, 0.15 * found.first);
    EXPECT_LT(difference(film, film).error, 0.5 * difference(judge, judge).error) << "with a sixteenth of its paths";
}

/// What films gather together, as the audit counts light, over a pixel's area; and the variance of that.
struct Gathered {
    double light = 0.0;
    double variance = 0.0;
};

Gathered gathered(const render::Picture& picture) {
    Gathered sum;
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) {
            const render::PixelEstimate pixel = picture.estimate(x, y);
            sum = {sum.light + pixel.rgb.x, sum.variance + pixel.variance.x};
        }
    }
    return sum;
}

// All light that comes in goes somewhere, and where it goes to the film each pass gathers what the audit has there.
// Surfaces of 4 to 7 % send back more than one of them by the front.
TEST(Passes, GatherWhatTheAuditSays) {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{4000.0, 4000.0}, {.linear = about_x(180.0), .translation = {0.0, 0.0, 2000.0}}, 0.7);
    const std::uint32_t lamp =
        parts.add(scene::Quad{300.0, 300.0}, {.linear = about_x(135.0), .translation = {0.0, 200.0, 1800.0}}, 0.0);
    parts.lights.emplace_back(scene::AreaLight{.object = lamp, .radiance = spectral::constant_spectrum(20.0, kGrid)});
    const optics::WallFinish grey{.albedo = 0.8, .gloss = 0.2};
    const Studio studio({.lens = "tessar",
                         .f_number = 4.0,
                         .sensor = kSensor,
                         .grid = kGrid,
                         .barrel = optics::BarrelFinish{.tube = grey, .edges = grey, .blades = grey}},
                        parts);
    const render::EnergyAudit audit = studio.audit(200'000);
    double sum = 0.0;
    for (const render::EnergyFraction& fraction : audit.fractions) {
        sum += fraction.fraction;
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
    EXPECT_LT(audit[render::Fate::absorbed].fraction, 0.01) << "its glasses pass 99 % and more";
    EXPECT_LT(audit[render::Fate::lost].fraction, 1e-6);
    EXPECT_GT(audit[render::Fate::front].fraction, 0.05);

    const double pitch_m = 1e-3 * kSensor.pixel_pitch_mm;
    const double light_in = audit.light_in / (pitch_m * pitch_m);
    const auto expect_gathered = [&](render::Fate fate, const render::Picture& films, double most_error) {
        const auto& [fraction, error] = audit[fate];
        const auto [light, variance] = gathered(films);
        const double both = std::hypot(light_in * error, std::sqrt(variance));
        fmt::print("{:.5g} of {:.5g} ± {:.2g}\n", light, light_in * fraction, both);
        EXPECT_NEAR(light, light_in * fraction, 4.0 * both);
        EXPECT_LT(both, most_error * light);
    };
    const render::Film imaged = studio.by_pass("imaged", 128);
    const render::Film direct = studio.by_pass("direct", 128);
    const render::Film ghosts = studio.by_pass("ghosts", 500);
    const render::Film faint = studio.by_pass("faint-ghosts", 2000);
    expect_gathered(render::Fate::imaged, render::Picture({{"imaged", &imaged}, {"direct", &direct}}), 0.02);
    expect_gathered(render::Fate::ghosts, render::Picture({{"ghosts", &ghosts}, {"faint-ghosts", &faint}}), 0.1);
    expect_gathered(render::Fate::barrel, studio.by_pass("barrel", 4000), 0.15);
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
