#include "engine/render/film/film.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "engine/base/angle.h"
#include "tests/engine/render/film/film_sample.h"

namespace lensproof::render::film_test {

constexpr double kRounding = 1e-14;  // of some dozens of additions of numbers of size 1

std::size_t bytes_of(const Film& film) {
    std::size_t bytes = 0;
    Film::visit_sums(film, [&]<class Sums>(const Sums& sums) {
        if constexpr (!std::is_arithmetic_v<Sums>) {
            bytes += sums.size() * sizeof sums[0];
        }
    });
    return bytes;
}

// With 8 spectral bins, camera and light paths and every feature: below 300 bytes a pixel, and no more than said.
TEST(Film, TakesLessThan300BytesAPixelWithEightBins) {
    const FilmLayout layout = full_film(10, 7, 8);
    EXPECT_LT(film_bytes_per_pixel(layout), 300U);
    EXPECT_EQ(bytes_of(Film(layout)), 70 * film_bytes_per_pixel(layout));
}

// A sample of irradiance E in stratum i of N is worth E over the whole band to R, G and B, and N E to its own stratum;
// here two layers of two strata each.
TEST(Film, WeighsSamplesByTheirStratum) {
    FilmLayout layout = plain_film(2, 1, 2);
    layout.rgb_weights = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, {1.0, 1.0, 1.0}};
    layout.band_nm = 100.0;
    const Film film = film_of(layout, {.rect = {1, 0, 1, 1}, .first = 0, .end = 4}, [&](FilmTile& tile) {
        tile.add(0, 0, 0, 4.0);
        tile.add(0, 1, 1, 8.0);
        tile.add(0, 3, 3, 2.0);  // of the third sample there is nothing to tell
    });
    EXPECT_EQ(film.estimate(1, 0).rgb, (Vec3d{150.0, 250.0, 50.0}));
    std::array<double, 2> layers{};
    film.layers(1, 0, layers);
    EXPECT_EQ(layers, (std::array<double, 2>{2.0 * 12.0 / 4.0, 2.0 * 2.0 / 4.0}));
    EXPECT_EQ(film.counts(1, 0).samples, 4U);
    EXPECT_EQ(film.estimate(0, 0).rgb, Vec3d{});
}

// A path's four wavelengths count as the mean of what each would be alone, and as one sample for the variance.
TEST(Film, TakesFourWavelengthsAsOneSample) {
    FilmLayout layout = plain_film(1, 1, 4);
    layout.rgb_weights = {{1.0, 0.0, 0.0}, {0.0, 2.0, 0.0}, {0.0, 0.0, 4.0}, {1.0, 1.0, 1.0}};
    const std::array<std::uint16_t, 4> strata = {2, 3, 0, 1};
    const std::array<float, 4> irradiance = {1.0F, 2.0F, 3.0F, 5.0F};
    const Film film =
        film_of(layout, {.rect = {0, 0, 1, 1}, .first = 15, .end = 17}, [&](FilmTile& tile) {  // a block each
            tile.add(0, 15, strata, irradiance);
        });
    // R = (3 + 2) / 4, G = (2 · 5 + 2) / 4, B = (4 · 1 + 2) / 4 in one of two samples, nothing in the other.
    EXPECT_EQ(film.estimate(0, 0).rgb, (Vec3d{0.625, 1.5, 0.75}));
    // Of x and 0 the variance of the mean is x² / 4.
    EXPECT_EQ(film.estimate(0, 0).variance, (Vec3d{0.390625, 2.25, 0.5625}));
    std::array<double, 4> layers{};
    film.layers(0, 0, layers);
    EXPECT_EQ(layers, (std::array<double, 4>{1.5, 2.5, 0.5, 1.0}));
}

// Independent samples of variance 1: 100 of them have a mean of variance 1/100, which the estimates' mean over 4096
// pixels has to meet. An estimate from 7 blocks of exponential numbers' sums scatters by about √(2/6 + 6/100) = 0.63 of
// itself, so their mean by 1 %; 4 % are four of these. The same of R², G², B² = 1, 4, 9 times.
TEST(Film, StatesTheVarianceOfIndependentSamples) {
    const int side = 64;
    const Film film = exponential_film(side, 1, 0, 100);
    Vec3d stated;
    Vec3d spread;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const auto [rgb, variance] = film.estimate(x, y);
            stated = stated + (1.0 / (side * side)) * variance;
            const Vec3d off = rgb - Vec3d{1.0, 2.0, 3.0};
            spread = spread + (1.0 / (side * side)) * Vec3d{off.x * off.x, off.y * off.y, off.z * off.z};
        }
    }
    EXPECT_NEAR(stated.x, 0.01, 0.04 * 0.01);
    EXPECT_NEAR(stated.y, 0.04, 0.04 * 0.04);
    EXPECT_NEAR(stated.z, 0.09, 0.04 * 0.09);
    // And the pixels do scatter so: of 4096 squares, each scattering by √2 of itself, the mean by 2.2 %.
    EXPECT_NEAR(spread.x, 0.01, 4 * 0.022 * 0.01);
}

// Three films of different samples, merged, are the film of all samples: values to rounding, and to the last bit where
// nothing else is summed. The variance of parts that end within blocks has other blocks, but the same expectation: over
// 256 pixels of about 0.63 scatter each, both means meet 1/100 within 4 · 4 %.
TEST(Film, PartsAddUpToTheWhole) {
    const int side = 16;
    const Film whole = exponential_film(side, 2, 0, 100);
    Film sum = exponential_film(side, 2, 40, 100);
    sum.merge(exponential_film(side, 2, 0, 7));
    sum.merge(exponential_film(side, 2, 7, 40));
    double variance = 0.0;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            EXPECT_NEAR(sum.estimate(x, y).rgb.z, whole.estimate(x, y).rgb.z, kRounding);
            EXPECT_EQ(sum.counts(x, y).samples, 100U);
            variance += sum.estimate(x, y).variance.x / (side * side);
        }
    }
    EXPECT_NEAR(variance, 0.01, 0.16 * 0.01);
    EXPECT_THROW(sum.merge(Film(plain_film(side, side, 2))), std::invalid_argument);
}

// Turns that end between blocks change no bit, those that end within do no harm beyond rounding.
TEST(Film, DoesNotKnowInHowManyTurnsSamplesCame) {
    const FilmLayout layout = plain_film(5, 3);
    const auto in_turns = [&](const std::vector<std::uint32_t>& ends) {
        Film film(layout);
        FilmTile tile(layout);
        std::uint32_t first = 0;
        for (const std::uint32_t end : ends) {
            const TileSamples samples{.rect = {0, 0, 5, 3}, .first = first, .end = end};
            film.load(samples, tile);
            exponential_renderer(layout, 3)(samples, tile);
            tile.finish();
            film.store(tile);
            first = end;
        }
        return film;
    };
    const Film at_once = in_turns({70});
    const Film in_blocks = in_turns({16, 64, 70});
    const Film across = in_turns({1, 20, 70});
    for (int i = 0; i < 15; ++i) {
        EXPECT_EQ(in_blocks.estimate(i % 5, i / 5).rgb, at_once.estimate(i % 5, i / 5).rgb);
        EXPECT_EQ(in_blocks.estimate(i % 5, i / 5).variance, at_once.estimate(i % 5, i / 5).variance);
        EXPECT_NEAR(across.estimate(i % 5, i / 5).rgb.x, at_once.estimate(i % 5, i / 5).rgb.x, kRounding);
    }
}

/// A film of light paths with the filter, 9 × 9 pixels.
Film with_splats(const std::string& filter, const std::function<void(FilmTile&)>& add) {
    FilmLayout layout = plain_film(9, 9, 4);
    layout.has_splats = true;
    layout.filter = PixelFilter::named(filter);
    return film_of(layout, {.rect = {3, 3, 2, 2}, .first = 0, .end = 1}, add);
}

constexpr std::array<std::uint16_t, 4> kStrata = {0, 1, 2, 3};
constexpr std::array<float, 4> kOnes = {1.0F, 1.0F, 1.0F, 1.0F};

// A tent gives a point three quarters of the way to the next pixel a quarter of the one and three quarters of the
// other; the box gives all to the nearer one. Anywhere on the film, and beyond its edge as far as filters reach.
TEST(Film, SpreadsSplatsByTheFilter) {
    const auto value = [](const Film& film, int x, int y) { return film.light_estimate(x, y).rgb.x; };
    const auto add = [](FilmTile& tile) {
        tile.begin_light_path();
        tile.splat(all_at(6.75, 1.0), kStrata, kOnes);
        tile.begin_light_path();
        tile.splat(all_at(-0.5, 8.0), kStrata, kOnes);
        tile.splat(all_at(-1e300, 0.0), kStrata, kOnes);
        tile.splat(all_at(4.0, 1e9), kStrata, kOnes);
    };
    const Film tent = with_splats("tent", add);
    EXPECT_EQ(value(tent, 6, 1), 0.125);
    EXPECT_EQ(value(tent, 7, 1), 0.375);
    EXPECT_EQ(value(tent, 0, 8), 0.25);
    const Film box = with_splats("box", add);
    EXPECT_EQ(value(box, 6, 1), 0.0);
    EXPECT_EQ(value(box, 7, 1), 0.5);
    EXPECT_EQ(value(box, 0, 8), 0.5);
    double sum = 0.0;
    for (int i = 0; i < 81; ++i) {
        sum += value(box, i % 9, i / 9);
    }
    EXPECT_EQ(sum, 1.0) << "two splats of two paths on the film";
    std::array<double, 4> layers{};
    box.layers(7, 1, layers);
    EXPECT_EQ(layers, (std::array<double, 4>{0.5, 0.5, 0.5, 0.5}));
}

// Both ways of filtering estimate ∫∫ E f f: light paths that are even over the film and weigh E there, and camera paths
// that draw their point from the filter. Of E = 1 + (x − 4)²/4 the symmetric filter of variance s makes 1 + ((u − 4)² +
// s)/4; the variances are closed forms: 1/12 (box), 1/6 (tent), 1/9 (Mitchell: 2/15 + B/5 − 4C/15, from the cubic
// B-spline's 1/3, Catmull-Rom's 0 and the Hermite spline's 2/15). Within four of the stated standard errors, in each
// pixel of a row.
TEST(Film, FiltersCameraAndLightPathsAlike) {
    const auto irradiance = [](double x) { return 1.0 + 0.25 * (x - 4.0) * (x - 4.0); };
    for (const auto& [name, variance] : std::vector<std::pair<std::string, double>>{
             {"box", 1.0 / 12.0}, {"tent", 1.0 / 6.0}, {"mitchell", 1.0 / 9.0}}) {
        const PixelFilter filter = PixelFilter::named(name);
        const std::uint32_t paths = 40000;
        const double margin = 2.0;
        const double side = 9.0 + 2.0 * margin;
        const Film light = with_splats(name, [&](FilmTile& tile) {
            for (std::uint32_t i = 0; i < paths; ++i) {
                const double x = side * even_number(1, 0, i) - margin - 0.5;
                tile.begin_light_path();
                const auto e = static_cast<float>(side * side * irradiance(x));
                tile.splat(all_at(x, side * even_number(1, 1, i) - margin - 0.5), kStrata,
                           std::array<float, 4>{e, e, e, e});
            }
        });
        const FilmLayout layout = plain_film(9, 1);
        const std::uint32_t samples = 4000;
        const Film camera = film_of(layout, {.rect = {0, 0, 9, 1}, .first = 0, .end = samples}, [&](FilmTile& tile) {
            for (std::uint32_t pixel = 0; pixel < 9; ++pixel) {
                for (std::uint32_t i = 0; i < samples; ++i) {
                    const PixelFilter::Draw across = filter.draw(even_number(2, pixel, i));
                    const double down = filter.draw(even_number(3, pixel, i)).weight;
                    tile.add(pixel, i, 0, irradiance(pixel + across.offset_px) * across.weight * down);
                }
            }
        });
        for (int u = 0; u < 9; ++u) {
            const double expected = 1.0 + 0.25 * ((u - 4.0) * (u - 4.0) + variance);
            for (const auto& [technique, estimate] :
                 {std::pair("camera", camera.estimate(u, 0)), std::pair("light", light.light_estimate(u, 4))}) {
                EXPECT_GT(estimate.variance.x, 0.0);
                EXPECT_NEAR(estimate.rgb.x, expected, 4.0 * std::sqrt(estimate.variance.x))
                    << name << " " << technique << u;
            }
        }
    }
}

// Splats that are even over the film leave a pixel (∫ f²)² of the variance that the box leaves it: of the tent 4/9, of
// e^(−2x²) − e^(−2r²), |x| < r, what its integrals make. Estimated from 1200 splats of each of 25 pixels, whose noise
// is 0.6 % of it: within four times that of each.
TEST(Film, WiderFiltersLeaveLessNoise) {
    constexpr double kSide = 13.0;
    const auto variance = [](const std::string& name) {
        const Film film = with_splats(name, [](FilmTile& tile) {
            for (std::uint32_t i = 0; i < 200000; ++i) {
                tile.begin_light_path();
                tile.splat(all_at(kSide * even_number(1, 0, i) - 2.5, kSide * even_number(1, 1, i) - 2.5), kStrata,
                           kOnes);
            }
        });
        double sum = 0.0;
        for (int i = 0; i < 25; ++i) {
            sum += film.light_estimate(2 + i % 5, 2 + i / 5).variance.x;
        }
        return sum;
    };
    const double box = variance("box");
    EXPECT_NEAR(variance("tent") / box, 4.0 / 9.0, 0.024 * 4.0 / 9.0);
    const double r = PixelFilter::named("gaussian").radius_px();
    const double end = std::exp(-2.0 * r * r);
    const double first = std::sqrt(0.5 * kPi) * std::erf(std::numbers::sqrt2 * r);
    const double integral = first - 2.0 * r * end;
    const double square = 0.5 * std::sqrt(kPi) * std::erf(2.0 * r) - 2.0 * end * first + 2.0 * r * end * end;
    const double expected = std::pow(square / (integral * integral), 2.0);
    EXPECT_NEAR(expected, 0.337, 0.001);
    EXPECT_NEAR(variance("gaussian") / box, expected, 0.024 * expected);
}

// A path that brings 1, then 2 to one pixel brings it 3: of four paths, three of which bring it nothing, the mean is
// 3/4 and its variance (9/4 − 9/16) / 3 (the unbiased estimate of a mean's variance).
TEST(Film, TakesALightPathsSplatsTogether) {
    const Film film = with_splats("box", [](FilmTile& tile) {
        tile.begin_light_path();
        tile.splat(all_at(5.0, 5.0), kStrata, kOnes);
        tile.splat(all_at(1.0, 5.0), kStrata, kOnes);
        tile.splat(all_at(5.0, 5.0), kStrata, std::array<float, 4>{2.0F, 2.0F, 2.0F, 2.0F});
        for (int i = 0; i < 3; ++i) {
            tile.begin_light_path();
        }
    });
    EXPECT_EQ(film.light_estimate(5, 5).rgb.x, 0.75);
    EXPECT_EQ(film.light_estimate(5, 5).variance.x, (9.0 / 4.0 - 9.0 / 16.0) / 3.0);
    EXPECT_EQ(film.light_estimate(1, 5).variance.x, (1.0 / 4.0 - 1.0 / 16.0) / 3.0);
}

// What is no finite number is counted and leaves the pixel as it was.
TEST(Film, LeavesOutWhatIsNoFiniteNumber) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    const FilmLayout layout = full_film(1, 1, 4);
    const Film film = film_of(layout, {.rect = {0, 0, 1, 1}, .first = 0, .end = 4}, [&](FilmTile& tile) {
        tile.add(0, 0, kStrata, kOnes);
        tile.add(0, 1, kStrata, std::array<float, 4>{1.0F, nan, 1.0F, 1.0F});
        tile.add(0, 2, 1, -inf);
        tile.add_features(0, {.depth_mm = nan, .albedo_rgb = {}, .normal = {}});
        tile.begin_light_path();
        tile.splat(all_at(0.0, 0.0), kStrata, std::array<float, 4>{inf, 1.0F, 1.0F, 1.0F});
        tile.splat(all_at(nan, 0.0), kStrata, kOnes);
        tile.splat(all_at(0.0, 0.0), kStrata, kOnes);
    });
    EXPECT_EQ(film.left_out(), 5U);
    EXPECT_EQ(film.camera_estimate(0, 0).rgb.x, 0.25);
    EXPECT_EQ(film.light_estimate(0, 0).rgb.x, 1.0);
    EXPECT_EQ(film.coverage(0, 0), 0.0);
    Film other(layout);
    other.merge(film);
    EXPECT_EQ(other.left_out(), 5U);
}

// Depth is the mean over samples that met something, albedo and normal over all, as denoisers want them.
TEST(Film, KeepsFeaturesAsMeans) {
    FilmLayout layout = plain_film(1, 1);
    layout.has_features = true;
    const Film film = film_of(layout, {.rect = {0, 0, 1, 1}, .first = 0, .end = 4}, [&](FilmTile& tile) {
        tile.add_features(0, {.depth_mm = 100.0, .albedo_rgb = {0.5, 0.25, 1.0}, .normal = {0.0, 0.0, -1.0}});
        tile.add_features(0, {.depth_mm = 300.0, .albedo_rgb = {0.5, 0.25, 0.0}, .normal = {0.0, -1.0, 0.0}});
    });
    EXPECT_EQ(film.coverage(0, 0), 0.5);
    EXPECT_EQ(film.features(0, 0).depth_mm, 200.0);
    EXPECT_EQ(film.features(0, 0).albedo_rgb, (Vec3d{0.25, 0.125, 0.25}));
    EXPECT_EQ(film.features(0, 0).normal, (Vec3d{0.0, -0.25, -0.25}));
}

}  // namespace lensproof::render::film_test
