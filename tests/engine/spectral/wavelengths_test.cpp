#include "engine/spectral/wavelengths.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/input_error.h"

namespace lensproof::spectral::wavelengths_test {

// Hydrogen's F and C are Balmer β and α: 1/λ = R_H (1/4 − 1/n²), R_H = 10967758.34 m⁻¹ (the vacuum wavelengths), and
// standard air divides by n = 1.000279 (F) and 1.000276 (C) (Ciddor 1996). Fine structure splits these
// lines by up to 0.016 nm, and catalogues name one component.
TEST(SpectralLines, FAndCAreBalmers) {
    const auto vacuum_nm = [](double n) { return 1e9 / (10967758.34 * (0.25 - 1.0 / (n * n))); };
    EXPECT_NEAR(kLineF, vacuum_nm(4) / 1.000279, 0.02);
    EXPECT_NEAR(kLineC, vacuum_nm(3) / 1.000276, 0.02);
}

TEST(SpectralLines, LettersAreCased) {
    EXPECT_EQ(kLineD, 587.5618);
    EXPECT_EQ(kLineSodium, 589.2938);
    EXPECT_EQ(kLineFPrime, 479.9914);
}

TEST(SpectralLines, AreListedFromVioletToInfrared) {
    for (std::size_t i = 1; i < spectral_lines().size(); ++i) {
        EXPECT_LT(spectral_lines()[i - 1].wavelength_nm, spectral_lines()[i].wavelength_nm);
    }
}

TEST(WavelengthStrata, FillTheRangeInEqualParts) {
    const WavelengthStrata strata = wavelength_strata(400.0, 700.0, 3);
    EXPECT_EQ(strata.width_nm(), 100.0);
    EXPECT_EQ(strata.midpoints(), (std::vector{450.0, 550.0, 650.0}));
    EXPECT_EQ(strata.at(0, 0.0), 400.0);
    EXPECT_EQ(strata.at(2, 1.0), 700.0);
    EXPECT_EQ(strata.at(1, 0.0), strata.at(0, 1.0));
}

TEST(WavelengthStrata, RefusesEmptyRanges) {
    EXPECT_THROW(wavelength_strata(700.0, 400.0, 3), InputError);
    EXPECT_THROW(wavelength_strata(400.0, 400.0, 3), InputError);
    EXPECT_THROW(wavelength_strata(0.0, 400.0, 3), InputError);
    EXPECT_THROW(wavelength_strata(400.0, 700.0, 0), InputError);
    EXPECT_THROW(wavelength_strata(std::nan(""), 700.0, 3), InputError);
    EXPECT_THROW(wavelength_strata(400.0, INFINITY, 3), InputError);
}

}  // namespace lensproof::spectral::wavelengths_test
