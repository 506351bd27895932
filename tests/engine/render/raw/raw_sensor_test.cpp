// tests/engine/render/raw/raw_sensor_test.cpp — what a [sensor] table may say, where a mosaic's colours stand, how raws
// develop.
#include "engine/render/raw/raw_sensor.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "engine/base/input_error.h"
#include "engine/spectral/illuminant.h"
#include "tests/complaint.h"

namespace lensproof::render::raw_sensor_test {

constexpr std::array<const char*, 4> kPatterns = {"RGGB", "BGGR", "GRBG", "GBRG"};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

RawCamera camera(const std::string& response = "camera", double iso = 100.0) {
    return {.response = response, .exposure = {.time_s = 0.01, .iso = iso}, .white = "D65", .width = 24, .height = 16};
}

const std::string kTable = "pattern = \"RGGB\"\nfull_well_electrons = 30000\nread_noise_electrons = 4\nbits = 14\n";

RawSensor read(const std::string& text, const RawCamera& behind = camera()) {
    TomlTable table = TomlTable::parse(text, "scene.toml");
    return read_raw_sensor(table, behind);
}

std::string complaint(const std::string& text, const RawCamera& behind = camera()) {
    return complaint_about([&] { read(text, behind); });
}

/// A film whose channels are what `value` says.
formats::Image film(int width, int height, const std::function<double(int x, int y, int channel)>& value) {
    formats::Image image = formats::make_image(width, height, {"R", "G", "B"});
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int channel = 0; channel < 3; ++channel) {
                image.at(x, y, channel) = static_cast<float>(value(x, y, channel));
            }
        }
    }
    return image;
}

/// A mosaic without noise: at (x, y) what `value` says of the colour that stands there, in the letters of the pattern.
RawImage noiseless(const std::string& pattern, int width, int height,
                   const std::function<double(int x, int y, char colour)>& value) {
    RawImage raw{.mosaic = {.width = width, .height = height},
                 .pattern = pattern,
                 .bits = 14,
                 .black_level = 512,
                 .white_level = 16383};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const char colour = y % 2 == 0 ? pattern.at(x % 2) : pattern.at(2 + x % 2);
            raw.mosaic.values.push_back(static_cast<std::uint16_t>(std::lround(512.0 + 15871.0 * value(x, y, colour))));
        }
    }
    return raw;
}

TEST(RawSensor, ReadsItsTable) {
    const RawSensor sensor = read(kTable +
                                  "black_level = 100\nwhite_level = 16000\nbase_iso = 50\nfill_factor = 0.6\n"
                                  "dark_current_electrons_per_s = 2.5\nneutral = [0.5, 1, 0.75]\n"
                                  "demosaicing = \"edge-aware\"\n");
    EXPECT_EQ(sensor.pattern, "RGGB");
    EXPECT_EQ(sensor.black_level_dn, 100);
    EXPECT_EQ(sensor.white_level_dn, 16000);
    EXPECT_EQ(sensor.neutral, (Vec3d{0.5, 1.0, 0.75}));
    EXPECT_EQ(sensor.demosaicing, Demosaicing::edge_aware);
    // ISO 12232: from base ISO 50 to ISO 100 saturation takes half the light, so half the electrons of a full well.
    EXPECT_DOUBLE_EQ(electrons_at_saturation(sensor), 15000.0);
    EXPECT_DOUBLE_EQ(dn_per_electron(sensor), 15900.0 / 15000.0);
    EXPECT_EQ(read(kTable).black_level_dn, 512);
    EXPECT_EQ(read(kTable).white_level_dn, 16383);
}

TEST(RawSensor, IsTheSameFromItsText) {
    const RawSensor sensor = read(kTable + "fill_factor = 0.3\ndark_current_electrons_per_s = 1e6\nbase_iso = 33.3\n");
    const std::string text = raw_sensor_text(sensor);
    EXPECT_EQ(raw_sensor_text(parse_raw_sensor(text, "film.exr")), text);
    EXPECT_EQ(parse_raw_sensor(text, "film.exr").neutral, sensor.neutral);
    const RawSensor grey = read("pattern = \"none\"" + kTable.substr(kTable.find('\n')), camera("luminance"));
    EXPECT_EQ(parse_raw_sensor(raw_sensor_text(grey), "film.exr").channels, 1);
    EXPECT_THROW(parse_raw_sensor("response = 3", "film.exr"), InputError);
}

TEST(RawSensor, NamesWhatItCannotUse) {
    const std::string none = "pattern = \"none\"" + kTable.substr(kTable.find('\n'));
    const auto expect = [](const std::string& said, const std::string& line, const std::string& key) {
        EXPECT_EQ(said.find("scene.toml:" + line), 0U) << said;
        EXPECT_NE(said.find(key), std::string::npos) << said;
        EXPECT_NE(said.find("xpected"), std::string::npos) << said;
    };
    expect(complaint("pattern = \"RGBG\"\n"), "1", "pattern");
    EXPECT_EQ(complaint("pattern = \"RGGB\"\n"), "scene.toml:1: full_well_electrons: is missing");
    expect(complaint("pattern = \"RGGB\"\nfull_well_electrons = 0\n"), "2", "full_well_electrons");
    expect(complaint("pattern = \"RGGB\"\nfull_well_electrons = 9\nread_noise_electrons = -1\n"), "3", "read_noise");
    for (const char* line :
         {"black_level = 16383", "white_level = 512", "white_level = 16384", "black_level = -1", "fill_factor = 0",
          "fill_factor = 1.1", "fill_factor = nan", "base_iso = 200", "dark_current_electrons_per_s = -1",
          "neutral = [0.5, 0.9, 0.7]", "neutral = [0, 1, 1]", "demosaicing = \"best\""}) {
        const std::string text = line;
        expect(complaint(kTable + text + "\n"), "5", text.substr(0, text.find(' ')));
    }
    EXPECT_NE(complaint(kTable + "full_wel = 3\n").find("full_wel"), std::string::npos);
    expect(complaint(kTable, camera("luminance")), "1", "has one channel");
    expect(complaint(none + "neutral = [1, 1, 1]\n", camera("luminance")), "5", "has one channel");
    expect(complaint(kTable, camera("camera", 1e9)), "2", "full_well_electrons");
    RawCamera thin = camera();
    thin.width = 1;
    expect(complaint(kTable, thin), "1", "1 × 16 pixels");
    EXPECT_EQ(complaint(none, camera("luminance")), "");
}

// The colours stand where the pattern's letters say: light of one colour alone fills those pixels and no others. 10⁹
// electrons have a noise of 3e-5, half a step of 14 bits.
TEST(RawSensor, FillsThePixelsOfTheLightsColour) {
    for (const std::string pattern : kPatterns) {
        const RawSensor sensor = read("pattern = \"" + pattern +
                                      "\"\nfull_well_electrons = 1e9\nread_noise_electrons = 0\nbits = 14\n"
                                      "neutral = [1, 1, 1]\n");
        for (int lit = 0; lit < 3; ++lit) {
            const formats::Image light =
                film(6, 4, [lit](int, int, int channel) { return channel == lit ? 0.5 : 0.0; });
            const RawImage raw = expose(sensor, light, 1);
            for (int y = 0; y < 4; ++y) {
                for (int x = 0; x < 6; ++x) {
                    const bool is_lit = pattern[2 * (y % 2) + x % 2] == "RGB"[lit];
                    EXPECT_NEAR(raw.mosaic.values[6 * y + x], is_lit ? 512.0 + 0.5 * 15871.0 : 512.0, 3.0)
                        << pattern << " " << lit << " " << x << " " << y;
                }
            }
        }
    }
}

// Every colour of a flat field is found again at every pixel, those of the rim included, whatever the size. A raw value
// is rounded to half a step in 15871; a mean of such is no farther off, and rounded again in 16 bits: 0.65 steps at
// most.
TEST(RawImage, DevelopsAFlatColourToThatColour) {
    constexpr double kSteps = 0.65 / 15871.0;
    for (const std::string pattern : kPatterns) {
        for (const Demosaicing method : {Demosaicing::bilinear, Demosaicing::edge_aware}) {
            for (const auto& [width, height] : {std::pair{2, 2}, {3, 2}, {2, 5}, {9, 7}, {16, 16}}) {
                RawImage raw = noiseless(pattern, width, height, [](int, int, char colour) {
                    return colour == 'R' ? 0.4 : colour == 'G' ? 0.7 : 0.06;
                });
                raw.neutral = {0.5, 1.0, 0.8};
                raw.demosaicing = method;
                const formats::Image image = develop(raw);
                for (int y = 0; y < height; ++y) {
                    for (int x = 0; x < width; ++x) {
                        ASSERT_NEAR(image.at(x, y, 0), 0.4 / 0.5, kSteps / 0.5) << pattern << " " << x << " " << y;
                        ASSERT_NEAR(image.at(x, y, 1), 0.7, kSteps) << pattern << " " << x << " " << y;
                        ASSERT_NEAR(image.at(x, y, 2), 0.06 / 0.8, kSteps / 0.8) << pattern << " " << x << " " << y;
                    }
                }
            }
        }
    }
}

// Means of neighbours that lie evenly about a pixel give a slope back, unmoved: a colour that stood half a pixel off
// would be off by half a slope, 40 steps. The outermost pixels are means across the mirror.
TEST(RawImage, DevelopsASlopeUnmoved) {
    const auto slope = [](int x, int y, char colour) {
        return colour == 'R'   ? 0.1 + 0.005 * x + 0.008 * y
               : colour == 'G' ? 0.9 - 0.01 * x + 0.002 * y
                               : 0.5 - 0.02 * y;
    };
    for (const std::string pattern : kPatterns) {
        for (const Demosaicing method : {Demosaicing::bilinear, Demosaicing::edge_aware}) {
            RawImage raw = noiseless(pattern, 31, 22, slope);
            raw.demosaicing = method;
            const formats::Image image = develop(raw);
            for (int y = 1; y < 21; ++y) {
                for (int x = 1; x < 30; ++x) {
                    for (int channel = 0; channel < 3; ++channel) {
                        ASSERT_NEAR(image.at(x, y, channel), slope(x, y, "RGB"[channel]), 1.15 / 15871.0)
                            << pattern << " " << x << " " << y << " " << channel;
                    }
                }
            }
        }
    }
}

// An edge with a Gaussian blur of σ = 1.5 px holds 2e-5 of its contrast where colours that stand 2 px apart begin to
// alias, so that its place, the centroid of its slope, comes through demosaicing: 24 rounded values against a contrast
// of 12697 steps move it by up to 24 · 0.65 / 12697 = 1.2e-3 px.
TEST(RawImage, KeepsEdgesInTheirPlaces) {
    for (const std::string pattern : kPatterns) {
        for (const double place : {11.0, 11.3, 11.5, 12.25}) {
            const auto edge = [place](int at) {
                return 0.1 + 0.4 * std::erfc((place - at) / (1.5 * std::numbers::sqrt2));
            };
            const formats::Image upright =
                develop(noiseless(pattern, 24, 24, [&edge](int x, int, char) { return edge(x); }));
            const formats::Image lying =
                develop(noiseless(pattern, 24, 24, [&edge](int, int y, char) { return edge(y); }));
            for (int channel = 0; channel < 3; ++channel) {
                for (const int line : {10, 11}) {
                    double across = 0.0;
                    double down = 0.0;
                    for (int i = 1; i < 22; ++i) {
                        across += (i + 0.5) * (upright.at(i + 1, line, channel) - upright.at(i, line, channel));
                        down += (i + 0.5) * (lying.at(line, i + 1, channel) - lying.at(line, i, channel));
                    }
                    EXPECT_NEAR(across / 0.8, place, 1.3e-3) << pattern << " " << line << " " << channel;
                    EXPECT_NEAR(down / 0.8, place, 1.3e-3) << pattern << " " << line << " " << channel;
                }
            }
        }
    }
}

// Light that is no number, or less than none, is dark; any amount more than saturates is white.
TEST(RawSensor, BearsAnyLight) {
    const RawSensor sensor = read(kTable + "neutral = [1, 1, 1]\ndark_current_electrons_per_s = 1e9\n");
    RawSensor dark = read(kTable);
    dark.read_noise_electrons = 0.0;
    for (const double light : {kNaN, -kInfinity, -1.0, 0.0}) {
        for (const std::uint16_t value :
             expose(dark, film(4, 4, [light](int, int, int) { return light; }), 3).mosaic.values) {
            EXPECT_EQ(value, 512) << light;
        }
    }
    for (const double light : {0.0, 2.0, 1e6, 1e30, kInfinity}) {
        for (const std::uint16_t value :
             expose(sensor, film(4, 4, [light](int, int, int) { return light; }), 3).mosaic.values) {
            EXPECT_EQ(value, 16383) << light << ", with 10⁷ electrons of dark current";
        }
    }
}

TEST(RawSensor, HasTheSameNoiseOnAnyNumberOfThreads) {
    const RawSensor sensor = read(kTable);
    const formats::Image light = film(40, 30, [](int x, int y, int) { return 0.02 * x + 0.001 * y; });
    const std::vector<std::uint16_t> one = expose(sensor, light, 7, 1).mosaic.values;
    EXPECT_EQ(expose(sensor, light, 7, 5).mosaic.values, one);
    EXPECT_EQ(expose(sensor, light, 7, 0).mosaic.values, one);
    EXPECT_NE(expose(sensor, light, 8, 1).mosaic.values, one);
    // A pixel's noise is its own: rows further down change nothing above them.
    const formats::Image less = film(40, 10, [](int x, int y, int) { return 0.02 * x + 0.001 * y; });
    const std::vector<std::uint16_t> part = expose(sensor, less, 7, 1).mosaic.values;
    EXPECT_TRUE(std::equal(part.begin(), part.end(), one.begin()));
}

// White light saturates the most sensitive channel alone; developed, it is white. With each of the responses whose
// channels are measured, and for any white. 10⁹ electrons, 16 bits: noise 3e-5, of 600 values the largest at 4 σ.
TEST(RawSensor, DevelopsWhiteToWhite) {
    for (const char* response : {"camera", "camera-sigma-sd1-merrill", "cie-1931"}) {
        for (const char* white : {"D65", "A"}) {
            RawCamera behind = camera(response);
            behind.white = white;
            const RawSensor sensor =
                read("pattern = \"GRBG\"\nfull_well_electrons = 1e9\nread_noise_electrons = 0\nbits = 16\n", behind);
            const spectral::SensorResponse sees =
                spectral::sensor_response(response, behind.exposure, spectral::illuminant(white));
            const Vec3d saturating =
                sees.values(spectral::irradiance_of(spectral::illuminant(white), 0.9 * 78.0 / 100.0 / 0.01));
            const std::array<double, 3> light = {saturating.x, saturating.y, saturating.z};
            const RawImage raw = expose(sensor, film(20, 10, [&](int, int, int channel) { return light[channel]; }), 1);
            for (const float value : develop(raw).pixels) {
                // The dimmest channel, red in daylight, has the most noise: 1/√(0.9 · 0.2 · 1e9), and steps of
                // 0.5/63487/0.2
                ASSERT_NEAR(value, 0.9, 5e-4) << response << " " << white;
            }
        }
    }
}

// Each channel's neutral is what the data say: the integral of light times sensitivity, over the largest. A flat
// spectrum from 400 to 700 nm against the camera's columns, summed here by the trapezium rule of their 5 nm steps.
TEST(RawSensor, NeutralIsWhatTheResponseMakesOfWhite) {
    const spectral::Illuminant equal = spectral::illuminant("E");
    const Vec3d neutral = spectral::sensor_neutral("camera", equal);
    const std::vector<spectral::Spectrum> columns =
        spectral::read_spectra(spectral::spectral_data("camera-nikon-d5100.csv"), {"red", "green", "blue"});
    std::array<double, 3> sum{};
    for (int channel = 0; channel < 3; ++channel) {
        for (int nm = 380; nm < 780; nm += 5) {
            sum[channel] += 2.5 * (columns[channel](nm) + columns[channel](nm + 5));
        }
    }
    EXPECT_NEAR(neutral.x, sum[0] / sum[1], 1e-12);
    EXPECT_EQ(neutral.y, 1.0);
    EXPECT_NEAR(neutral.z, sum[2] / sum[1], 1e-12);
    EXPECT_LT(spectral::sensor_neutral("camera", spectral::illuminant("A")).z, neutral.z)
        << "incandescent light has little blue";
    EXPECT_EQ(spectral::sensor_neutral("cie-1931", equal), (Vec3d{1.0, 1.0, 1.0}));
    EXPECT_EQ(spectral::sensor_neutral("luminance", equal), (Vec3d{1.0, 0.0, 0.0}));
}

// Behind no filter each pixel measures what there is: one value, or one a channel; nothing is made up.
TEST(RawSensor, MeasuresEveryChannelWithoutAPattern) {
    const std::string table = "pattern = \"none\"\nfull_well_electrons = 1e9\nread_noise_electrons = 0\nbits = 14\n";
    const formats::Image light =
        film(5, 3, [](int x, int y, int channel) { return 0.1 + 0.05 * x + 0.1 * y + 0.02 * channel; });
    const RawImage grey = expose(read(table, camera("luminance")), light, 1);
    const RawImage stack = expose(read(table + "neutral = [1, 1, 1]\n"), light, 1);
    EXPECT_EQ(grey.mosaic.channels, 1);
    EXPECT_EQ(stack.mosaic.channels, 3);
    EXPECT_EQ(develop(grey).channels, std::vector<std::string>{"Y"});
    for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 5; ++x) {
            EXPECT_NEAR(develop(grey).at(x, y, 0), light.at(x, y, 0), 3.0 / 15871.0);
            for (int channel = 0; channel < 3; ++channel) {
                EXPECT_NEAR(develop(stack).at(x, y, channel), light.at(x, y, channel), 3.0 / 15871.0);
            }
        }
    }
}

// The MTF of a square of side s px is sinc(s f). Offsets drawn from 4096 even strata: the midpoint rule, 1e-7.
TEST(RawSensor, FillFactorIsTheSquareRootOfTheSideOfWhatAPixelSees) {
    for (const double fraction : {0.25, 0.5, 0.81, 1.0}) {
        RawSensor sensor = read(kTable);
        sensor.fill_factor = fraction;
        const PixelFilter filter = pixel_aperture(sensor);
        const double side = std::sqrt(fraction);
        EXPECT_DOUBLE_EQ(2.0 * filter.radius_px(), side);
        EXPECT_EQ(filter.is_box(), fraction == 1.0);
        EXPECT_NEAR(filter(0.49 * side), 1.0 / side, 1e-12);
        EXPECT_EQ(filter(0.51 * side), 0.0);
        for (const double cycles_per_px : {0.1, 0.5, 1.0}) {
            double mean = 0.0;
            for (int i = 0; i < 4096; ++i) {
                const PixelFilter::Draw draw = filter.draw((i + 0.5) / 4096.0);
                mean += draw.weight * std::cos(2.0 * std::numbers::pi * cycles_per_px * draw.offset_px) / 4096.0;
            }
            const double phase = std::numbers::pi * side * cycles_per_px;
            EXPECT_NEAR(mean, std::sin(phase) / phase, 1e-6) << fraction << " " << cycles_per_px;
        }
    }
}

}  // namespace lensproof::render::raw_sensor_test
