// From RGB to spectra and back, with the colours by another way than the fit's own sums.
#include "engine/spectral/rgb_uplift.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "engine/base/file.h"
#include "engine/base/infinity.h"
#include "engine/spectral/colour_matching.h"
#include "engine/spectral/illuminant.h"
#include "engine/spectral/sensor_response.h"
#include "tests/test_folder.h"

namespace lensproof::rgb_uplift_test {

const spectral::RgbUplift& uplift() {
    static const spectral::RgbUplift table;
    return table;
}

const spectral::Illuminant& d65() {
    static const spectral::Illuminant light = spectral::illuminant("D65");
    return light;
}

/// Linear sRGB of `shape` under D65, by the sensor that renders see by: exact integrals over 1 nm steps.
Vec3d rgb_of(const spectral::SigmoidSpectrum& shape) {
    static const spectral::Exposure exposure;
    static const spectral::SensorResponse sensor = spectral::sensor_response("cie-1931", exposure, d65());
    static const spectral::Spectrum white =
        spectral::irradiance_of(d65(), spectral::saturation_exposure_lx_s(exposure.iso) / exposure.time_s);
    spectral::Spectrum reflected;
    for (int wavelength_nm = 360; wavelength_nm <= 830; ++wavelength_nm) {
        reflected.wavelength_nm.push_back(wavelength_nm);
        reflected.value.push_back(white(wavelength_nm) * shape(wavelength_nm));
    }
    return sensor.values(reflected);
}

/// ΔE*ab under D65.
double difference(const Vec3d& a, const Vec3d& b) {
    static const Vec3d white = spectral::tristimulus(d65().relative, spectral::cie_1931());
    static const std::array<Vec3d, 3> primary = spectral::rec709_primaries(white);
    const auto lab = [&](const Vec3d& rgb) {
        return spectral::cielab(rgb.x * primary[0] + rgb.y * primary[1] + rgb.z * primary[2], white);
    };
    return length(lab(a) - lab(b));
}

std::vector<Vec3d> random_colours(int count) {
    std::mt19937_64 bits(1);
    const auto uniform = [&] { return static_cast<double>(bits() >> 11U) * 0x1p-53; };
    std::vector<Vec3d> colours;
    for (int i = 0; i < count; ++i) {
        Vec3d rgb{uniform(), uniform(), uniform()};
        // Half of them even in lightness rather than in light, so that dark ones are there.
        colours.push_back(i % 2 == 0 ? rgb : Vec3d{rgb.x * rgb.x, rgb.y * rgb.y, rgb.z * rgb.z});
    }
    return colours;
}

// What the header says of the table.
void table_gives_colours_back() {
    std::vector<double> differences;
    for (const Vec3d& rgb : random_colours(4000)) {
        differences.push_back(difference(rgb_of(uplift().reflectance(rgb)), rgb));
    }
    std::sort(differences.begin(), differences.end());
    EXPECT_LT(differences[differences.size() / 2], 0.05);
    EXPECT_LT(differences[differences.size() * 99 / 100], 0.5);
    EXPECT_LT(differences.back(), 2.0);
}

// A single colour's own fit comes back to 1e-3 of ΔE*ab (its numbers are floats), and to 0.01 in exact integrals: sums
// by parabolas through values 5 nm apart miss h³/60 of a reflectance's third derivative, which for sigmoids that rise
// within 30 nm is 1e-4 of it.
void single_colours_are_fitted() {
    const spectral::RgbOfReflectance colour = spectral::rgb_of_reflectance();
    for (const Vec3d& rgb : random_colours(400)) {
        const spectral::SigmoidSpectrum fitted = spectral::fitted_reflectance(uplift(), colour, rgb);
        const auto& [a, b, c] = fitted.coefficient;
        EXPECT_LT(spectral::missed_by(colour, rgb, {a, b, c}), 1e-3) << rgb.x << " " << rgb.y << " " << rgb.z;
        EXPECT_LT(difference(rgb_of(fitted), rgb), 0.01) << rgb.x << " " << rgb.y << " " << rgb.z;
    }
}

// A light's colour against its white is what was asked for, however bright: 2 ΔE*ab of the table at half of the
// largest channel are at most 3 % of that channel.
void lights_keep_their_colour() {
    for (const Vec3d& rgb : {Vec3d{1, 1, 1}, {12.0, 3.0, 0.5}, {0.001, 0.002, 0.004}, {0.0, 5e4, 0.0}}) {
        const spectral::UpliftedLight light = spectral::uplifted_light(uplift(), rgb);
        const Vec3d back = light.scale * rgb_of(light.shape);
        const double largest = std::max({rgb.x, rgb.y, rgb.z});
        EXPECT_NEAR(back.x, rgb.x, 0.03 * largest);
        EXPECT_NEAR(back.y, rgb.y, 0.03 * largest);
        EXPECT_NEAR(back.z, rgb.z, 0.03 * largest);
    }
    EXPECT_EQ(spectral::uplifted_light(uplift(), {0.0, -1.0, kNaN}).scale, 0.0);
    const spectral::UpliftedLight endless = spectral::uplifted_light(uplift(), {kInfinity, 0.0, 0.0});
    EXPECT_TRUE(std::isfinite(endless.scale));
}

TEST(RgbUplift, ColoursComeBack) {
    table_gives_colours_back();
    single_colours_are_fitted();
    lights_keep_their_colour();
}

// What reflects red, green and blue alike reflects all wavelengths alike: to a float's rounding of c, whose size near
// white and black is 50 and more, where the sigmoid is as flat.
void greys_are_constant() {
    for (const double grey : {1e-5, 1e-3, 0.04, 0.18, 0.5, 0.9, 0.999}) {
        const spectral::SigmoidSpectrum spectrum = uplift().reflectance({grey, grey, grey});
        for (const double wavelength_nm : {380.0, 450.0, 555.0, 700.0, 780.0}) {
            EXPECT_NEAR(spectrum(wavelength_nm), grey, 1e-4 * grey + 1e-6) << grey;
        }
    }
    for (const double wavelength_nm : {380.0, 555.0, 780.0}) {
        EXPECT_NEAR(uplift().reflectance({1.0, 1.0, 1.0})(wavelength_nm), 1.0, 1.1e-4);
        EXPECT_NEAR(uplift().reflectance({0.0, 0.0, 0.0})(wavelength_nm), 0.0, 1.1e-6);
    }
}

// The cube's corners and edges are reflectances too, whatever the wavelength, and so is what lies outside, taken to the
// nearest colour inside. The corners' colours come back within 0.05 of ΔE*ab: 1 − kBrightest is 0.005 of it, the rest
// sums in steps of 5 nm, for theirs are the steepest spectra.
void corners_are_reflectances() {
    for (const double r : {0.0, 1.0, -0.5, 3.0, kNaN, kInfinity, 1e-300}) {
        for (const double g : {0.0, 1.0, -kInfinity, kNaN}) {
            for (const double b : {0.0, 1.0, 1e-7}) {
                const spectral::SigmoidSpectrum spectrum = uplift().reflectance({r, g, b});
                for (double wavelength_nm = 300.0; wavelength_nm <= 1100.0; wavelength_nm += 10.0) {
                    const double reflectance = spectrum(wavelength_nm);
                    EXPECT_TRUE(reflectance >= 0.0 && reflectance <= 1.0) << r << " " << g << " " << b;
                }
            }
        }
    }
    for (const Vec3d& corner : {Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}}) {
        EXPECT_LT(difference(rgb_of(uplift().reflectance(corner)), corner), 0.05);
    }
    EXPECT_EQ(uplift().reflectance({2.0, -1.0, kNaN}).coefficient, uplift().reflectance({1.0, 0.0, 0.0}).coefficient);
}

// Beside a boundary between two of the table's parts, where the largest channel changes, colours do not jump.
void parts_meet() {
    for (const double level : {0.05, 0.4, 0.95}) {
        for (const double third : {0.0, 0.3, 0.9}) {
            const double nudge = 1e-9;
            const spectral::SigmoidSpectrum one = uplift().reflectance({level, level * (1.0 - nudge), third * level});
            const spectral::SigmoidSpectrum other = uplift().reflectance({level * (1.0 - nudge), level, third * level});
            // Each side comes from another part's entries, within the table's own error.
            EXPECT_LT(difference(rgb_of(one), rgb_of(other)), 2.0) << level << " " << third;
        }
    }
}

TEST(RgbUplift, CoversTheWholeCube) {
    greys_are_constant();
    corners_are_reflectances();
    parts_meet();
}

// From the cache comes the table that is made, to the last bit; a damaged one is made again, a whole one is read: with
// one number changed under its checksum, that number comes back.
TEST(RgbUplift, IsKept) {
    const TestFolder folder;
    const Cache cache(folder.path());
    const std::string made = spectral::kept_rgb_uplift(cache).serialized();
    ASSERT_TRUE(spectral::RgbUplift::deserialized(made));
    EXPECT_EQ(spectral::RgbUplift::deserialized(made)->serialized(), made);
    EXPECT_FALSE(spectral::RgbUplift::deserialized(""));
    EXPECT_FALSE(spectral::RgbUplift::deserialized(made.substr(1)));
    EXPECT_FALSE(spectral::RgbUplift::deserialized(made + "x"));
    EXPECT_FALSE(spectral::RgbUplift::deserialized(std::string(made.size(), '\xff'))) << "NaNs";

    EXPECT_EQ(spectral::kept_rgb_uplift(cache).serialized(), made);
    const std::filesystem::path file = std::filesystem::directory_iterator(folder.path())->path();
    const std::string whole = read_file(file);
    const std::size_t at = whole.find(made);
    ASSERT_NE(at, std::string::npos);
    const std::string kind = "rgb-uplift";
    const std::size_t key_at = whole.find(kind) + kind.size() + sizeof(std::uint64_t);
    const std::string key = whole.substr(key_at, at - key_at);
    std::string changed = made;
    changed.replace(0, 4, 4, '\0');
    cache.store(kind, key, changed);
    EXPECT_EQ(spectral::kept_rgb_uplift(cache).serialized(), changed) << "read from the cache";
    cache.store(kind, key, "no table");
    EXPECT_EQ(spectral::kept_rgb_uplift(cache).serialized(), made) << "made again";
}

}  // namespace lensproof::rgb_uplift_test
