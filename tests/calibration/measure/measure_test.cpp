#include "calibration/measure/measure.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "calibration/self_test/simulated_chart.h"
#include "engine/base/input_error.h"
#include "tests/calibration/synthetic.h"

namespace lensproof::calibration::measure_test {

using namespace synthetic;

const scene::Chart kBoard{.pattern = scene::Checkerboard{10, 7, 30.0}};

// Light that falls off by 30 % to the corner (400 px).
double falloff(const Vec2d& pixel) {
    const double r2 = (std::pow(pixel.x - 318.5, 2) + std::pow(pixel.y - 243.0, 2)) / (400.0 * 400.0);
    return 1.0 - 0.3 * r2;
}

// Red is magnified 0.2 % more than green, blue 0.1 % less.
BrownConrady camera_for(const std::string& channel) {
    BrownConrady camera = perspective_camera();
    camera.parameters[0] *= channel == "R" ? 1.002 : channel == "B" ? 0.999 : 1.0;
    return camera;
}

formats::Image colour_picture(const Pose& pose, unsigned seed) {
    formats::Image image = formats::make_image(640, 480, {"R", "G", "B"});
    for (int c = 0; c < 3; ++c) {
        paint(image, c, camera_for(image.channels[static_cast<std::size_t>(c)]), pose, kBoard, 4,
              [](const Vec2d& p) { return 0.5 * falloff(p); });
    }
    add_noise(image, 0.003, seed);
    return image;
}

MeasureInput input_with(std::vector<Picture> pictures) {
    MeasureInput input;
    input.name = "synthetic";
    input.pictures = std::move(pictures);
    input.chart = kBoard;
    input.model = ModelKind::brown_conrady;
    input.source.kind = "render";
    return input;
}

// From pixels to a profile and back to what the pixels were made with: every truth lies within 4 standard errors (or
// 0.1 px, where the detector's own 0.02 px bias matters), and a blank picture is listed as such.
TEST(CalibrationMeasure, AProfileTellsWhatThePicturesWereMadeWith) {
    std::vector<Picture> pictures;
    unsigned seed = 0;
    auto poses = tilted_poses(520.0, 0.35, 60.0);
    for (const Pose& pose : poses) {
        pictures.push_back(
            {"view" + std::to_string(seed), PictureRole::chart, [pose, seed] { return colour_picture(pose, seed); }});
        ++seed;
    }
    pictures.push_back({"blank", PictureRole::chart, [] { return formats::make_image(640, 480, {"R", "G", "B"}); }});
    const Profile profile = measure(input_with(std::move(pictures)));

    ASSERT_TRUE(profile.geometry);
    EXPECT_EQ(profile.geometry->views_used, 5);
    EXPECT_EQ(profile.views.size(), 6u);
    EXPECT_FALSE(profile.views[5].found);
    EXPECT_FALSE(profile.views[5].reason.empty());
    EXPECT_LT(profile.geometry->reprojection_rms_px, 0.05);
    EXPECT_NEAR(focal_length_px(profile.geometry->model), 820.0, 0.5);

    const Curve& angle = profile.curves.at("field_angle_deg");
    EXPECT_NEAR(sample(angle, 0.6)->value, *field_angle_rad(perspective_camera(), 240.0) * 180.0 / std::numbers::pi,
                0.01);

    // Magnifying by m moves a point at r by (m − 1) r.
    EXPECT_NEAR(sample(profile.curves.at("chromatic_shift_R_px"), 0.6)->value, 0.002 * 240.0, 0.03);
    EXPECT_NEAR(sample(profile.curves.at("chromatic_shift_B_px"), 0.6)->value, -0.001 * 240.0, 0.03);
    EXPECT_FALSE(profile.curves.contains("chromatic_shift_G_px"));

    for (const char* channel : {"R", "G", "B"}) {
        const Curve& ratio = profile.curves.at(std::string("vignetting_") + channel);
        EXPECT_NEAR(sample(ratio, 0.5)->value, 1.0 - 0.3 * 0.25, 0.01);
    }
    EXPECT_TRUE(profile.not_measured.empty());

    const std::string text = to_json(profile).dump();
    EXPECT_EQ(to_json(parse_profile(text, "memory")).dump(), text);
}

TEST(CalibrationMeasure, FlatFieldsAloneGiveVignettingAlone) {
    const auto flat = [] {
        formats::Image image = formats::make_image(640, 480, {"Y"});
        for (int y = 0; y < 480; ++y) {
            for (int x = 0; x < 640; ++x) {
                image.at(x, y, 0) = static_cast<float>(0.5 * falloff({x - 1.0, y + 3.5}));  // about the middle
            }
        }
        return image;
    };
    MeasureInput input = input_with({{"flat", PictureRole::flat_field, flat}});
    input.chart.pattern = scene::FlatField{};
    const Profile profile = measure(input);
    EXPECT_FALSE(profile.geometry);
    EXPECT_NEAR(sample(profile.curves.at("vignetting_Y"), 0.9)->value, 1.0 - 0.3 * 0.81, 0.002);
    EXPECT_TRUE(profile.not_measured.contains("geometry"));
    EXPECT_EQ(profile.not_measured.at("chromatic_shift"), "the pictures are grey");
}

// One photo of a chart that faces the camera tells no camera, but what needs none: distortion against the lens's own,
// chromatic shift (within 0.03 px as above) and light. A model that was asked for is refused.
TEST(CalibrationMeasure, AChartThatFacesTheCameraTellsWhatNeedsNoCamera) {
    SimulatedCamera camera{.model = BrownConrady{{820.0, 319.5, 239.5, -0.24, 0.09, 0.0, 0.0, 0.0}},
                           .width_px = 640,
                           .height_px = 480,
                           .channels = {{.name = "R"}, {.name = "G"}, {.name = "B"}}};
    camera.read_noise = 0.003;
    camera.channels[0].radial_shift_px = [](double height) { return 0.8 * height; };
    for (SimulatedChannel& channel : camera.channels) {
        channel.vignetting = [](double height) { return 1.0 - 0.3 * height * height; };
    }
    const Pose facing{{0.0, 0.0, 0.0}, {0.0, 0.0, 430.0}};
    MeasureInput input =
        input_with({{"facing", PictureRole::chart, [=] { return simulate_chart(camera, facing, kBoard, 5); }}});
    EXPECT_THROW(measure(input), InputError);
    input.model.reset();
    const Profile profile = measure(input);
    EXPECT_FALSE(profile.geometry);
    EXPECT_NE(profile.not_measured.at("geometry").find("focal length"), std::string::npos);
    ASSERT_EQ(profile.views.size(), 1u);
    EXPECT_FALSE(profile.views[0].pose);
    EXPECT_EQ(profile.views[0].points.size(), 54u);
    const double radius = 0.6 * 400.0;
    const double exact = 100.0 * (radius / (820.0 * std::tan(*field_angle_rad(camera.model, radius))) - 1.0);
    const Banded distortion = *sample(profile.curves.at("distortion_percent"), 0.6);
    EXPECT_LT(distortion.upper_95 - distortion.lower_95, 0.1);
    EXPECT_NEAR(distortion.value, exact, 4.0 * (distortion.upper_95 - distortion.lower_95) / (2.0 * k95));
    EXPECT_NEAR(sample(profile.curves.at("chromatic_shift_R_px"), 0.6)->value, 0.8 * 0.6, 0.03);
    EXPECT_NEAR(sample(profile.curves.at("vignetting_G"), 0.5)->value, 1.0 - 0.3 * 0.25, 0.01);
    EXPECT_FALSE(profile.not_measured.contains("vignetting"));
    const std::string text = to_json(profile).dump();
    EXPECT_EQ(to_json(parse_profile(text, "memory")).dump(), text);
}

// A board in the middle of the frame, and a model that can do anything outside: the profile says so, in its first
// warning. With the board all over the frame there is nothing to warn of.
TEST(CalibrationMeasure, AProfileThatDoesNotKnowTheCornersSaysSo) {
    for (const bool is_central : {true, false}) {
        std::vector<Picture> pictures;
        for (const Pose& pose : is_central ? tilted_poses(2400.0, 0.5, 40.0) : tilted_poses(520.0, 0.35, 60.0)) {
            const auto seed = static_cast<unsigned>(pictures.size());
            pictures.push_back(
                {"view" + std::to_string(seed), PictureRole::chart, [=] { return colour_picture(pose, seed); }});
        }
        const Profile profile = measure(input_with(std::move(pictures)));
        ASSERT_EQ(profile.warnings.size(), is_central ? 1u : 0u);
        EXPECT_TRUE(!is_central || profile.warnings[0].find("add views") != std::string::npos);
    }
}

// A fisheye whose r(θ) turns at 167 px, in a frame of 640 × 480: 71 % of it is imaged by nothing, and no place there is
// known. Good to 5 %: a grid of 25 columns, and a circle whose rim the fit knows to a few pixels.
TEST(CalibrationMeasure, AProfileSaysHowMuchOfTheFrameItImagesNothingIn) {
    const KannalaBrandt circular{{150.0, 318.5, 243.0, -0.12, 0.0, 0.0, 0.0}};
    std::vector<Picture> pictures;
    for (const Pose& pose : tilted_poses(230.0, 0.4, 50.0)) {
        pictures.push_back({"view" + std::to_string(pictures.size()), PictureRole::chart, [=] {
                                formats::Image image = formats::make_image(640, 480, {"Y"});
                                paint(image, 0, circular, pose, kBoard, 4);
                                return image;
                            }});
    }
    MeasureInput input = input_with(std::move(pictures));
    input.model = ModelKind::kannala_brandt;
    input.geometry.radial_terms = 1;
    const Profile profile = measure(input);
    const auto said = std::ranges::find_if(
        profile.warnings, [](const std::string& w) { return w.find("the model images nothing in") == 0; });
    ASSERT_NE(said, profile.warnings.end());
    EXPECT_NEAR(std::stod(said->substr(std::string("the model images nothing in ").size())), 71.5, 5.0) << *said;
}

// Of OpenCV's thirteen photos of a chessboard each by itself, six have a focal length that is off by more than three of
// the errors that it states: there is none from view to view.
TEST(CalibrationMeasure, OnePictureSaysThatItIsOne) {
    const Pose pose = tilted_poses(520.0, 0.35, 60.0).front();
    const Profile profile =
        measure(input_with({{"view", PictureRole::chart, [pose] { return colour_picture(pose, 1); }}}));
    ASSERT_FALSE(profile.warnings.empty());
    EXPECT_NE(profile.warnings.back().find("one picture tells noise from nothing else"), std::string::npos);
}

TEST(CalibrationMeasure, UnusableSetsAreRefused) {
    const auto blank = [](int width) {
        return Picture{"blank" + std::to_string(width), PictureRole::chart,
                       [width] { return formats::make_image(width, 100, {"Y"}); }};
    };
    EXPECT_THROW(measure(input_with({})), InputError);
    EXPECT_THROW(measure(input_with({{"empty", PictureRole::chart, [] { return formats::Image{}; }}})), InputError);
    EXPECT_THROW(measure(input_with({blank(100), blank(101)})), InputError);
    try {
        measure(input_with({blank(100), blank(100), blank(100)}));
        FAIL();
    } catch (const InputError& e) {
        EXPECT_EQ(
            std::string(e.what()).rfind("synthetic: no 9 × 6 checkerboard found in any of 3 pictures: blank100: ", 0),
            0u)
            << e.what();
    }
}

// What is asked for comes out to the bit as among all the rest; what is not is not there, and the profile says why.
TEST(CalibrationMeasure, WhatIsNotAskedForIsNotMeasured) {
    std::vector<Picture> pictures;
    for (const Pose& pose : tilted_poses(520.0, 0.35, 60.0)) {
        const auto seed = static_cast<unsigned>(pictures.size());
        pictures.push_back(
            {"view" + std::to_string(seed), PictureRole::chart, [pose, seed] { return colour_picture(pose, seed); }});
    }
    MeasureInput input = input_with(std::move(pictures));
    const Profile all = measure(input);
    input.parts = parts_named({"distortion", "chromatic-shift"});
    const Profile some = measure(input);
    EXPECT_EQ(some.not_measured,
              (std::map<std::string, std::string>{{"vignetting", "was not asked for"},
                                                  {"sharpness_over_the_field", "was not asked for"}}));
    ASSERT_TRUE(some.curves.contains("chromatic_shift_R_px"));
    for (const auto& [name, curve] : some.curves) {
        EXPECT_EQ(curve.value, all.curves.at(name).value) << name;
    }
    for (const char* left_out : {"vignetting_R", "vignetting_G"}) {
        EXPECT_TRUE(all.curves.contains(left_out) && !some.curves.contains(left_out)) << left_out;
    }
    EXPECT_EQ(parts_named({"distortion"}), (WantedParts{false, false, false}));
    EXPECT_EQ(parts_named(known_parts()), WantedParts());
}

// However many pictures are looked at at once, each is held against those before it.
TEST(CalibrationMeasure, IsTheSameForAnyNumberOfThreads) {
    std::vector<Picture> pictures{
        {"gone", PictureRole::chart, []() -> formats::Image { throw InputError("gone: no such file"); }}};
    unsigned seed = 0;
    for (const Pose& pose : tilted_poses(520.0, 0.35, 60.0)) {
        const unsigned own = seed++ % 4;  // the fifth is the first again
        pictures.push_back({"view" + std::to_string(seed), PictureRole::chart, [pose, own] {
                                return colour_picture(own == 0 ? tilted_poses(520.0, 0.35, 60.0)[0] : pose, own);
                            }});
    }
    pictures.push_back({"small", PictureRole::chart, [] { return formats::make_image(320, 240, {"R", "G", "B"}); }});
    MeasureInput input = input_with(std::move(pictures));
    input.threads = 1;
    const Profile one = measure(input);
    EXPECT_EQ(one.pictures[0].reason, "no such file");
    EXPECT_EQ(one.pictures[5].reason, "the same picture as view1");
    EXPECT_TRUE(one.pictures.back().reason.starts_with("the picture is 320 × 240 pixels: expected 640 × 480"));
    input.threads = 3;
    EXPECT_EQ(to_json(measure(input)), to_json(one));
}

// OpenCV's own calibration pictures (Debian's opencv-doc). Focal length by OpenCV 533.1 px, by mrcal 533.5 px; two
// independent programs, so 533.3 within 0.4 %.
TEST(CalibrationMeasure, OpenCvPhotosGiveTheKnownFocalLength) {
    const std::filesystem::path folder = "/usr/share/doc/opencv-doc/examples/data";
    std::vector<Picture> pictures;
    for (const char* number : {"01", "02", "03", "04", "05", "06", "07", "08", "09", "11", "12", "13", "14"}) {
        const auto file = folder / (std::string("left") + number + ".jpg");
        if (!std::filesystem::exists(file)) {
            GTEST_SKIP() << "needs the package opencv-doc with " << file.filename();
        }
        pictures.push_back(
            {file.filename().string(), PictureRole::chart, [file] { return formats::read_image(file); }});
    }
    MeasureInput input = input_with(std::move(pictures));
    input.source.kind = "photo";
    const Profile profile = measure(input);
    EXPECT_EQ(profile.geometry->views_used, 13);
    EXPECT_NEAR(focal_length_px(profile.geometry->model), 533.3, 0.004 * 533.3);
    EXPECT_LE(profile.geometry->reprojection_rms_px, 0.25);
    EXPECT_EQ(profile.not_measured.at("chromatic_shift"), "the pictures are grey");
}

}  // namespace lensproof::calibration::measure_test
