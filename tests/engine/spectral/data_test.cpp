// The project's own tables against published numbers that follow from them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "engine/spectral/colour_checker.h"
#include "engine/spectral/colour_matching.h"
#include "engine/spectral/illuminant.h"
#include "engine/spectral/metal.h"
#include "engine/spectral/sensor_response.h"
#include "tests/test_folder.h"

namespace lensproof::spectral::data_test {

/// R at normal incidence, ((n − 1)² + k²) / ((n + 1)² + k²).
double reflectance(const ComplexIndex& metal, double wavelength_nm) {
    const double n = metal.n(wavelength_nm);
    const double k = metal.k(wavelength_nm);
    return ((n - 1.0) * (n - 1.0) + k * k) / ((n + 1.0) * (n + 1.0) + k * k);
}

struct Mirror {
    double wavelength_nm;
    double reflectance;
};

void expect_mirrors(const char* name, const std::vector<Mirror>& measured, double tolerance) {
    for (const auto& [wavelength_nm, expected] : measured) {
        EXPECT_NEAR(reflectance(metal(name), wavelength_nm), expected, tolerance) << name << " at " << wavelength_nm;
    }
}

// CIE 15:2004, table T.3: chromaticities of the F series, four decimals, as sums over 5 nm. Exact integrals differ from
// such sums where a lamp's lines stand on the observer's slopes: by (5 nm)² / 12 of its curvature, which for the
// narrow-band lamps comes to 4e-4. F2, F7 and F11 are named there as standing for the rest.
TEST(SpectralData, FluorescentLampsHaveTheCiesChromaticities) {
    constexpr std::array<Vec2d, 12> kPublished{{{0.3131, 0.3371},
                                                {0.3721, 0.3751},
                                                {0.4091, 0.3941},
                                                {0.4402, 0.4031},
                                                {0.3138, 0.3452},
                                                {0.3779, 0.3882},
                                                {0.3129, 0.3292},
                                                {0.3458, 0.3586},
                                                {0.3741, 0.3727},
                                                {0.3458, 0.3588},
                                                {0.3805, 0.3769},
                                                {0.4370, 0.4042}}};
    const ColourMatching observer = cie_1931();
    for (std::size_t i = 0; i < kPublished.size(); ++i) {
        const Spectrum lamp = illuminant("F" + std::to_string(i + 1)).relative;
        Vec3d sum;
        for (std::size_t j = 0; j < lamp.wavelength_nm.size(); ++j) {
            const double nm = lamp.wavelength_nm[j];
            sum = sum + lamp.value[j] * Vec3d{observer.x_bar(nm), observer.y_bar(nm), observer.z_bar(nm)};
        }
        // As sums over 5 nm: to the last digit that is printed, and half of one for the table's.
        EXPECT_NEAR(chromaticity(sum).x, kPublished[i].x, 1e-4) << "F" << i + 1;
        EXPECT_NEAR(chromaticity(sum).y, kPublished[i].y, 1e-4) << "F" << i + 1;
        const Vec2d exact = chromaticity(tristimulus(lamp, observer));
        EXPECT_NEAR(exact.x, kPublished[i].x, 5e-4) << "F" << i + 1;
        EXPECT_NEAR(exact.y, kPublished[i].y, 5e-4) << "F" << i + 1;
    }
}

// D50 is (0.3457, 0.3585) (ISO/CIE 11664-2), and the nearest of the F series to it, F8, imitates it.
TEST(SpectralData, D50IsWherePrintersHaveIt) {
    const Vec2d d50 = chromaticity(tristimulus(illuminant("D50").relative, cie_1931()));
    EXPECT_NEAR(d50.x, 0.3457, 1e-4);
    EXPECT_NEAR(d50.y, 0.3585, 1e-4);
}

TEST(SpectralData, EveryIlluminantThatIsNamedIsKnown) {
    for (const std::string& name : known_illuminants()) {
        if (!name.starts_with("blackbody")) {
            EXPECT_GT(integral(illuminant(name).relative), 0.0) << name;
        }
    }
    EXPECT_THROW(illuminant("F13"), InputError);
    EXPECT_THROW(illuminant("F0"), InputError);
}

// Fresh evaporated mirrors as measured by G. Hass (Applied Optics and Optical Engineering III, ed. Kingslake, 1965, and
// the AIP Handbook, table 6g): other films than the tables come from. Aluminium is the same to 0.2 %; thin silver and
// gold films differ from one laboratory to the next by a few per cent of what they absorb or, at gold's edge, reflect.
TEST(SpectralData, MirrorsReflectAsMeasuredElsewhere) {
    expect_mirrors("aluminium",
                   {{400, 0.924}, {450, 0.922}, {500, 0.918}, {550, 0.915}, {600, 0.911}, {650, 0.905}, {700, 0.897}},
                   0.002);
    expect_mirrors("silver",
                   {{400, 0.956}, {450, 0.971}, {500, 0.979}, {550, 0.983}, {600, 0.986}, {650, 0.988}, {700, 0.989}},
                   0.01);
    expect_mirrors("gold", {{450, 0.387}, {500, 0.477}, {550, 0.817}, {600, 0.919}, {650, 0.955}, {700, 0.970}}, 0.03);
}

// Copper by n and k of H.-J. Hagemann, W. Gudat, C. Kunz, DESY report SR-74/7 (1974), table 3: its edge at 580 nm,
// which makes it red, moves between films.
TEST(SpectralData, CopperReflectsAsMeasuredElsewhere) {
    const ComplexIndex elsewhere{.n = {.wavelength_nm = {442.8, 476.9, 516.6, 539.1, 563.6, 590.4, 619.9, 652.5},
                                       .value = {1.169, 1.152, 1.121, 1.037, 0.826, 0.468, 0.272, 0.214}},
                                 .k = {.wavelength_nm = {442.8, 476.9, 516.6, 539.1, 563.6, 590.4, 619.9, 652.5},
                                       .value = {2.36, 2.50, 2.60, 2.59, 2.60, 2.81, 3.24, 3.67}}};
    for (const double wavelength_nm : elsewhere.n.wavelength_nm) {
        EXPECT_NEAR(reflectance(metal("copper"), wavelength_nm), reflectance(elsewhere, wavelength_nm), 0.05);
    }
}

// Johnson and Christy's own numbers where they measured (1974, table I): 2.26 eV is 549 nm, 1.88 eV 659 nm.
TEST(SpectralData, ChromiumAndIronAreAsPrinted) {
    EXPECT_EQ(metal("chromium").n(549.0), 3.18);
    EXPECT_EQ(metal("chromium").k(549.0), 3.33);
    EXPECT_EQ(metal("iron").n(659.0), 2.92);
    EXPECT_EQ(metal("iron").k(659.0), 3.10);
    EXPECT_NEAR(reflectance(metal("chromium"), 549.0), 0.555, 5e-4);
}

TEST(SpectralData, EveryMetalThatIsNamedIsKnown) {
    for (const std::string& name : known_metals()) {
        EXPECT_LE(metal(name).n.wavelength_nm.front(), 360.0) << name;
        EXPECT_GE(metal(name).n.wavelength_nm.back(), 830.0) << name;
    }
    EXPECT_THROW(metal("unobtainium"), InputError);
    EXPECT_THROW(metal("../metal-gold"), InputError);
    const TestFolder folder;
    const auto file = folder.path() / "odd.csv";
    write_file(file, "wavelength_nm,n,k\n400,1,1\n500,-1,2\n");
    EXPECT_THROW(read_complex_index(file), InputError);
    write_file(file, "wavelength_nm,n,k\n400,0,0\n500,1,2\n");
    EXPECT_THROW(read_complex_index(file), InputError);
    EXPECT_THROW(read_complex_index(folder.path() / "none.csv"), InputError);
}

/// The patches' Y under D50 and their CIE x, y as the maker states them: GretagMacbeth 2005, in xyY.
constexpr std::array<Vec3d, 24> kStated{
    {{0.4316, 0.3777, 0.1008}, {0.4197, 0.3744, 0.3495}, {0.2760, 0.3016, 0.1836}, {0.3703, 0.4499, 0.1325},
     {0.2999, 0.2856, 0.2304}, {0.2848, 0.3911, 0.4178}, {0.5295, 0.4055, 0.3118}, {0.2305, 0.2106, 0.1126},
     {0.5012, 0.3273, 0.1938}, {0.3319, 0.2482, 0.0637}, {0.3984, 0.5008, 0.4446}, {0.4957, 0.4427, 0.4357},
     {0.2018, 0.1692, 0.0575}, {0.3253, 0.5032, 0.2318}, {0.5686, 0.3303, 0.1257}, {0.4697, 0.4734, 0.5981},
     {0.4159, 0.2688, 0.2009}, {0.2131, 0.3023, 0.1930}, {0.3469, 0.3608, 0.9131}, {0.3440, 0.3584, 0.5894},
     {0.3432, 0.3581, 0.3632}, {0.3446, 0.3579, 0.1915}, {0.3401, 0.3548, 0.0883}, {0.3406, 0.3537, 0.0311}}};

Vec3d xyz_of_patch(const ColourPatch& patch, const Illuminant& light, const ColourMatching& observer) {
    Spectrum reflected = light.relative;
    for (std::size_t i = 0; i < reflected.value.size(); ++i) {
        reflected.value[i] *= patch.reflectance(reflected.wavelength_nm[i]);
    }
    return 1.0 / tristimulus(light.relative, observer).y * tristimulus(reflected, observer);
}

// Ohta's chart and the maker's average of charts, some years apart: charts differ by 2 ΔE*ab in the mean (D. Pascale,
// "RGB coordinates of the Macbeth ColorChecker", 2006), a patch or two by more. A patch in the wrong place is off
// by 20.
TEST(SpectralData, ColourCheckerHasTheMakersColours) {
    const ColourMatching observer = cie_1931();
    const Illuminant d50 = illuminant("D50");
    const Vec3d white = 1.0 / tristimulus(d50.relative, observer).y * tristimulus(d50.relative, observer);
    const std::vector<ColourPatch> patches = colour_checker();
    ASSERT_EQ(patches.size(), kStated.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < patches.size(); ++i) {
        const auto& [x, y, luminance] = kStated[i];
        const Vec3d stated{x / y * luminance, luminance, (1.0 - x - y) / y * luminance};
        const Vec3d measured = xyz_of_patch(patches[i], d50, observer);
        const double difference = length(cielab(measured, white) - cielab(stated, white));
        EXPECT_LT(difference, 5.0) << patches[i].name;
        sum += difference;
    }
    EXPECT_LT(sum / 24.0, 2.5);
}

// The maker's sRGB for screens (8 bit; X-Rite), which are colours under D50 made to look the same under D65. Under D65
// itself paint looks a little different: by 4 of 255
// in the mean.
TEST(SpectralData, ColourCheckerLooksAsOnScreens) {
    constexpr std::array<Vec3d, 24> kScreen{
        {{115, 82, 68},   {194, 150, 130}, {98, 122, 157},  {87, 108, 67},   {133, 128, 177}, {103, 189, 170},
         {214, 126, 44},  {80, 91, 166},   {193, 90, 99},   {94, 60, 108},   {157, 188, 64},  {224, 163, 46},
         {56, 61, 150},   {70, 148, 73},   {175, 54, 60},   {231, 199, 31},  {187, 86, 149},  {8, 133, 161},
         {243, 243, 242}, {200, 200, 200}, {160, 160, 160}, {122, 122, 121}, {85, 85, 85},    {52, 52, 52}}};
    const Illuminant d65 = illuminant("D65");
    const Exposure exposure;
    const SensorResponse sensor = sensor_response("cie-1931", exposure, d65);
    const Spectrum white = irradiance_of(d65, saturation_exposure_lx_s(exposure.iso) / exposure.time_s);
    const auto encoded = [](double linear) {
        const double bounded = std::clamp(linear, 0.0, 1.0);
        return 255.0 * (bounded <= 0.0031308 ? 12.92 * bounded : 1.055 * std::pow(bounded, 1.0 / 2.4) - 0.055);
    };
    double sum = 0.0;
    const std::vector<ColourPatch> patches = colour_checker();
    for (std::size_t i = 0; i < patches.size(); ++i) {
        Spectrum reflected = white;
        for (std::size_t j = 0; j < reflected.value.size(); ++j) {
            reflected.value[j] *= patches[i].reflectance(reflected.wavelength_nm[j]);
        }
        const Vec3d rgb = sensor.values(reflected);
        const Vec3d off = Vec3d{encoded(rgb.x), encoded(rgb.y), encoded(rgb.z)} - kScreen[i];
        const double most = std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)});
        EXPECT_LT(most, 15.0) << patches[i].name;
        sum += most;
    }
    EXPECT_LT(sum / 24.0, 5.0);
}

// Two cameras are two: the Sigma's layers see far more of each other's light than the Nikon's dyes. Of light at 600 nm
// the Nikon's green takes under a third of its red; the Sigma's more than that.
TEST(SpectralData, MeasuredCamerasDiffer) {
    const SensorResponse nikon = sensor_response("camera", {}, illuminant("D65"));
    const SensorResponse sigma = sensor_response("camera-sigma-sd1-merrill", {}, illuminant("D65"));
    EXPECT_EQ(sigma.channels, nikon.channels);
    EXPECT_LT(nikon.weights(600.0).y, 0.33 * nikon.weights(600.0).x);
    EXPECT_GT(sigma.weights(600.0).y, 0.33 * sigma.weights(600.0).x);
    EXPECT_EQ(sigma.weights(399.0).z, 0.0);
    EXPECT_GT(sigma.weights(401.0).z, 0.0);
}

}  // namespace lensproof::spectral::data_test
