#include "engine/spectral/spectral_exr.h"

#include <gtest/gtest.h>

#include "engine/spectral/wavelengths.h"

namespace lensproof::spectral::spectral_exr_test {

/// The wavelength that `name` stands for, nm; 0 where it is no spectral channel.
double wavelength_in(std::string_view name) {
    const auto channel = parse_spectral_channel(name);
    return channel ? channel->wavelength_nm : 0.0;
}

TEST(SpectralExr, NamesAreTheLayouts) {
    EXPECT_EQ(spectral_channel_name(550.0), "S0.550,000000nm");
    EXPECT_EQ(spectral_channel_name(kLineD), "S0.587,561800nm");
}

// Six decimals of a nm: half a unit of the last is lost at most.
TEST(SpectralExr, NamesRoundTrip) {
    for (const double wavelength_nm : wavelength_strata(380.0, 780.0, 37).midpoints()) {
        const auto channel = parse_spectral_channel(spectral_channel_name(wavelength_nm));
        ASSERT_TRUE(channel.has_value());
        EXPECT_EQ(channel->layer, "S0");
        EXPECT_NEAR(channel->wavelength_nm, wavelength_nm, 5.01e-7);
    }
}

// The forms that the paper's grammar allows, other units too; 299792458 m/s / 545 THz = 550.0778 nm.
TEST(SpectralExr, ReadsEveryFormOfTheLayout) {
    EXPECT_EQ(wavelength_in("S0.550nm"), 550.0);
    EXPECT_EQ(wavelength_in("S3.550,5nm"), 550.5);
    EXPECT_EQ(wavelength_in("T.550,nm"), 550.0);
    EXPECT_NEAR(wavelength_in("S0.,55um"), 550.0, 1e-12);
    EXPECT_NEAR(wavelength_in("S0.5,5e-1um"), 550.0, 1e-12);
    EXPECT_NEAR(wavelength_in("S0.5,5E-7m"), 550.0, 1e-12);
    EXPECT_NEAR(wavelength_in("S0.545THz"), 299792458.0 / 545e12 * 1e9, 1e-12);
    EXPECT_EQ(parse_spectral_channel("S2.550nm")->layer, "S2");
    EXPECT_EQ(parse_spectral_channel("T.550nm")->layer, "T");
}

TEST(SpectralExr, OtherChannelsAreNotSpectral) {
    for (const char* name :
         {"",          "R",        "Y",         "S0",     "S0.",      "S0.nm",      "S0.,nm",        "S4.550nm",
          "S.550nm",   "s0.550nm", "S00.550nm", "S0.550", "S0.550xm", "S0.550nmx",  "S0.550.5nm",    "S0.-550nm",
          "S0.+550nm", "S0.infnm", "S0.nannm",  "S0.0nm", "S0.0Hz",   "S0.1e999nm", "T.400nm.550nm", "S0. 550nm"}) {
        EXPECT_FALSE(parse_spectral_channel(name).has_value()) << name;
    }
}

TEST(SpectralExr, AttributesSayWhatTheLayersHold) {
    const auto attributes = spectral_attributes(kFilmIrradianceUnits);
    EXPECT_EQ(attributes.at("spectralLayoutVersion"), "1.0");
    EXPECT_EQ(attributes.at("emissiveUnits"), "W.m^-2.nm^-1");
}

}  // namespace lensproof::spectral::spectral_exr_test
