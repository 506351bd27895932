#include "engine/render/camera/polynomial_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "engine/base/input_error.h"
#include "engine/render/camera/camera.h"

namespace lensproof::render::polynomial_camera_test {
namespace {

CameraSettings settings_of(const std::string& lens, double f_number, double pitch_mm, LensModel model) {
    CameraSettings settings;
    settings.lens = lens;
    settings.f_number = f_number;
    settings.focus_distance_mm = 5000.0;
    settings.sensor = {.width = 48, .height = 4, .pixel_pitch_mm = pitch_mm};
    settings.exposure = {.time_s = 0.01, .iso = 100.0};
    settings.response = "luminance";
    settings.model = model;
    return settings;
}

constexpr SpectralSampling kWavelengths{.layers = 8, .strata_per_layer = 1};
constexpr std::uint32_t kSamples = 256;

Camera camera_of(const std::string& lens, double f_number, double pitch_mm, LensModel model) {
    return Camera(settings_of(lens, f_number, pitch_mm, model), kWavelengths, PixelFilter{}, Cache());
}

struct PathEnd {
    Ray<double> ray;
    double weight;
};
using Ends = std::map<std::pair<std::uint32_t, std::uint32_t>, PathEnd>;  // by pixel and sample

Ends ends_of(const Camera& camera) {
    Ends ends;
    CameraPaths paths = camera.paths(1, PathCarry::hero);
    paths.start({.pixels = 48 * 4, .samples = kSamples});
    CameraPathBuffer buffer;
    while (paths.fill(buffer)) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(buffer.size); ++i) {
            ends[{buffer.pixel[i], buffer.sample[i]}] = {buffer.ray(i), buffer.weight[i]};
        }
    }
    return ends;
}

// Sample for sample the exact camera's paths: the same points of film and pupil, so the same rays but for the
// polynomials' error, some µm on the film, and the same weights but for the transmittance's. Of the paths that one has
// and not the other, which lie at a rim, there are few; the light of an even sky, the sum of weights, is the same to
// 0.3 % (0.004 EV) in all of the field.
TEST(PolynomialCamera, HasTheExactCamerasPaths) {
    for (const auto& [lens, f_number, pitch_mm] :
         {std::tuple{"double-gauss-tronnier", 2.0, 0.85}, std::tuple{"muller-fisheye", 4.0, 0.45}}) {
        const Camera exact_camera = camera_of(lens, f_number, pitch_mm, LensModel::exact);
        const Camera polynomial_camera = camera_of(lens, f_number, pitch_mm, LensModel::polynomial);
        const Ends exact = ends_of(exact_camera);
        const Ends found = ends_of(polynomial_camera);
        std::array<double, 6> exact_light{};
        std::array<double, 6> found_light{};
        for (const auto& [at, end] : exact) {
            exact_light[at.first % 48 / 8] += end.weight;
        }
        int common = 0;
        for (const auto& [at, end] : found) {
            found_light[at.first % 48 / 8] += end.weight;
            if (const auto same = exact.find(at); same != exact.end()) {
                ++common;
                EXPECT_NEAR(length(end.ray.direction - same->second.ray.direction), 0.0, 2e-3);
                EXPECT_NEAR(length(end.ray.origin - same->second.ray.origin), 0.0, 0.2);
                EXPECT_NEAR(end.weight, same->second.weight, 0.01 * same->second.weight);
            }
        }
        ASSERT_GT(common, 30000);
        EXPECT_GT(common, 0.99 * static_cast<double>(exact.size()));
        EXPECT_GT(common, 0.99 * static_cast<double>(found.size()));
        for (std::size_t i = 0; i < exact_light.size(); ++i) {
            EXPECT_NEAR(found_light[i], exact_light[i], 0.003 * exact_light[i]) << lens << " " << i;
        }
    }
}

// A path's weight is τ times the etendue that its pixel's area has of it over its pdf; so times the pdf of `importance`
// it is that function's transmittance, both of which come by the inverse, with its own etendue.
TEST(PolynomialCamera, ImportanceIsThatOfItsPaths) {
    const Camera camera = camera_of("double-gauss-tronnier", 2.0, 0.85, LensModel::polynomial);
    CameraPaths paths = camera.paths(3, PathCarry::wavelengths_and_pdfs);
    paths.start({.pixels = 48 * 4, .samples = 8});
    CameraPathBuffer buffer;
    int seen = 0;
    while (paths.fill(buffer)) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(buffer.size); ++i) {
            const std::uint16_t hero = buffer.wavelength[i];
            const Ray<double> out = buffer.ray(i);
            const FilmImportance back =
                camera.importance({out.origin, -1.0 * out.direction}, {{hero, hero, hero, hero}});
            ASSERT_GT(back.pdf[0], 0.0);
            EXPECT_NEAR(buffer.weight[i] * back.pdf[0] / back.transmittance[0], 1.0, 1e-9);
            EXPECT_NEAR(back.at_px[0].x, camera.sensor().pixel({buffer.film_x[i], buffer.film_y[i]}).x, 1e-8);
            EXPECT_NEAR(buffer.pdf[i].hero, back.pdf[0], 1e-9 * back.pdf[0]);
            EXPECT_GT(buffer.pdf[i].shared, 0.24 * buffer.pdf[i].hero);
            EXPECT_EQ(buffer.weights[i][0], buffer.hero_weight(i));
            ++seen;
        }
    }
    EXPECT_GT(seen, 1000);
}

TEST(PolynomialCamera, RefusesBladesInTheLensAndSaysWhy) {
    const CameraSettings settings = settings_of("double-gauss-tronnier", 4.0, 0.85, LensModel::polynomial);
    optics::Lens lens = camera_lens(settings);
    lens.stop_mask = optics::StopMask(optics::PolygonStop{.blades = 6});
    EXPECT_THROW(Camera(settings, lens, kWavelengths, PixelFilter{}, Cache()), InputError);
}

TEST(PolynomialCamera, HashIsItsOwn) {
    const auto hash = [](LensModel model) { return camera_of("double-gauss-tronnier", 2.0, 0.85, model).hash(); };
    EXPECT_NE(hash(LensModel::polynomial), hash(LensModel::exact));
    EXPECT_EQ(hash(LensModel::polynomial), hash(LensModel::polynomial));
}

}  // namespace
}  // namespace lensproof::render::polynomial_camera_test
