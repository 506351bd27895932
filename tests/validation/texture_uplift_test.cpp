// Pictures as textures: their colours come back from the spectra.
#include <gtest/gtest.h>

#include <array>
#include <numeric>

#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "engine/scene/spectra/texture.h"
#include "engine/spectral/illuminant.h"
#include "engine/spectral/sensor_response.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::texture_uplift_test {

const spectral::RgbUplift& uplift() {
    static const spectral::RgbUplift table;
    return table;
}

spectral::SpectralGrid grid() {
    return spectral::spectral_grid(380.0, 780.0, 80);
}

/// Linear sRGB of a reflectance on the grid under D65, as a render of one stratum after the other sums it up.
Vec3d rgb_of(const std::vector<float>& reflectance) {
    static const spectral::Illuminant d65 = spectral::illuminant("D65");
    static const spectral::Exposure exposure;
    static const spectral::SensorResponse sensor = spectral::sensor_response("cie-1931", exposure, d65);
    static const std::vector<Vec3d> weights = spectral::stratum_weights(sensor, grid().strata, d65);
    static const spectral::Spectrum white =
        spectral::irradiance_of(d65, spectral::saturation_exposure_lx_s(exposure.iso) / exposure.time_s);
    Vec3d rgb;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double power = white(grid().strata.midpoint(static_cast<int>(i))) * grid().strata.width_nm();
        rgb = rgb + reflectance[i] * power * weights[i];
    }
    return rgb;
}

/// A texture's values at all wavelengths of the grid.
std::vector<float> spectrum_at(const scene::Texture& texture, const Vec2d& uv) {
    std::vector<float> values;
    for (int hero = 0; hero < grid().size(); ++hero) {
        values.push_back(scene::value_at(texture, uv, grid().path(hero))[0]);
    }
    return values;
}

constexpr std::array<Vec3d, 3> kColours{{{0.8, 0.3, 0.1}, {0.05, 0.4, 0.6}, {0.5, 0.5, 0.5}}};

/// The three colours beside each other.
formats::Image three_colours() {
    formats::Image image = formats::make_image(3, 1, {"R", "G", "B"});
    for (int x = 0; x < 3; ++x) {
        const Vec3d& rgb = kColours[static_cast<std::size_t>(x)];
        image.at(x, 0, 0) = static_cast<float>(rgb.x);
        image.at(x, 0, 1) = static_cast<float>(rgb.y);
        image.at(x, 0, 2) = static_cast<float>(rgb.z);
    }
    return image;
}

void expect_rgb(const Vec3d& rgb, const Vec3d& expected, double tolerance) {
    EXPECT_NEAR(rgb.x, expected.x, tolerance);
    EXPECT_NEAR(rgb.y, expected.y, tolerance);
    EXPECT_NEAR(rgb.z, expected.z, tolerance);
}

// From a file to spectra and back through a sensor: within 0.005, what the table's 0.5 ΔE*ab of such colours comes to;
// 5 nm strata to 780 nm add less than 0.001. Halfway between two pixels is the mean of their spectra and colours.
void pictures_colours_come_back() {
    const TestFolder folder;
    const auto file = folder.path() / "colours.exr";
    formats::write_exr(three_colours(), file);
    const scene::Texture texture = scene::reflectance_texture(file, scene::Wrap::clamp, grid(), uplift());
    for (std::size_t i = 0; i < 3; ++i) {
        expect_rgb(rgb_of(spectrum_at(texture, {(static_cast<double>(i) + 0.5) / 3.0, 0.5})), kColours[i], 0.006);
    }
    const std::vector<float> first = spectrum_at(texture, {0.5 / 3.0, 0.5});
    const std::vector<float> second = spectrum_at(texture, {1.5 / 3.0, 0.5});
    const std::vector<float> between = spectrum_at(texture, {1.0 / 3.0, 0.5});
    for (std::size_t i = 0; i < between.size(); ++i) {
        EXPECT_NEAR(between[i], 0.5 * (first[i] + second[i]), 0x1p-22);
    }
}

// A colour that a scene states by numbers is fitted exactly: only the strata are left, of which the white is exact.
void stated_colours_come_back() {
    for (const Vec3d& rgb : kColours) {
        expect_rgb(rgb_of(scene::rgb_reflectance(rgb, grid(), uplift()).value), rgb, 0.001);
    }
}

// Light of (1, 1, 1) is the white itself, to the 1e-4 and less that greys are off; of (40, 10, 2) that many times as
// much, its colour within the table's error, here 1 % of the largest.
void light_keeps_its_brightness_and_colour() {
    const spectral::Spectrum white = spectral::radiance_of(spectral::illuminant("D65"), 1000.0);
    const spectral::GridSpectrum means = spectral::stratum_means(white, grid());
    const auto lamp_of = [&](const std::vector<float>& rgb) {
        formats::Image image = formats::make_image(1, 1, {"R", "G", "B"});
        image.pixels = rgb;
        return spectrum_at(scene::emission_texture(image, "lamp.exr", {1, 1, scene::Wrap::repeat, scene::Wrap::clamp},
                                                   scene::kAsItIs, white, grid(), uplift()),
                           {0.3, 0.7});
    };
    const std::vector<float> same = lamp_of({1.0F, 1.0F, 1.0F});
    std::vector<float> shape = lamp_of({40.0F, 10.0F, 2.0F});
    for (std::size_t i = 0; i < shape.size(); ++i) {
        EXPECT_NEAR(same[i], means.value[i], 1e-4 * means.value[i]);
        shape[i] /= means.value[i];
    }
    expect_rgb(rgb_of(shape), {40.0, 10.0, 2.0}, 0.4);
}

void missing_and_colourless_pictures_are_named() {
    const TestFolder folder;
    const auto file = folder.path() / "text.png";
    write_file(file, "no picture");
    EXPECT_THROW(scene::reflectance_texture(file, scene::Wrap::repeat, grid(), uplift()), InputError);
    const std::string missing = complaint_about(
        [] { scene::reflectance_texture("no-such-picture.png", scene::Wrap::repeat, grid(), uplift()); });
    EXPECT_NE(missing.find("no-such-picture.png"), std::string::npos) << missing;
    for (const auto& channels : {std::vector<std::string>{"R", "G"}, {"S0.550,000000nm", "S0.600,000000nm"}}) {
        const std::string two = complaint_about([&] {
            scene::reflectance_texture(formats::make_image(2, 2, channels), "two.exr", {2, 2}, scene::kAsItIs, grid(),
                                       uplift());
        });
        EXPECT_NE(two.find("two.exr"), std::string::npos) << two;
        EXPECT_NE(two.find("expected R, G and B, or Y"), std::string::npos) << two;
    }
    EXPECT_THROW(
        scene::reflectance_texture(formats::make_image(0, 0, {"Y"}), "none.exr", {}, scene::kAsItIs, grid(), uplift()),
        InputError);
    EXPECT_NO_THROW(scene::reflectance_texture(formats::make_image(2, 2, {"Y"}), "grey.exr", {2, 2}, scene::kAsItIs,
                                               grid(), uplift()));
}

TEST(TextureUplift, TexturesAreTheirPictures) {
    pictures_colours_come_back();
    stated_colours_come_back();
    light_keeps_its_brightness_and_colour();
    missing_and_colourless_pictures_are_named();
}

}  // namespace lensproof::texture_uplift_test
