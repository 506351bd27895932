// Renders against quadrature and against the slow way of making them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/base/file.h"
#include "engine/base/write_file.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/optics/illumination.h"
#include "engine/render/camera/lens_paths.h"
#include "engine/render/film/film_image.h"
#include "engine/spectral/illuminant.h"
#include "tests/test_folder.h"
#include "tests/validation/rendered_scene.h"

namespace lensproof::render_test {

render::CameraSettings small_camera(const std::string& lens, double f_number, double width_mm, int pixels) {
    return {.lens = lens,
            .f_number = f_number,
            .focus_distance_mm = 10000.0,
            .sensor = {.width = pixels, .height = pixels * 3 / 4, .pixel_pitch_mm = width_mm / pixels},
            .exposure = {.time_s = 0.05, .iso = 100.0},
            .response = "camera"};
}

constexpr render::SpectralSampling kSampling{.min_nm = 400.0, .max_nm = 700.0, .layers = 4, .strata_per_layer = 4};

/// Mean of a channel over the whole picture, with its standard error from the pixels' own (independent of each other).
struct Mean {
    double value = 0.0;
    double sigma = 0.0;
};

Mean ring_mean(const formats::Image& image, const render::Sensor& sensor, double from_mm, double to_mm) {
    double sum = 0.0;
    double variance = 0.0;
    int count = 0;
    for (int v = 0; v < image.height; ++v) {
        for (int u = 0; u < image.width; ++u) {
            const Vec2d at = sensor.position(u, v);
            const double r = std::hypot(at.x, at.y);
            if (r >= from_mm && r < to_mm) {
                sum += image.at(u, v, 1);
                variance += std::pow(image.at(u, v, 4), 2);
                ++count;
            }
        }
    }
    return {sum / count, std::sqrt(variance) / count};
}

/// A world of radiance 1 at every wavelength of the lens, by pupil points as `map` draws them.
formats::Image even_world(const optics::SpectralLens<double>& lens, const pupil::PupilMap& map,
                          const render::Sensor& sensor, std::uint32_t samples, std::uint64_t seed) {
    const pupil::PupilSlices slices(map, lens.wavelengths());
    render::LensPaths paths({.sensor = sensor, .seed = seed}, lens, slices);
    const auto rgb_weights = std::vector<Vec3d>(static_cast<std::size_t>(lens.wavelengths()), {1.0, 1.0, 1.0});
    render::Film film({.width = sensor.width,
                       .height = sensor.height,
                       .layer_nm = {550.0},
                       .rgb_weights = rgb_weights,
                       .band_nm = 1.0});
    render::FilmTile tile(film.layout());
    film.load({.rect = {0, 0, sensor.width, sensor.height}, .first = 0, .end = samples}, tile);
    paths.start({.pixels = static_cast<std::uint32_t>(sensor.width * sensor.height), .samples = samples});
    render::CameraPathBuffer buffer;
    while (paths.fill(buffer)) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(buffer.size); ++i) {
            tile.add(buffer.pixel[i], buffer.sample[i], buffer.wavelength[i], buffer.weight[i]);
        }
    }
    tile.finish();
    film.store(tile);
    return render::film_image(film);
}

formats::Image picture(const SeenChart& seen, std::uint32_t samples, std::uint64_t seed = 0, int threads = 0) {
    return render::film_image(rendered(seen, {.first = 0, .end = samples}, seed, threads));
}

// Sampling the pupil by its map and sampling the whole rear element estimate the same irradiance: rings of the picture
// agree within four standard errors of their difference (stratification makes the stated errors upper bounds), out to
// where the fisheye's pupil is a sliver.
TEST(ChartRender, PupilMapsMissNoLight) {
    for (const auto& [lens, f_number, width] :
         {std::tuple{"tessar", 2.8, 72.0}, std::tuple{"tessar", 8.0, 72.0}, std::tuple{"muller-fisheye", 4.0, 21.6}}) {
        const render::CameraSettings camera = small_camera(lens, f_number, width, 64);
        const auto lenses = optics::at_wavelengths<double>(render::camera_lens(camera), {450.0, 550.0, 650.0});
        const double edge = camera.sensor.half_diagonal_mm();
        const formats::Image fast = even_world(lenses, pupil::PupilMap(lenses.at(), true, edge), camera.sensor, 96, 1);
        const formats::Image slow =
            even_world(lenses, pupil::PupilMap::whole_element(lenses.at(0), edge), camera.sensor, 768, 2);
        for (int ring = 0; ring < 8; ++ring) {
            const Mean a = ring_mean(fast, camera.sensor, edge * ring / 8, edge * (ring + 1) / 8);
            const Mean b = ring_mean(slow, camera.sensor, edge * ring / 8, edge * (ring + 1) / 8);
            EXPECT_NEAR(a.value, b.value, 4.0 * std::hypot(a.sigma, b.sigma))
                << lens << " f/" << f_number << " ring " << ring;
            EXPECT_GT(b.value, 0.0);
            EXPECT_LT(b.sigma, 0.02 * slow.at(32, 24, 1)) << "the baseline is sharp enough to show a loss";
        }
    }
}

// Radiometry: a white Lambertian world of radiance L yields the film irradiance L ∫ τ dΩ_projected, by quadrature of
// the bundle. The spectral layer's mean over the central pixels has a standard error of about 0.1 %; 0.5 % is five of
// them.
TEST(ChartRender, FilmIrradianceIsRadianceTimesTheBundle) {
    const render::Camera camera(small_camera("tessar", 4.0, 4.0, 16), kSampling, {}, {});
    const scene::Chart white{.pattern = scene::FlatField{}, .white_reflectance = 0.9};
    const formats::Image image = picture({camera, white, {.distance_mm = 1000.0}}, 256);
    const spectral::Spectrum radiance = spectral::radiance_of(spectral::illuminant("D65"), 1000.0);
    for (std::size_t layer = 0; layer < camera.film().layer_nm.size(); ++layer) {
        double expected = 0.0;
        for (int k = 0; k < 4; ++k) {
            const int stratum = 4 * static_cast<int>(layer) + k;
            expected += 0.9 * radiance(camera.grid().strata.midpoint(stratum)) *
                        optics::image_bundle(camera.exact().lens().at(stratum), 0.5).transmitted / 4.0;
        }
        double mean = 0.0;
        for (int v = 0; v < image.height; ++v) {
            for (int u = 0; u < image.width; ++u) {
                mean += image.at(u, v, 6 + static_cast<int>(layer)) / (image.width * image.height);
            }
        }
        EXPECT_NEAR(mean / expected, 1.0, 0.005) << "layer " << layer;
    }
}

/// Green of a flat field, the mean over the picture, through the Tessar at f/8 with `more` added to its file.
double green_through_tessar_with(const std::string& more) {
    const TestFolder folder;
    const std::filesystem::path file = folder.path() / "tessar_with.toml";
    write_file(file, read_file(formats::find_lens_file("tessar")) + more);
    const render::Camera camera(small_camera(file.string(), 8.0, 4.0, 8), kSampling, {}, {});
    const scene::Chart white{.pattern = scene::FlatField{}, .white_reflectance = 1.0};
    const formats::Image image = picture({camera, white, {.distance_mm = 1000.0}}, 1024);
    double sum = 0.0;
    for (int v = 0; v < image.height; ++v) {
        for (int u = 0; u < image.width; ++u) {
            sum += image.at(u, v, 1);
        }
    }
    return sum / (image.width * image.height);
}

// Five straight blades leave 5 sin(72°) / 2π of their circle; at f/8 the projected solid angle is the pupil's area to
// (1/16)² / 2 = 0.2 %, and the ratio scatters by 0.1 % from seed to seed. A lens turned about its own axis is the same
// lens, but no longer known to be round, so that its pupils are mapped over azimuth too.
TEST(ChartRender, SeesBladesAndTurnedLenses) {
    const double round = green_through_tessar_with("");
    const double blades = green_through_tessar_with("[stop]\nblades = 5\nrotation_deg = 20\n");
    EXPECT_NEAR(blades / round, 5.0 * std::sin(0.4 * std::numbers::pi) / (2.0 * std::numbers::pi), 0.005);
    const double turned = green_through_tessar_with("[[groups]]\nsurfaces = [1, 8]\ntilt_deg = [0, 0, 30]\n");
    EXPECT_NEAR(turned / round, 1.0, 0.005);
}

// The exposure is a light meter's: at f/N, a subject of luminance L gives H = q L t / N² with q = π T / 4 on the axis
// (ISO 12232); the picture's green is H / H_sat, H_sat = 78 / ISO lx·s. The lens's T is about 0.75: eight uncoated
// surfaces.
TEST(ChartRender, ExposureFollowsIso12232) {
    const render::Camera camera(small_camera("tessar", 8.0, 4.0, 8), kSampling, {}, {});
    const scene::Chart white{.pattern = scene::FlatField{}, .white_reflectance = 1.0};
    const formats::Image image = picture({camera, white, {.distance_mm = 1000.0}}, 256);
    const optics::Bundle bundle = optics::image_bundle(camera.exact().lens().at(8), 0.0);
    const double transmittance = bundle.transmitted / bundle.projected_solid_angle;
    EXPECT_GT(transmittance, 0.6);
    EXPECT_LT(transmittance, 0.8);
    // ∫ dΩ_projected = π / (4 N²) for a lens that obeys the sine condition; focused at 10 m it is 2 % slower, and pupil
    // aberration moves it by another few per cent.
    const double exposure_lx_s =
        1000.0 * std::numbers::pi / (4.0 * 64.0) * transmittance * camera.settings().exposure.time_s;
    EXPECT_NEAR(image.at(4, 3, 1) / (exposure_lx_s / 0.78), 1.0, 0.06);
}

// The same picture whatever the number of threads, and another one for another seed.
TEST(ChartRender, DependsOnTheSeedAlone) {
    const render::Camera camera(small_camera("tessar", 8.0, 36.0, 24), kSampling, {}, {});
    const scene::Chart board{.pattern = scene::Checkerboard{8, 6, 500.0}};
    const auto render = [&](int threads, std::uint64_t seed) {
        return picture({camera, board, {.distance_mm = 10000.0}}, 16, seed, threads).pixels;
    };
    EXPECT_EQ(render(1, 5), render(3, 5));
    EXPECT_NE(render(1, 5), render(1, 6));
}

// The same picture without a cache, with an empty one, and with what the render before has left in it.
TEST(ChartRender, DoesNotDependOnTheCache) {
    const TestFolder folder;
    const scene::Chart board{.pattern = scene::Checkerboard{8, 6, 500.0}};
    const auto render = [&](const Cache& cache) {
        const render::Camera camera(small_camera("muller-fisheye", 8.0, 20.0, 24), kSampling, {}, cache);
        return picture({camera, board, {.distance_mm = 10000.0}}, 16).pixels;
    };
    const std::vector<float> without = render({});
    const Cache cache(folder.path());
    EXPECT_EQ(render(cache), without) << "cold";
    EXPECT_FALSE(std::filesystem::is_empty(folder.path()));
    EXPECT_EQ(render(cache), without) << "warm";
}

// Pictures are upright: what stands at the right of the camera is at the right of the picture, what is low is low. The
// board's top-left square is black, its top-right one (even column count) white.
TEST(ChartRender, PicturesAreUpright) {
    const render::Camera camera(small_camera("tessar", 8.0, 36.0, 48), kSampling, {}, {});
    const scene::Chart board{.pattern = scene::Checkerboard{2, 1, 1500.0}};
    const auto mean_of = [](const formats::Image& image, int u0, int u1) {
        double sum = 0.0;
        for (int u = u0; u < u1; ++u) {
            sum += image.at(u, image.height / 2, 1);
        }
        return sum;
    };
    const formats::Image straight = picture({camera, board, {.distance_mm = 10000.0}}, 16);
    EXPECT_LT(mean_of(straight, 6, 18), 0.2 * mean_of(straight, 30, 42));
    // Turned towards the right, the board's centre (black to its left) moves right by f tan 5° = 8.7 mm = 11.6 px.
    const formats::Image right = picture({camera, board, {.distance_mm = 10000.0, .towards_right_deg = 5.0}}, 16);
    EXPECT_LT(mean_of(right, 25, 35), 0.2 * mean_of(right, 37, 47));
    const formats::Image down = picture({camera, board, {.distance_mm = 10000.0, .towards_down_deg = 10.0}}, 16);
    EXPECT_GT(down.at(12, 2, 1), 2.0 * down.at(12, 33, 1));
}

}  // namespace lensproof::render_test
