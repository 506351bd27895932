#include "engine/scene/spectra/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "engine/spectral/colour_checker.h"
#include "tests/engine/scene/bsdf/bsdf_cases.h"

namespace lensproof::scene::texture_test {

spectral::SpectralGrid grid() {
    return spectral::spectral_grid(400.0, 700.0, 16);
}

// A picture that is only looked at is never copied into a Texture.
static_assert(!std::is_convertible_v<const ImageTexture&, Texture> && !std::is_convertible_v<ImageTexture&, Texture>);
static_assert(!std::is_convertible_v<const ChartTexture&, Texture> && !std::is_convertible_v<ChartTexture&, Texture>);
static_assert(!std::is_constructible_v<Texture, const spectral::GridSpectrum&>);

/// Of 3 × 2 grey pixels: 0.1, 0.2, 0.3 above 0.4, 0.5, 0.6.
double at(Wrap wrap, double u, double v) {
    ImageTexture image{.grid = {.width = 3, .height = 2, .wrap_u = wrap, .wrap_v = wrap},
                       .texel = {},
                       .abscissa = spectral::constant_spectrum(0.0, grid()),
                       .white = spectral::constant_spectrum(1.0, grid())};
    for (const float grey : {0.1F, 0.2F, 0.3F, 0.4F, 0.5F, 0.6F}) {
        image.texel.push_back({.shape = {}, .scale = 2.0F * grey});  // of a shape that is ½ everywhere
    }
    return value_at(image, Vec2d{u, v}, grid().path(0))[0];
}

constexpr double kFloatRounding = 0x1p-23;

// At pixels' centres the pixels' own values, from the top left, which is (0, 1); between them straight lines.
TEST(Texture, IsBilinearBetweenPixelCentres) {
    for (const Wrap wrap : {Wrap::repeat, Wrap::clamp}) {
        EXPECT_NEAR(at(wrap, 0.5 / 3, 0.75), 0.1, kFloatRounding);
        EXPECT_NEAR(at(wrap, 2.5 / 3, 0.75), 0.3, kFloatRounding);
        EXPECT_NEAR(at(wrap, 0.5 / 3, 0.25), 0.4, kFloatRounding);
        EXPECT_NEAR(at(wrap, 1.0 / 3, 0.75), 0.15, kFloatRounding);
        EXPECT_NEAR(at(wrap, 0.5, 0.5), 0.35, kFloatRounding);
        EXPECT_NEAR(at(wrap, 1.25 / 3, 0.65), 0.175 + 0.2 * 0.3, 2 * kFloatRounding);
    }
}

// Beyond an edge the picture comes again, so that the edge's pixels meet the other side's; or the edge goes on.
TEST(Texture, GoesOnBeyondItsEdges) {
    EXPECT_NEAR(at(Wrap::repeat, 0.0, 0.75), 0.2, kFloatRounding);
    EXPECT_NEAR(at(Wrap::repeat, 1.0 + 0.5 / 3, 0.75), 0.1, kFloatRounding);
    EXPECT_NEAR(at(Wrap::repeat, -7.0 + 0.5 / 3, 3.25), 0.4, 4 * kFloatRounding);
    EXPECT_NEAR(at(Wrap::repeat, 0.5, 1.0), 0.35, kFloatRounding);
    // A mirror image begins with the edge's pixel once more.
    EXPECT_NEAR(at(Wrap::mirror, 0.0, 0.75), 0.1, kFloatRounding);
    EXPECT_NEAR(at(Wrap::mirror, 1.0 + 1.5 / 3, 0.75), 0.2, kFloatRounding);
    EXPECT_NEAR(at(Wrap::mirror, -0.5 / 3, 0.75), 0.1, kFloatRounding);
    EXPECT_NEAR(at(Wrap::mirror, -2.0 + 2.5 / 3, 1.25), 0.3, kFloatRounding);
    EXPECT_NEAR(at(Wrap::clamp, 0.0, 0.75), 0.1, kFloatRounding);
    EXPECT_NEAR(at(Wrap::clamp, 9.0, -9.0), 0.6, kFloatRounding);
    EXPECT_NEAR(at(Wrap::clamp, -1e300, 1e300), 0.1, kFloatRounding);
    for (const double odd :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
        EXPECT_TRUE(std::isfinite(at(Wrap::repeat, odd, 0.5)));
        EXPECT_TRUE(std::isfinite(at(Wrap::clamp, 0.5, odd)));
    }
}

// A chart on a surface is the chart: at each point its own reflectance, to a float's rounding, x to the right, y down.
TEST(Texture, ChartsAreTheCharts) {
    const Chart chart{.pattern = Checkerboard{.columns = 5, .rows = 4, .square_mm = 20.0},
                      .white_reflectance = 0.85,
                      .black_reflectance = 0.03};
    const Texture texture = chart_texture(chart, 120.0, 90.0, grid());
    Uniform uniform(1);
    for (int i = 0; i < 2000; ++i) {
        const Vec2d uv{uniform(), uniform()};
        const double expected = reflectance(chart, (uv.x - 0.5) * 120.0, (0.5 - uv.y) * 90.0);
        EXPECT_NEAR(value_at(texture, uv, grid().path(i % 16))[2], expected, kFloatRounding);
    }
    const double left = 0.5 - 45.0 / 120.0;
    EXPECT_NEAR(value_at(texture, {left, 0.5 + 35.0 / 90.0}, grid().path(0))[0], 0.03, kFloatRounding) << "top left";
    EXPECT_NEAR(value_at(texture, {left, 0.5 - 35.0 / 90.0}, grid().path(0))[0], 0.85, kFloatRounding) << "below it";
}

// Each patch's middle has the measured reflectance at the path's wavelengths, from dark skin at the top left to black
// at the bottom right; between patches is the frame.
TEST(Texture, ColourCheckersPatchesAreAsMeasured) {
    // 6 × 4 patches of 40 mm, 6 mm apart: a card of 282 × 190 mm.
    const Chart card{.pattern = ColourChecker{.patch_mm = 40.0, .gap_mm = 6.0}, .black_reflectance = 0.04};
    const Texture texture = chart_texture(card, 276.0, 184.0, grid());
    const std::vector<spectral::ColourPatch> patches = spectral::colour_checker();
    const spectral::PathWavelengths path = grid().path(5);
    for (std::size_t i = 0; i < patches.size(); ++i) {
        const std::size_t column = i % 6;
        const std::size_t row = i / 6;
        const Vec2d middle{(static_cast<double>(column) + 0.5) / 6.0, 1.0 - (static_cast<double>(row) + 0.5) / 4.0};
        const spectral::SpectralSample value = value_at(texture, middle, path);
        for (std::size_t c = 0; c < spectral::kWavelengthsPerPath; ++c) {
            EXPECT_NEAR(value[c], patches[i].reflectance(grid().wavelengths_nm(path)[c]), kFloatRounding);
        }
    }
    for (const Vec2d frame : {Vec2d{0.0, 0.0}, {1.0, 1.0}, {1.0 / 6.0, 0.4}, {0.4, 0.25}, {-3.0, 0.5}, {0.5, 7.0}}) {
        EXPECT_EQ(value_at(texture, frame, path), spectral::SpectralSample(0.04F));
    }
}

}  // namespace lensproof::scene::texture_test
