// tests/cli/photo_folder_test.cpp — a folder of photographs as a user brings it.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/calibration/synthetic.h"
#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::photo_folder_test {

using Json = nlohmann::json;
using namespace calibration::synthetic;

const scene::Chart kBoard{.pattern = scene::Checkerboard{10, 7, 30.0}};
constexpr const char* kBoardFile = "[chart]\nkind = \"checkerboard\"\nsquares = [10, 7]\nsquare_mm = 30.0\n";

/// What a phone notes: a focal length of 820 px on a diagonal of 800 px is 44 mm on 36 × 24 mm.
struct Shot {
    int orientation = 1;
    double focal_length_mm = 4.0;
    double f_number = 1.8;
};

void write_jpeg(const std::filesystem::path& file, const formats::Image& linear, const Shot& shot) {
    std::vector<float> bytes;
    for (const float value : linear.pixels) {
        const float light = std::clamp(value, 0.0F, 1.0F);
        const float encoded = light <= 0.0031308F ? 12.92F * light : 1.055F * std::pow(light, 1.0F / 2.4F) - 0.055F;
        bytes.insert(bytes.end(), 3, encoded);
    }
    OIIO::ImageSpec spec(linear.width, linear.height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("compression", "jpeg:95");
    spec.attribute("Orientation", shot.orientation);
    spec.attribute("Make", "Phone maker");
    spec.attribute("Model", "Phone 7");
    spec.attribute("Exif:FocalLength", static_cast<float>(shot.focal_length_mm));
    spec.attribute("Exif:FocalLengthIn35mmFilm", 44);
    spec.attribute("FNumber", static_cast<float>(shot.f_number));
    const auto output = OIIO::ImageOutput::create(file.string());
    ASSERT_TRUE(output && output->open(file.string(), spec) &&
                output->write_image(OIIO::TypeDesc::FLOAT, bytes.data()));
    output->close();
}

/// The chart in grey; its light is 0.7 of full scale.
formats::Image photograph(const calibration::Pose& pose, unsigned seed, const scene::Chart& chart = kBoard) {
    formats::Image image = formats::make_image(640, 480, {"Y"});
    paint(image, 0, perspective_camera(), pose, chart, 4, [](const Vec2d&) { return 0.7; });
    add_noise(image, 0.004, seed);
    return image;
}

/// Focused elsewhere: every pixel the mean of 31 × 31.
formats::Image out_of_focus(formats::Image image) {
    constexpr int kReach = 15;
    for (const bool across : {true, false}) {
        const formats::Image sharp = image;
        for (int y = 0; y < sharp.height; ++y) {
            for (int x = 0; x < sharp.width; ++x) {
                float sum = 0.0F;
                for (int i = -kReach; i <= kReach; ++i) {
                    sum += sharp.at(std::clamp(across ? x + i : x, 0, sharp.width - 1),
                                    std::clamp(across ? y : y + i, 0, sharp.height - 1), 0);
                }
                image.at(x, y, 0) = sum / static_cast<float>(2 * kReach + 1);
            }
        }
    }
    return image;
}

/// A room: soft light and a box in it.
formats::Image without_chart() {
    formats::Image image = formats::make_image(640, 480, {"Y"});
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            image.at(x, y, 0) =
                x > 200 && x < 420 && y > 150 && y < 330 ? 0.1F : 0.3F + 0.0005F * static_cast<float>(x);
        }
    }
    return image;
}

const Json& account_of(const Json& profile, const std::string& file) {
    for (const Json& picture : profile["pictures"]) {
        if (picture["image"].get<std::string>().ends_with(file)) {
            return picture;
        }
    }
    throw std::runtime_error("no account of " + file);
}

/// JPEGs of a phone: held every way, one chart upside down, and shots that are of no use.
void fill_with_photos(const Workplace& place) {
    place.file("board.toml", kBoardFile);
    place.file("photos/notes.txt", "not a picture");
    const std::filesystem::path folder = place.path() / "photos";
    std::vector<calibration::Pose> poses = tilted_poses(520.0, 0.35, 60.0);
    poses.back().rotation_rad.z = std::numbers::pi - 0.05;  // upside down
    const std::vector<int> held = {1, 6, 8, 3, 6};
    for (std::size_t i = 0; i < poses.size(); ++i) {
        write_jpeg(folder / ("IMG_" + std::to_string(i + 1) + ".jpg"), photograph(poses[i], static_cast<unsigned>(i)),
                   {.orientation = held[i]});
    }
    write_jpeg(folder / "IMG_6.jpg", out_of_focus(photograph(poses[0], 6)), {});
    write_jpeg(folder / "IMG_7.jpg", without_chart(), {});
    place.file("photos/IMG_8.jpg", place.content("photos/IMG_1.jpg"));
    place.file("photos/IMG_9.jpg", place.content("photos/IMG_2.jpg").substr(0, 20000));
    write_jpeg(folder / "IMG_a.jpg", photograph(poses[1], 7), {.focal_length_mm = 8.0});
    write_jpeg(folder / "IMG_b.jpg", formats::make_image(480, 640, {"Y"}), {});
}

// Five photos show the chart, however the phone was held; two shots are of no use (out of focus, no chart), and a copy,
// a file cut off, another focal length and a picture that a program has turned are noticed. The sensor's frame is kept:
// the principal point comes out where the camera has it, which it would not if the portraits had been turned.
TEST(PhotoFolder, MeasuresWithAnAccountOfWhatWasLeftOut) {
    const Workplace place;
    fill_with_photos(place);
    const Outcome outcome =
        place.run({"measure", "photos", "--chart", "board.toml", "--no-self-test", "-o", "profile.json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(says(outcome.out, "5 of 11 pictures used"));
    EXPECT_TRUE(says(outcome.out, "left out  photos/IMG_6.jpg"));

    const Json profile = Json::parse(place.content("profile.json"));
    ASSERT_EQ(profile["pictures"].size(), 11u);
    for (int i = 1; i <= 5; ++i) {
        const Json& account = account_of(profile, "IMG_" + std::to_string(i) + ".jpg");
        EXPECT_TRUE(account["used"]) << account;
    }
    EXPECT_EQ(account_of(profile, "IMG_2.jpg")["exif_orientation"], 6);
    const std::vector<std::pair<std::string, std::string>> left_out = {
        {"IMG_6.jpg", "blurred"},
        {"IMG_7.jpg", "no checkerboard"},
        {"IMG_8.jpg", "IMG_1.jpg"},
        {"IMG_9.jpg", "cut off"},
        {"IMG_a.jpg", "8 mm, most of the others have focal length 4 mm"},
        {"IMG_b.jpg", "turned by a program"}};
    for (const auto& [file, reason] : left_out) {
        const Json& account = account_of(profile, file);
        EXPECT_FALSE(account["used"]) << file;
        EXPECT_TRUE(says(account["reason"].get<std::string>(), reason)) << account;
    }
    // Synthetic truth: f 820 px, centre (318.5, 243). JPEG of quality 95 and 0.4 % noise leave corners right to some
    // 0.03 px, which five views of 54 corners turn into 0.3 px of f and c; 1.5 px is five times that, and a portrait
    // taken the wrong way round would move the centre by tens.
    const Json& parameters = profile["model"]["parameters"];
    EXPECT_NEAR(parameters["focal_length_px"]["value"].get<double>(), 820.0, 2.5);
    EXPECT_NEAR(parameters["centre_x_px"]["value"].get<double>(), 318.5, 1.5);
    EXPECT_NEAR(parameters["centre_y_px"]["value"].get<double>(), 243.0, 1.5);
    EXPECT_EQ(profile["source"]["camera"], "Phone maker Phone 7");
    EXPECT_EQ(profile["source"]["settings"]["focal_length_mm"], 4.0);
    EXPECT_EQ(profile["source"]["settings"]["crop_factor"], 11.0);
    EXPECT_FALSE(profile["source"].contains("suspicions"));
}

// An experiment takes photographs as `measure` does, and its report says what was left out and why.
TEST(PhotoFolder, AnExperimentsReportHasTheSameAccount) {
    const Workplace place;
    fill_with_photos(place);
    std::string photos;
    for (const char* number : {"1", "2", "3", "7", "9", "a"}) {
        photos += "\"IMG_" + std::string(number) + ".jpg\", ";
    }
    const std::string manifest =
        "name = \"My phone\"\nlicence = \"mine\"\nsource = \"a test\"\nphotos = [" + photos + "]\n";
    place.file("photos/manifest.toml", manifest + kBoardFile);
    const char* experiment =
        "title = \"Photos\"\n[[photos]]\nname = \"phone\"\nmanifest = \"photos/manifest.toml\"\n"
        "model = \"brown-conrady\"\n";
    place.file("experiment.toml", experiment);
    const Outcome outcome = place.run({"run", "experiment.toml", "-o", "report", "--quiet"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Json report = Json::parse(place.content("report/report.json"));
    const std::string facts = report["subjects"][0]["facts"].dump();
    for (const char* part : {"3 of 6", "Phone maker Phone 7", "no checkerboard", "cut off", "8 mm, most of the others",
                             "not applied: the sensor's rows count"}) {
        EXPECT_TRUE(says(facts, part));
    }
    EXPECT_EQ(report["subjects"][0]["pictures"].size(), 6u);
    EXPECT_EQ(report["maps"].size(), 2u) << "its certainty, and how far its points are off";
    const Json& worst = report["subjects"][0]["worst"];
    ASSERT_EQ(worst.size(), 10u);
    for (const Json& point : worst) {
        EXPECT_TRUE(says(point["caption"].get<std::string>(), ".jpg at (")) << point;
        EXPECT_TRUE(says(place.content("report/images/" + point["name"].get<std::string>()), "measured"));
    }

    place.file("photos/manifest.toml", "focus_positions_mm = [0, 1]\n" + manifest + kBoardFile);
    expect_refused(place, {"run", "experiment.toml", "-o", "other"}, {"manifest.toml", "focus_positions_mm"});
}

TEST(PhotoFolder, WhereNoPictureDoesEachReasonIsGiven) {
    const Workplace place;
    place.file("board.toml", kBoardFile);
    std::filesystem::create_directory(place.path() / "photos");
    write_jpeg(place.path() / "photos/room.jpg", without_chart(), {});
    place.file("photos/damaged.jpg", "no picture at all");
    expect_refused(place, {"measure", "photos", "--chart", "board.toml", "-o", "profile.json"},
                   {"room.jpg: no checkerboard", "damaged.jpg: not a picture"});
    std::filesystem::create_directory(place.path() / "empty");
    expect_refused(place, {"measure", "empty", "--chart", "board.toml"}, {"empty", "no picture"});
    expect_refused(place, {"measure", "photos", "--chart", "board.toml", "--transfer", "gamma:x"}, {"--transfer"});
}

/// Views of a chart, tilted.
void take_photos(const Workplace& place, const scene::Chart& chart) {
    std::filesystem::create_directory(place.path() / "photos");
    unsigned seed = 1;
    for (const calibration::Pose& pose : tilted_poses(600.0, 0.35, 30.0)) {
        write_jpeg(place.path() / "photos" / ("view" + std::to_string(seed) + ".jpg"), photograph(pose, seed, chart),
                   {});
        ++seed;
    }
}

TEST(PhotoFolder, AWrongCountOfSquaresIsAnsweredWithTheOneSeen) {
    const Workplace place;
    take_photos(place, kBoard);
    for (const char* wrong : {"[9, 7]", "[8, 7]"}) {
        place.file("wrong.toml", with(kBoardFile, "[10, 7]", wrong));
        const Outcome outcome = place.run({"measure", "photos", "--chart", "wrong.toml"});
        EXPECT_EQ(outcome.status, 2) << outcome.out;
        EXPECT_TRUE(says(outcome.err, "a checkerboard of 9 × 6 inner corners (squares = [10, 7]) found"));
        EXPECT_TRUE(says(outcome.err, std::string("(squares = ") + wrong + ") of the chart"));
    }
}

// 8 × 6 inner corners look the same after a half turn.
TEST(PhotoFolder, WhatEveryPictureLeavesOpenIsSaidOnce) {
    const Workplace place;
    take_photos(place, {.pattern = scene::Checkerboard{9, 7, 30.0}});
    place.file("board.toml", with(kBoardFile, "[10, 7]", "[9, 7]"));
    const Outcome outcome =
        place.run({"measure", "photos", "--chart", "board.toml", "--no-self-test", "--json", "profile.json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string remark = "the chart looks the same after a half turn";
    const Json pictures = Json::parse(place.content("profile.json"))["pictures"];
    for (const Json& picture : pictures) {
        EXPECT_TRUE(says(picture["reason"].get<std::string>(), remark));
    }
    const std::size_t first = outcome.out.find(remark);
    ASSERT_NE(first, std::string::npos) << outcome.out;
    EXPECT_EQ(outcome.out.find(remark, first + 1), std::string::npos) << outcome.out;
    EXPECT_TRUE(says(outcome.out, "in " + std::to_string(pictures.size()) + " pictures " + remark));
}

}  // namespace lensproof::photo_folder_test
