// Pictures of the sky as light.
#include "engine/scene/light/environment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/base/input_error.h"
#include "engine/render/sampling/sampler.h"

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
        return sky.seen({std::cos(h) * std::cos(a), std::cos(h) * std::sin(a), std::sin(h)}, path).radiance[0];
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
        const Environment::Draw draw = sky.draw(u[0], u[1]);
        const Environment::Seen seen = sky.seen(draw.direction, path);
        const double radiance = sky.radiance_at(draw.uv, path)[0];
        ASSERT_NEAR(seen.pdf, draw.pdf, 1e-6 * draw.pdf);
        ASSERT_NEAR(seen.radiance[0], radiance, 2e-4);
        all += radiance / draw.pdf / kDraws;
        from_above += radiance / draw.pdf / kDraws * std::max(0.0, draw.direction.z);
    }
    const auto radiance = [&](const Vec3d& direction) -> double { return sky.seen(direction, path).radiance[0]; };
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
    const spectral::PathWavelengths path = kGrid.path(0);
    EXPECT_NEAR(over_all_directions([&](const Vec3d& to) { return sky.seen(to, path).pdf; }), 1.0, 1e-9);
}

TEST(Environment, RefusesABlackPicture) {
    EXPECT_THROW(Environment(grey_picture(2, 2, {0, 0, 0, 0}), {0.0, 0.0, 1.0}, 0.0), InputError);
}

}  // namespace lensproof::scene::environment_test
