// Camera paths and light paths together: each path once, and no noisier than by the better of the two.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/validation/studio.h"

namespace lensproof::both_paths_test {

const spectral::SpectralGrid kGrid = spectral::spectral_grid(420.0, 680.0, 16);
const render::Sensor kSensor{.width = 9, .height = 6, .pixel_pitch_mm = 4.0};

/// Matt surfaces and a lamp in view, a spherical one beside it, and a sky.
SceneParts matt_scene() {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{4000.0, 4000.0}, {.linear = about_x(180.0), .translation = {0.0, 0.0, 2000.0}}, 0.7);
    parts.add(scene::Sphere{200.0}, {.linear = kIdentity3, .translation = {150.0, 0.0, 1700.0}}, 0.5);
    const std::uint32_t lamp =
        parts.add(scene::Quad{300.0, 300.0}, {.linear = about_x(135.0), .translation = {0.0, 300.0, 1800.0}}, 0.0);
    const std::uint32_t ball =
        parts.add(scene::Sphere{60.0}, {.linear = kIdentity3, .translation = {-300.0, -150.0, 1800.0}}, 0.0);
    parts.lights.emplace_back(scene::AreaLight{.object = lamp, .radiance = spectral::constant_spectrum(20.0, kGrid)});
    parts.lights.emplace_back(scene::AreaLight{.object = ball, .radiance = spectral::constant_spectrum(30.0, kGrid)});
    parts.lights.emplace_back(scene::ConstantLight{spectral::constant_spectrum(0.5, kGrid)});
    parts.lights.emplace_back(scene::PointLight{{300.0, 300.0, 1500.0}, spectral::constant_spectrum(0.5, kGrid)});
    return parts;
}

scene::Material glass() {
    // Cauchy's formula with numbers like those of a dense flint: the wavelengths part.
    return {scene::dielectric_material(spectral::tabulated(kGrid, [](double nm) { return 1.70 + 13000.0 / (nm * nm); }),
                                       {})};
}

/// A glass ball throws a caustic on a matt wall, and a mirror shows both: camera paths find what glass gathers by
/// chance alone, light paths cannot see mirrors.
SceneParts caustic_scene() {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{4000.0, 4000.0}, {.linear = about_x(180.0), .translation = {0.0, 0.0, 2250.0}}, 0.7);
    parts.add(scene::Sphere{150.0}, {.linear = kIdentity3, .translation = {-150.0, 420.0, 2000.0}}, glass());
    parts.add(scene::Quad{900.0, 900.0},
              {.linear = product(about_y(70.0), about_x(180.0)), .translation = {450.0, 0.0, 2000.0}},
              scene::Material{scene::ConductorMaterial{.n = spectral::constant_spectrum(0.1, kGrid),
                                                       .k = spectral::constant_spectrum(4.0, kGrid),
                                                       .roughness = {}}});
    const std::uint32_t lamp =
        parts.add(scene::Sphere{60.0}, {.linear = kIdentity3, .translation = {-150.0, 1000.0, 1500.0}}, 0.0);
    parts.lights.emplace_back(scene::AreaLight{.object = lamp, .radiance = spectral::constant_spectrum(200.0, kGrid)});
    return parts;
}

Studio::Setup double_gauss(int max_bounces = 3) {
    return {.lens = "double-gauss-tronnier", .sensor = kSensor, .grid = kGrid, .max_bounces = max_bounces};
}

TEST(BothPaths, MakeTheImageOfEitherWhereAllIsMatt) {
    SceneParts parts = matt_scene();
    const Studio studio(double_gauss(), parts);
    const render::Film both = studio.by_both(256);
    expect_same_image(both, studio.by_camera(512));
    expect_same_image(both, studio.by_lights(3072));
}

// The colours of the fisheye part by more than its pixels here; wide filters send the hero alone.
TEST(BothPaths, MakeTheImageWhereWavelengthsPart) {
    const render::Sensor fine{.width = 9, .height = 6, .pixel_pitch_mm = 0.02};
    for (const char* filter : {"box", "gaussian"}) {
        SceneParts parts = matt_scene();
        const Studio studio({.lens = "muller-fisheye",
                             .f_number = 4.0,
                             .sensor = fine,
                             .grid = kGrid,
                             .filter = render::PixelFilter::named(filter)},
                            parts);
        const FilmDifference found = difference(studio.by_both(256), studio.by_camera(1024));
        EXPECT_NEAR(found.first, found.second, 4.0 * found.error);
        EXPECT_LT(found.error, 0.02 * found.first);
    }
}

TEST(BothPaths, MakeTheImageOfIdealCameras) {
    for (const render::LensModel model :
         {render::LensModel::pinhole, render::LensModel::thin_lens, render::LensModel::paraxial,
          render::LensModel::pinhole_profile, render::LensModel::thin_lens_profile}) {
        SceneParts parts = matt_scene();
        Studio::Setup setup = double_gauss();
        setup.model = model;
        const Studio studio(setup, parts);
        expect_same_image(studio.by_both(256), studio.by_camera(512));
    }
}

TEST(BothPaths, MakeTheImageOfPolynomials) {
    SceneParts parts = matt_scene();
    Studio::Setup setup = double_gauss();
    setup.model = render::LensModel::polynomial;
    const Studio studio(setup, parts);
    expect_same_image(studio.by_both(2048), studio.by_camera(4096));
}

/// Sums over columns of the film.
render::PixelEstimate sum_of(const render::Film& film, int first, int end) {
    render::PixelEstimate sum;
    for (int y = 0; y < film.height(); ++y) {
        for (int x = first; x < end; ++x) {
            const auto [rgb, variance] = film.estimate(x, y);
            sum = {.rgb = sum.rgb + rgb, .variance = sum.variance + variance};
        }
    }
    return sum;
}

// Together they are complete: light paths alone lack the mirror's picture, at the left, and camera paths, which have
// everything by chance, are the judge. And together they are the better by far where the caustic is, at the right:
// nobody finds it by chance any more.
TEST(BothPaths, BringCausticsAndMirrorsTogether) {
    SceneParts parts = caustic_scene();
    const Studio studio(double_gauss(6), parts);
    const render::Film both = studio.by_both(512);
    const render::Film camera = studio.by_camera(4096);
    const render::Film light = studio.by_lights(512);
    expect_same_image(both, camera, 0.08);
    const double with_mirror = sum_of(both, 0, 2).rgb.x;
    const double without = sum_of(light, 0, 2).rgb.x;
    const double variance = sum_of(both, 5, 9).variance.x;
    const double by_chance = 8.0 * sum_of(camera, 5, 9).variance.x;
    fmt::print("mirror {:.3g} for {:.3g}, variance {:.3g} for {:.3g}\n", without, with_mirror, variance, by_chance);
    EXPECT_LT(without, 0.5 * with_mirror);
    EXPECT_LT(variance, 0.1 * by_chance) << "at equal numbers of camera paths";
}

// With q_i = n_i p_i, a combination's second moment is Σ ∫ w_i² f² / q_i, at least ∫ f² / Σ q, which any combination's
// variance V falls short of by Σ μ_i² / n_i ≤ μ² / min n_i. With the power heuristic the integrand is Σ q³ / (Σ q²)²
// f², of three techniques at most 1.23 times f² / Σ q (largest at q = (1, ¼, ¼)). So its variance is at most 1.23 (V +
// μ² / n) for every V, each kind of path alone among them, of n camera paths and more light paths a pixel. Stated
// variances of 512 samples are those of 32 blocks, and scatter by √(2/31) = 25 % a pixel, over 54 pixels by 3.5 %; four
// of these come on top.
TEST(BothPaths, AreNoNoisierThanTheBetter) {
    SceneParts parts = matt_scene();
    const Studio studio(double_gauss(), parts);
    constexpr std::uint32_t kSamples = 512;
    const auto variance_of = [](const render::Film& film) { return sum_of(film, 0, kSensor.width).variance.x; };
    const render::Film both = studio.by_both(kSamples);
    const double camera = variance_of(studio.by_camera(kSamples));
    const double light = variance_of(studio.by_lights(kSamples));
    double slack = 0.0;
    for (int i = 0; i < kSensor.width * kSensor.height; ++i) {
        const double mean = both.estimate(i % kSensor.width, i / kSensor.width).rgb.x;
        slack += mean * mean / kSamples;
    }
    fmt::print("variance {:.3g}; of camera paths {:.3g}, of light paths {:.3g}; slack {:.3g}\n", variance_of(both),
               camera, light, slack);
    EXPECT_LT(variance_of(both), 1.14 * 1.23 * (std::min(camera, light) + slack));
}

}  // namespace lensproof::both_paths_test
