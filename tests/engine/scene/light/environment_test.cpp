// Pictures of the sky as light.
#include "engine/scene/light/environment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "engine/base/input_error.h"
#include "engine/render/sampling/sampler.h"
#include "engine/scene/light/packet/map_kernels.h"

namespace lensproof::scene::environment_test {

constexpr double kPi = std::numbers::pi;
const spectral::SpectralGrid kGrid = spectral::spectral_grid(400.0, 700.0, 8);

/// A picture of one grey a pixel, as light of radiance 1 where it is 1.
ImageTexture grey_picture(int width, int height, const std::vector<float>& values) {
    ImageTexture picture{.grid = {width, height, Wrap::repeat, Wrap::clamp},
                         .texel = {},
                         .abscissa = spectral::tabulated(kGrid, spectral::sigmoid_abscissa),
                         .white = spectral::constant_spectrum(1.0, kGrid)};
    const spectral::SigmoidSpectrum half{};  // 1/2 everywhere
    for (const float value : values) {
        picture.texel.push_back({.shape = half, .scale = value / half.at(0.0F)});
    }
    return picture;
}

// The picture's middle column shows +x, what is left of it lies counter-clockwise, and the top row lies upwards.
TEST(Environment, StandsAsItSays) {
    const ImageTexture picture = grey_picture(4, 2, {1, 2, 3, 4, 5, 6, 7, 8});
    const spectral::PathWavelengths path = kGrid.path(0);
    const auto seen = [&](const Environment& sky, double azimuth_deg, double height_deg) {
        const double a = azimuth_deg * kPi / 180.0;
        const double h = height_deg * kPi / 180.0;
        return sky.radiance_at(sky.find({std::cos(h) * std::cos(a), std::cos(h) * std::sin(a), std::sin(h)}), path)[0];
    };
    const Environment sky(picture, {0.0, 0.0, 1.0}, 0.0);
    // The pixels' centres: 45° to either side of the middle and of the edge, 45° up and down.
    EXPECT_NEAR(seen(sky, 45.0, 45.0), 2.0, 1e-5);
    EXPECT_NEAR(seen(sky, -45.0, 45.0), 3.0, 1e-5);
    EXPECT_NEAR(seen(sky, 135.0, 45.0), 1.0, 1e-5);
    EXPECT_NEAR(seen(sky, -135.0, -45.0), 8.0, 1e-5);
    const Environment turned(picture, {0.0, 0.0, 1.0}, 90.0);
    EXPECT_NEAR(seen(turned, 135.0, 45.0), 2.0, 1e-5);
}

/// 16 × 8 pixels of a dim sky with a sun in one.
ImageTexture sky_with_sun() {
    std::vector<float> values(std::size_t{16} * 8, 0.1F);
    values[3 * 16 + 5] = 100.0F;
    return grey_picture(16, 8, values);
}

/// ∫ `function` over all directions, by the midpoints of 800 × 1600 cells.
template <class Function>
double over_all_directions(const Function& function) {
    constexpr int kSteps = 800;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        const double polar = kPi * (i + 0.5) / kSteps;
        for (int k = 0; k < 2 * kSteps; ++k) {
            const double turn = kPi * (k + 0.5) / kSteps;
            const Vec3d direction{std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)};
            sum += std::sin(polar) * function(direction);
        }
    }
    return sum * kPi / kSteps * kPi / kSteps;
}

// Directions are drawn with the pdf that is stated: a weighted mean over them gives the integral of any function,
// here the sky's irradiance from above and its whole flux, which a sum over fine cells gives too; 1e-3 by the sequence.
// What a drawn place holds is what is seen in its direction, to a float's rounding of a slope of 1600 a pixel.
TEST(Environment, DrawsWithItsDensity) {
    const Environment sky(sky_with_sun(), {0.0, 0.0, 1.0}, 0.0);
    const spectral::PathWavelengths path = kGrid.path(0);
    constexpr int kDraws = 1 << 16;
    double all = 0.0;
    double from_above = 0.0;
    const render::PixelSampler sampler(1, 0);
    for (int i = 0; i < kDraws; ++i) {
        const auto u = sampler.point(static_cast<std::uint32_t>(i));
        const MapDraw draw = sky.draw({u[0], u[1]});
        const MapPlace seen = sky.find(draw.direction);
        const double radiance = sky.radiance_at(draw.place, path)[0];
        ASSERT_NEAR(seen.pdf, draw.place.pdf, 1e-6 * draw.place.pdf);
        ASSERT_NEAR(sky.radiance_at(seen, path)[0], radiance, 2e-4);
        all += radiance / draw.place.pdf / kDraws;
        from_above += radiance / draw.place.pdf / kDraws * std::max(0.0, draw.direction.z);
    }
    const auto radiance = [&](const Vec3d& direction) -> double {
        return sky.radiance_at(sky.find(direction), path)[0];
    };
    const double expected = over_all_directions(radiance);
    const double expected_above =
        over_all_directions([&](const Vec3d& to) { return radiance(to) * std::max(0.0, to.z); });
    EXPECT_NEAR(all, expected, 1e-3 * expected);
    EXPECT_NEAR(from_above, expected_above, 1e-3 * expected_above);
}

// Every direction has its pdf: they integrate to 1. It is even within a pixel but for 1 / sin of the polar angle, which
// the sum's own sin takes away; and the sum's cells fill pixels whole.
TEST(Environment, PdfsIntegrateToOne) {
    const Environment sky(sky_with_sun(), {0.0, 0.0, 1.0}, 0.0);
    EXPECT_NEAR(over_all_directions([&](const Vec3d& to) { return sky.find(to).pdf; }), 1.0, 1e-9);
}

// Whatever the number of them, and the width of packets.
TEST(Environment, DrawsAndFindsManyAsOne) {
    const Environment sky(sky_with_sun(), normalized(Vec3d{0.3, -0.2, 1.0}), 20.0);
    constexpr std::size_t kMost = 150;
    std::vector<Vec2d> numbers;
    std::vector<Vec3d> directions = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {-1, 0, 0}};
    const render::PixelSampler sampler(1, 0);
    for (std::uint32_t i = 0; i < kMost; ++i) {
        const auto u = sampler.point(i);
        numbers.push_back({u[0], u[1]});
        directions.push_back(sky.draw({u[1], u[0]}).direction);
    }
    const auto expect_same = [](const MapPlace& a, const MapPlace& b) {
        EXPECT_EQ(a.map, b.map);
        EXPECT_EQ(a.at, b.at);
        EXPECT_EQ(a.pdf, b.pdf);
    };
    std::vector<MapDraw> draws(kMost);
    std::vector<MapPlace> places(directions.size());
    for (const std::size_t count : {std::size_t{1}, std::size_t{63}, std::size_t{65}, kMost}) {
        sky.draw(std::span(numbers).first(count), draws);
        sky.find(std::span(directions).first(count), places);
        for (std::size_t i = 0; i < count; ++i) {
            expect_same(places[i], sky.find(directions[i]));
            expect_same(draws[i].place, sky.draw(numbers[i]).place);
            EXPECT_EQ(draws[i].direction, sky.draw(numbers[i]).direction);
        }
    }
    for (const SimdLevel level : available_simd_levels()) {
        MapColumns columns;
        columns.size = 61;
        for (std::size_t i = 0; i < columns.size; ++i) {
            columns.x[i] = directions[i].x;
            columns.y[i] = directions[i].y;
            columns.z[i] = directions[i].z;
        }
        map_kernels(level).find_points(columns);
        for (std::size_t i = 0; i < columns.size; ++i) {
            const MapPoint<double> point = map_point(directions[i]);
            EXPECT_EQ(point.at, (Vec2d{columns.at_x[i], columns.at_y[i]}));
            EXPECT_EQ(point.sine, columns.sine[i]);
        }
        map_kernels(level).find_directions(columns);
        for (std::size_t i = 0; i < columns.size; ++i) {
            const MapDirection<double> of_point = map_direction(Vec2d{columns.at_x[i], columns.at_y[i]});
            EXPECT_EQ(of_point.direction, (Vec3d{columns.x[i], columns.y[i], columns.z[i]}));
            EXPECT_LT(length(of_point.direction - directions[i]), 4e-15);  // back: 2e-16 of a turn
        }
    }
}

TEST(Environment, RefusesABlackPicture) {
    EXPECT_THROW(Environment(grey_picture(2, 2, {0, 0, 0, 0}), {0.0, 0.0, 1.0}, 0.0), InputError);
}

}  // namespace lensproof::scene::environment_test
