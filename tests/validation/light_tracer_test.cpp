// Light traced to the film from the lights, and radiance fetched from the scene by the camera: one image.
#include "engine/render/integrators/light_tracer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/validation/studio.h"

namespace lensproof::light_tracer_test {

const spectral::SpectralGrid kGrid = spectral::spectral_grid(420.0, 680.0, 16);
const render::Sensor kSensor{.width = 9, .height = 6, .pixel_pitch_mm = 4.0};

TEST(LightTracer, MakesTheCamerasImageOfALitWall) {
    SceneParts parts(kGrid);
    AffineMap towards_camera{.linear = about_x(180.0), .translation = {0.0, 0.0, 2000.0}};
    parts.add(scene::Quad{4000.0, 4000.0}, towards_camera, 0.7);
    parts.add(scene::Sphere{200.0}, {.linear = kIdentity3, .translation = {150.0, 0.0, 1700.0}}, 0.5);
    const std::uint32_t lamp =
        parts.add(scene::Quad{500.0, 500.0}, {.linear = about_x(90.0), .translation = {0.0, 800.0, 1500.0}}, 0.0);
    parts.lights.emplace_back(scene::AreaLight{.object = lamp, .radiance = spectral::constant_spectrum(20.0, kGrid)});
    const Studio studio({.lens = "double-gauss-tronnier", .sensor = kSensor, .grid = kGrid}, parts);
    expect_same_image(studio.by_camera(512), studio.by_lights(1852));
}

// The sun and an even sky, the latter seen directly too, and a point light and a spot, of which the point is in view:
// neither kind of path shows it.
TEST(LightTracer, MakesTheCamerasImageUnderTheSky) {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{3000.0, 3000.0}, {.linear = about_x(-90.0), .translation = {0.0, -400.0, 2500.0}}, 0.6);
    parts.add(scene::Sphere{400.0}, {.linear = kIdentity3, .translation = {-200.0, 0.0, 2500.0}}, 0.8);
    parts.lights.emplace_back(scene::ConstantLight{spectral::constant_spectrum(1.0, kGrid)});
    parts.lights.emplace_back(
        scene::SunLight{normalized(Vec3d{1.0, 2.0, -1.0}), std::cos(0.02), spectral::constant_spectrum(3000.0, kGrid)});
    parts.lights.emplace_back(scene::PointLight{{300.0, 300.0, 1500.0}, spectral::constant_spectrum(5.0, kGrid)});
    parts.lights.emplace_back(scene::SpotLight{
        {0.0, 900.0, -600.0}, normalized(Vec3d{0.0, -0.5, 1.0}), 0.95, 0.8, spectral::constant_spectrum(9.0, kGrid)});
    const Studio studio(
        {.lens = "muller-fisheye", .f_number = 4.0, .focus_mm = 2500.0, .sensor = kSensor, .grid = kGrid}, parts);
    expect_same_image(studio.by_camera(256), studio.by_lights(3704));
}

// Glass before the wall: light that it gathers reaches the camera's paths by chance alone, and light paths with ease.
// Rough enough that both see all of it.
TEST(LightTracer, MakesTheCamerasImageOfRoughGlass) {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{4000.0, 4000.0}, {.linear = about_x(180.0), .translation = {0.0, 0.0, 2300.0}}, 0.7);
    parts.add(
        scene::Sphere{250.0}, {.linear = kIdentity3, .translation = {0.0, 0.0, 1900.0}},
        scene::Material{scene::DielectricMaterial{.eta = spectral::constant_spectrum(1.5, kGrid),
                                                  .roughness = scene::Roughness{.alpha_x = 0.4, .alpha_y = 0.4}}});
    const std::uint32_t lamp =
        parts.add(scene::Quad{900.0, 900.0}, {.linear = about_x(90.0), .translation = {0.0, 900.0, 1500.0}}, 0.0);
    parts.lights.emplace_back(scene::AreaLight{.object = lamp, .radiance = spectral::constant_spectrum(20.0, kGrid)});
    const Studio studio({.lens = "double-gauss-tronnier", .sensor = kSensor, .grid = kGrid}, parts);
    expect_same_image(studio.by_camera(1024), studio.by_lights(4630));
}

/// A wall with a sphere before it, under a lamp that is seen.
SceneParts lit_wall() {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{4000.0, 4000.0}, {.linear = about_x(180.0), .translation = {0.0, 0.0, 2000.0}}, 0.7);
    parts.add(scene::Sphere{200.0}, {.linear = kIdentity3, .translation = {150.0, 0.0, 1700.0}}, 0.5);
    const std::uint32_t lamp =
        parts.add(scene::Quad{300.0, 300.0}, {.linear = about_x(135.0), .translation = {0.0, 300.0, 1800.0}}, 0.0);
    parts.lights.emplace_back(scene::AreaLight{.object = lamp, .radiance = spectral::constant_spectrum(20.0, kGrid)});
    parts.lights.emplace_back(scene::ConstantLight{spectral::constant_spectrum(0.5, kGrid)});
    return parts;
}

// Into ideal cameras light paths go through their pupils, whose importance is a closed form: the pinhole's, that of the
// thin lens, and the paraxial lens's at each wavelength; with a lens's profile, its etendue and the inverse of its
// curves.
TEST(LightTracer, MakesTheImageOfIdealCameras) {
    for (const render::LensModel model :
         {render::LensModel::pinhole, render::LensModel::thin_lens, render::LensModel::paraxial,
          render::LensModel::pinhole_profile, render::LensModel::thin_lens_profile}) {
        SceneParts parts = lit_wall();
        const Studio studio({.lens = "double-gauss-tronnier", .model = model, .sensor = kSensor, .grid = kGrid}, parts);
        expect_same_image(studio.by_camera(512), studio.by_lights(4000));
    }
}

// Into polynomials light goes by their inverse, weighed with its own etendue, over which errors of the polynomials
// cancel: these pictures agree however wrong both may be.
TEST(LightTracer, MakesTheImageOfPolynomials) {
    SceneParts parts = lit_wall();
    const Studio studio(
        {.lens = "double-gauss-tronnier", .model = render::LensModel::polynomial, .sensor = kSensor, .grid = kGrid},
        parts);
    expect_same_image(studio.by_camera(6000), studio.by_lights(5000));
}

}  // namespace lensproof::light_tracer_test
