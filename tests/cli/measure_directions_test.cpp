// tests/cli/measure_directions_test.cpp — a camera from a photo of stars.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/base/write_file.h"
#include "tests/calibration/geometry/starry_view.h"
#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::measure_directions_test {

using namespace calibration;
using namespace calibration::synthetic;
using Json = nlohmann::json;

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr double kRedLarger = 8e-4;

BrownConrady lens() {
    return {{510.0, 322.0, 236.5, -0.21, 0.06, 0.0, 0.0, 0.0}};
}

void add_star(formats::Image& image, int channel, const Vec2d& at, double light) {
    constexpr double kSigma_px = 1.1;
    for (int y = static_cast<int>(at.y) - 7; y <= static_cast<int>(at.y) + 8; ++y) {
        for (int x = static_cast<int>(at.x) - 7; x <= static_cast<int>(at.x) + 8; ++x) {
            if (x >= 0 && y >= 0 && x < image.width && y < image.height) {
                const Vec2d d{x - at.x, y - at.y};
                image.at(x, y, channel) +=
                    static_cast<float>(light * std::exp(-0.5 * dot(d, d) / kSigma_px / kSigma_px));
            }
        }
    }
}

/// A photo of stars, of which red images each a little farther out, and the table of where they are about.
std::string write_night(const Workplace& place, const std::string& name, unsigned seed, double lost = 0.0,
                        int placed = 70) {
    const ChartView stars = starry_view(lens(), {.rotation_rad = {0.3, 1.0 + 0.1 * seed, -0.4}, .translation_mm = {}},
                                        kWidth, kHeight, 70, seed);
    formats::Image image = formats::make_image(kWidth, kHeight, {"R", "G", "B"});
    std::ranges::fill(image.pixels, 0.01F);
    const Vec2d centre = centre_px(lens());
    Chance chance(seed);
    std::string rows;
    for (std::size_t i = 0; i < stars.image_px.size(); ++i) {
        const Vec2d& at = stars.image_px[i];
        const double light = chance() < lost ? 0.0 : chance(0.1, 0.8);
        for (int channel = 0; channel < 3; ++channel) {
            add_star(image, channel, channel == 0 ? at + kRedLarger * (at - centre) : at, light);
        }
        const Vec2d near = at + Vec2d{chance(-3.0, 3.0), chance(-3.0, 3.0)};
        const bool is_placed = placed > 0 && (placed == 70 || length(at - centre) < 200.0);
        placed -= is_placed && placed < 70 ? 1 : 0;
        rows += fmt::format("{},{},{},{},{}\n", name, is_placed ? fmt::format("{:.0f},{:.0f}", near.x, near.y) : ",",
                            stars.directions[i].x, stars.directions[i].y, stars.directions[i].z);
    }
    add_noise(image, 0.001, seed);
    formats::write_png_16(image, place.path() / name);
    return rows;
}

TEST(MeasureDirections, StarsTellTheCamera) {
    const Workplace place;
    std::string table = "picture,x_px,y_px,dx,dy,dz\n";
    table += write_night(place, "one.png", 1) + write_night(place, "two.png", 2);
    write_file(place.path() / "stars.csv", table);
    const Outcome outcome = place.run({"measure", "one.png", "two.png", "--directions", "stars.csv", "--model",
                                       "brown-conrady", "-o", "profile.json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(says(outcome.out, "2 of 2 pictures used"));
    EXPECT_TRUE(says(outcome.out, "self_test not measured: no picture shows a chart that could be simulated"));
    const Json profile = Json::parse(place.content("profile.json"));
    const Json& model = profile["model"]["parameters"];
    const std::vector<double> truth = parameters(CameraModel(lens()));
    const std::vector<std::string> names = parameter_names(lens());
    for (std::size_t i = 0; i < 5; ++i) {
        const Json& parameter = model[names[i]];
        EXPECT_GT(parameter["standard_error"], 0.0);
        EXPECT_NEAR(parameter["value"].get<double>(), truth[i], 4.0 * parameter["standard_error"].get<double>())
            << names[i];
    }
    EXPECT_LT(model["focal_length_px"]["standard_error"], 0.05);
    const Json& point = profile["views"][0]["points"][0];
    EXPECT_EQ(point["direction"].size(), 3U);
    EXPECT_FALSE(point.contains("chart_mm"));
    const Json& curve = profile["curves"]["chromatic_shift_R_px"];
    const std::size_t at = 24;  // image height 0.6
    ASSERT_NEAR(curve["image_height"][at].get<double>(), 0.6, 1e-9);
    EXPECT_NEAR(curve["value"][at].get<double>(), kRedLarger * 0.6 * profile["half_diagonal_px"].get<double>(), 0.02);
    // As any other profile it is read again, compared and exported.
    EXPECT_EQ(place.run({"compare", "profile.json", "profile.json"}).status, 0);
    EXPECT_EQ(place.run({"export", "profile.json", "--to", "opencv", "-o", "camera.yaml"}).status, 0);
}

// Six stars near the middle tell where the others are to be looked for, farther out with each fit.
TEST(MeasureDirections, SomePlacedOnesFindTheOthers) {
    const Workplace place;
    const std::string rows = write_night(place, "one.png", 5, 0.0, 6);
    write_file(place.path() / "stars.csv", "picture,x_px,y_px,dx,dy,dz\n" + rows + ",,,0,1,0\n");
    const Outcome outcome = place.run(
        {"measure", "one.png", "--directions", "stars.csv", "--model", "brown-conrady", "-o", "profile.json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Json profile = Json::parse(place.content("profile.json"));
    EXPECT_GE(profile["points_used"], 60) << outcome.out;
    EXPECT_LT(profile["reprojection_rms_px"], 0.15);
    const Json& focal = profile["model"]["parameters"]["focal_length_px"];
    EXPECT_NEAR(focal["value"].get<double>(), 510.0, 4.0 * focal["standard_error"].get<double>());
}

/// Sixty lamps 1 km before a double Gauss at f/16, and the table of a third of their places.
std::string write_sky(const Workplace& place) {
    std::string scene = R"([camera]
lens = "double-gauss-tronnier"
f_number = 16.0
focus_distance_mm = 1.0e7
position_mm = [0.0, 0.0, 0.0]
look_at_mm = [0.0, 0.0, 1000.0]
sensor_mm = [36.0, 24.0]
pixels = [900, 600]
shutter_s = 1.0
iso = 100.0
response = "camera"
[render]
layers = 8
strata_per_layer = 1
max_bounces = 0
)";
    std::string table = "x_px,y_px,dx,dy,dz\n";
    Chance chance(3);
    constexpr double kFocal_mm = 50.0;
    constexpr double kPixels_per_mm = 25.0;
    for (int i = 0; i < 60; ++i) {
        const Vec2d on_film{chance(-17.0, 17.0), chance(-11.0, 11.0)};
        const Vec3d direction = normalized(Vec3d{on_film.x / kFocal_mm, on_film.y / kFocal_mm, 1.0});
        const Vec3d at = 1e6 * direction;
        scene += fmt::format(
            "[[lights]]\nkind = \"sphere\"\nposition_mm = [{}, {}, {}]\nradius_mm = 60.0\n"
            "luminance_cd_m2 = 1e7\n",
            at.x, at.y, at.z);
        const bool is_placed = length(on_film) < 10.0;  // where distortion is less than the reach of 8 px
        const std::string near = is_placed ? fmt::format("{:.1f},{:.1f}", 449.5 - kPixels_per_mm * on_film.x,
                                                         299.5 - kPixels_per_mm * on_film.y)
                                           : ",";
        table += fmt::format("{},{},{},{}\n", near, direction.x, direction.y, direction.z);
    }
    place.file("sky.toml", scene);
    return table;
}

// Light paths through the lens's surfaces to a picture, its spots to a camera, and that beside the lens's own chief
// rays: 0.020 ± 0.015 px, 0.004 ± 0.016 % and 0.0011 ± 0.0005 px of colour were found, and three errors more are let
// pass. Another double Gauss of 50 mm does not.
TEST(MeasureDirections, LampsThroughALensTellTheLens) {
    const Workplace place;
    write_file(place.path() / "sky.csv", write_sky(place));
    ASSERT_EQ(
        place.run({"render", "sky.toml", "--paths", "light", "--spp", "4", "--filter", "gaussian", "-o", "sky.exr"})
            .status,
        0);
    const Outcome outcome = place.run({"measure", "sky.exr", "--directions", "sky.csv", "--kind", "render",
                                       "--pixel-pitch", "40", "--model", "brown-conrady", "-o", "profile.json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto compared_with = [&](const std::string& lens) {
        return place.run({"compare", lens, "profile.json", "--f-number", "16", "--position-limit", "0.065",
                          "--distortion-limit", "0.052", "--chromatic-limit", "0.0026"});
    };
    const Outcome own = compared_with("double-gauss-tronnier");
    EXPECT_EQ(own.status, 0) << own.out << own.err;
    EXPECT_EQ(compared_with("double-gauss-angenieux").status, 1);
}

// The summer triangle and its neighbours through a camera of 1000 px: north is up, and so east, to which right
// ascension grows, left. All of them lie in a strip of the frame, which the profile says.
TEST(MeasureDirections, TheSkyIsNotMirrored) {
    const Workplace place;
    struct Star {
        double right_ascension_deg, declination_deg;
        Vec2d at_px;
    };
    const Star stars[] = {{279.235, 38.784, {985.42, 286.86}}, {310.358, 45.280, {562.97, 170.93}},
                          {297.696, 8.868, {718.54, 846.33}},  {292.680, 27.960, {800.72, 499.50}},
                          {305.557, 40.257, {618.59, 275.01}}, {284.736, 32.690, {916.85, 408.52}},
                          {296.565, 10.613, {739.34, 812.62}}};
    formats::Image image = formats::make_image(1500, 1000, {"Y"});
    std::ranges::fill(image.pixels, 0.01F);
    std::string table = "x_px,y_px,right_ascension_deg,declination_deg\n";
    for (const Star& star : stars) {
        add_star(image, 0, star.at_px, 0.5);
        table += fmt::format("{:.0f},{:.0f},{},{}\n", star.at_px.x, star.at_px.y, star.right_ascension_deg,
                             star.declination_deg);
    }
    formats::write_png_16(image, place.path() / "night.png");
    write_file(place.path() / "stars.csv", table);
    const Outcome outcome =
        place.run({"measure", "night.png", "--directions", "stars.csv", "--model", "brown-conrady", "--fix-centre"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(says(outcome.out, "7 points in 1 views"));
    EXPECT_TRUE(says(outcome.out, "px at worst; add directions that are seen in the corners"));
}

TEST(MeasureDirections, WhatIsNotSeenIsSaid) {
    const Workplace place;
    write_file(place.path() / "stars.csv", "picture,x_px,y_px,dx,dy,dz\n" + write_night(place, "one.png", 3, 0.2));
    const Outcome outcome = place.run({"measure", "one.png", "--directions", "stars.csv", "--model", "brown-conrady"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(says(outcome.out, " of 70 directions show no light within 8 px of where they are said to be"));
}

TEST(MeasureDirections, UnusableOnesAreRefused) {
    const Workplace place;
    const std::string rows = write_night(place, "one.png", 4);
    write_file(place.path() / "stars.csv", "picture,x_px,y_px,dx,dy,dz\n" + rows);
    const auto refused = [&](const std::string& picture, const std::vector<std::string>& options,
                             const std::string& words) {
        std::vector<std::string> arguments = {"measure", picture, "-o", "out.json", "--directions"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        expect_refused(place, arguments, {words});
    };
    refused("one.png", {"stars.csv", "--lines"}, "--lines: given with --directions");
    refused("one.png", {"stars.csv", "--each"}, "--each: given with --directions");
    refused("one.png", {"none.csv"}, "none.csv");
    write_file(place.path() / "few.csv", "x_px,y_px,dx,dy,dz\n10,10,0,0,1\n20,20,0,0.1,1\n");
    refused("one.png", {"few.csv"}, "too few known directions are seen in any of 1 picture");
    write_file(place.path() / "passwd", "root:x:0:0:root /root:/bin/bash\n");
    refused("one.png", {"passwd"}, "the header is \"root:x:0:0:root…\"");
    formats::write_png(formats::make_image(kWidth, kHeight, {"Y"}), place.path() / "blank.png");
    write_file(place.path() / "blank.csv", "x_px,y_px,dx,dy,dz\n" + std::string("10,10,0,0,1\n"));
    refused("blank.png", {"blank.csv"}, "show no light within 8 px");
}

}  // namespace lensproof::measure_directions_test
