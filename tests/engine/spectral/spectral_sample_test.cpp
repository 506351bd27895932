#include "engine/spectral/spectral_sample.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "engine/base/input_error.h"

namespace lensproof::spectral::spectral_sample_test {

// Each of the four places of a path meets every stratum once as the hero runs through them, so an estimator that takes
// each place at face value counts every wavelength equally; and no path carries a wavelength twice.
TEST(SpectralGrid, EveryPlaceOfAPathMeetsEveryStratumOnce) {
    const SpectralGrid grid = spectral_grid(400.0, 700.0, 64);
    std::vector<int> met(256);
    for (int hero = 0; hero < grid.size(); ++hero) {
        const PathWavelengths path = grid.path(hero);
        EXPECT_EQ(path.index[0], hero);
        for (std::size_t place = 0; place < kWavelengthsPerPath; ++place) {
            ++met[place * 64 + path.index[place]];
            EXPECT_EQ(grid.wavelengths_nm(path)[place], grid.strata.midpoint(path.index[place]));
            EXPECT_EQ((path.index[place] - hero + 64) % 64, static_cast<int>(place) * 16);
        }
    }
    EXPECT_EQ(met, std::vector<int>(met.size(), 1));
}

// A lamp's line of half-width 1 nm keeps its power wherever it lies between the strata, even across a border. Means are
// rounded to float: 2⁻²⁴ of each, so of their sum.
TEST(SpectralGrid, MeansKeepTheLightOfALine) {
    const SpectralGrid grid = spectral_grid(400.0, 700.0, 16);
    for (const double at_nm : {404.66, 500.0, 546.07, 418.75, 611.6}) {
        const Spectrum line{.wavelength_nm = {at_nm - 1.0, at_nm, at_nm + 1.0}, .value = {0.0, 3.0, 0.0}};
        const GridSpectrum means = stratum_means(line, grid);
        const double power = grid.strata.width_nm() * std::accumulate(means.value.begin(), means.value.end(), 0.0);
        EXPECT_NEAR(power, 3.0, 3.0 * 0x1p-23) << at_nm;
    }
}

// The mean of a straight line over a stratum is its value in the middle: the two tables agree, to a float's rounding of
// values below 2.
TEST(SpectralGrid, OfAStraightLineMeansAreMidpoints) {
    const SpectralGrid grid = spectral_grid(400.0, 700.0, 12);
    const Spectrum line{.wavelength_nm = {300.0, 800.0}, .value = {0.5, 1.5}};
    const GridSpectrum means = stratum_means(line, grid);
    const GridSpectrum middles = at_midpoints(line, grid);
    for (std::size_t i = 0; i < 12; ++i) {
        EXPECT_NEAR(means.value[i], middles.value[i], 0x1p-23);
        EXPECT_NEAR(middles.value[i], 0.5 + (grid.strata.midpoint(static_cast<int>(i)) - 300.0) / 500.0, 0x1p-23);
    }
}

// A reflectance measured from 450 to 600 nm does not turn black beyond, as a lamp's light does.
TEST(SpectralGrid, MaterialsKeepTheirLastValueAndLightsEnd) {
    const SpectralGrid grid = spectral_grid(400.0, 700.0, 8);
    const Spectrum measured{.wavelength_nm = {450.0, 600.0}, .value = {0.25, 0.75}};
    EXPECT_EQ(at_midpoints(measured, grid).value.front(), 0.25F);
    EXPECT_EQ(at_midpoints(measured, grid).value.back(), 0.75F);
    EXPECT_EQ(stratum_means(measured, grid).value.front(), 0.0F);
    EXPECT_EQ(stratum_means(measured, grid).value.back(), 0.0F);
    EXPECT_EQ(at_midpoints({}, grid).value, std::vector<float>(8, 0.0F));
    EXPECT_EQ(constant_spectrum(0.5, grid).value, std::vector<float>(8, 0.5F));
}

TEST(SpectralGrid, RefusesWhatPathsCannotShareEvenly) {
    EXPECT_THROW(spectral_grid(400.0, 700.0, 0), InputError);
    EXPECT_THROW(spectral_grid(400.0, 700.0, -4), InputError);
    EXPECT_THROW(spectral_grid(400.0, 700.0, 30), InputError);
    EXPECT_THROW(spectral_grid(400.0, 700.0, 65540), InputError);
    EXPECT_THROW(spectral_grid(700.0, 400.0, 32), InputError);
    EXPECT_THROW(spectral_grid(400.0, std::nan(""), 32), InputError);
    EXPECT_EQ(spectral_grid(400.0, 700.0, 65536).path(65535).index[1], 16383);
}

// Wavelength by wavelength, exactly: each number is one float operation.
TEST(SpectralSample, OperatorsWorkWavelengthByWavelength) {
    const SpectralSample a({1.0F, 2.0F, 3.0F, 4.0F});
    const SpectralSample b({0.5F, 0.25F, 2.0F, 8.0F});
    EXPECT_EQ(a + b, SpectralSample({1.5F, 2.25F, 5.0F, 12.0F}));
    EXPECT_EQ(a - b, SpectralSample({0.5F, 1.75F, 1.0F, -4.0F}));
    EXPECT_EQ(a * b, SpectralSample({0.5F, 0.5F, 6.0F, 32.0F}));
    EXPECT_EQ(a / b, SpectralSample({2.0F, 8.0F, 1.5F, 0.5F}));
    EXPECT_EQ(2.0F * a, SpectralSample({2.0F, 4.0F, 6.0F, 8.0F}));
    EXPECT_EQ(max_value(a), 4.0F);
    EXPECT_EQ(mean(a), 2.5F);
    EXPECT_EQ(hero_alone(a), SpectralSample({1.0F, 0.0F, 0.0F, 0.0F}));
    EXPECT_TRUE(is_black(SpectralSample()));
    EXPECT_FALSE(is_black(SpectralSample({0.0F, 0.0F, 0.0F, 1.0F})));
}

}  // namespace lensproof::spectral::spectral_sample_test
