// tests/cli/measure_lines_test.cpp — distortion from straight things, without a chart.
#include <gtest/gtest.h>

#include "tests/calibration/lines/line_pictures.h"
#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::measure_lines_test {

using namespace calibration;
using namespace calibration::synthetic;
using Json = nlohmann::json;

BrownConrady lens() {
    return {{410.0, 161.5, 118.5, -0.3, 0.12, 0.0, 0.0, 0.0}};
}

void write_rectangles(const Workplace& place, const std::string& name, int count, unsigned seed) {
    static const PixelRays rays = pixel_rays(lens(), 320, 240, 4);
    formats::write_png_16(picture_of(rays, random_rectangles(count, 0.4, 0.3, seed), 0.004, seed), place.path() / name);
}

TEST(MeasureLines, TellDistortionAndAreDrawn) {
    const Workplace place;
    std::vector<std::string> arguments = {"measure"};
    for (unsigned seed = 1; seed <= 3; ++seed) {
        arguments.push_back("photo" + std::to_string(seed) + ".png");
        write_rectangles(place, arguments.back(), 10, seed);
    }
    arguments.insert(arguments.end(), {"--lines", "-o", "profile.json", "--plots", "plots"});
    const Outcome outcome = place.run(arguments);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(says(outcome.out, "straight lines, rms"));
    EXPECT_TRUE(says(outcome.out, "warning: what is not straight in the world"));
    EXPECT_TRUE(says(outcome.out, "3 of 3 pictures used"));
    EXPECT_TRUE(says(outcome.out, "geometry not measured: straight lines tell the distortion"));
    const Json profile = Json::parse(place.content("profile.json"));
    EXPECT_GE(profile["scene_lines"].size(), 20U);
    EXPECT_EQ(profile["scene_lines"][0]["points_px"].size(), profile["scene_lines"][0]["residual_px"].size());
    const Json& curve = profile["curves"]["distortion_percent"];
    const std::size_t at = 24;  // image height 0.6
    EXPECT_DOUBLE_EQ(curve["image_height"][at], 0.6);
    const double truth = true_distortion_percent(lens(), 0.6 * 200.0);
    EXPECT_NEAR(curve["value"][at].get<double>(), truth, 0.5);
    EXPECT_TRUE(profile["terms"]["line_distortion"]["parameters"].contains("centre_x_px"));
    EXPECT_TRUE(says(place.content("plots/lines_photo1.png.svg"), "straight lines (blue)"));
    EXPECT_TRUE(says(place.content("plots/distortion.svg"), "Image height"));
    // A profile like any other: it can be held against another, or against itself, which 0.22 % of uncertainty allow.
    const Outcome same = place.run({"compare", "profile.json", "profile.json", "--distortion-limit", "1"});
    EXPECT_EQ(same.status, 0) << same.out << same.err;
}

TEST(MeasureLines, SayWhatIsMissing) {
    const Workplace place;
    write_rectangles(place, "one.png", 1, 3);
    const auto refused = [&](std::vector<std::string> arguments, const std::string& words) {
        arguments.insert(arguments.begin(), "measure");
        arguments.insert(arguments.end(), {"-o", "out.json"});
        const Outcome outcome = place.run(arguments);
        EXPECT_EQ(outcome.status, 2) << outcome.out;
        EXPECT_TRUE(says(outcome.err, words)) << outcome.err;
        EXPECT_FALSE(place.has("out.json"));
    };
    refused({"one.png", "--lines"}, "long edges found, expected at least 6 that are straight in the world");
    refused({"one.png", "--lines", "--fix-centre"}, "--fix-centre: given with --lines");
    refused({"one.png", "--lines", "--edge", "auto"}, "--edge: given with --lines");
    refused({"one.png"}, "--lines for distortion");
    formats::write_png(formats::make_image(64, 48, {"Y"}), place.path() / "blank.png");
    refused({"blank.png", "--lines"}, "no long edge found in any of 1 picture");
}

}  // namespace lensproof::measure_lines_test
