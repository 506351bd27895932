#include "calibration/profile/profile.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "engine/base/input_error.h"
#include "tests/calibration/synthetic.h"
#include "tests/complaint.h"

namespace lensproof::calibration::profile_test {

Profile example() {
    Profile profile;
    profile.name = "example";
    profile.source = {.kind = "photo", .images = {"a.jpg", "b \"quoted\" ä.jpg"}, .camera = "", .lens = "a lens"};
    profile.source.notes = formats::CameraNotes{.make = "Maker", .focal_length_mm = 18.0, .f_number = 1.0 / 3.0};
    profile.source.suspicions = {"a sign"};
    profile.pictures = {{.image = "a.jpg", .role = "chart", .used = true, .orientation = 6},
                        {.image = "b", .role = "flat field", .used = false, .reason = "unreadable"}};
    profile.width_px = 640;
    profile.height_px = 480;
    profile.pixel_pitch_um = 1.0 / 3.0;
    ProfileGeometry geometry;
    geometry.model = synthetic::perspective_camera();
    geometry.covariance.assign(81, 1e-17 / 3.0);
    geometry.reprojection_rms_px = 0.1 + 0.2;  // not 0.3
    geometry.views_used = 1;
    geometry.points_used = 2;
    geometry.covered_image_height = 0.7;
    profile.geometry = geometry;
    profile.views = {{.image = "a.jpg",
                      .found = true,
                      .pose = Pose{{0.1, 0.2, 0.3}, {1, 2, 3e5}},
                      .points = {{{30, 30}, {100.1, 1e-300}, {-0.01, 0.02}, false}}},
                     {.image = "b", .found = false, .reason = "no contrast", .pose = {}, .points = {}}};
    profile.curves["field_angle_deg"] = {{0.0, 0.5}, {0.0, 10.0 / 3.0}, {0.0, 3.3}, {0.0, 3.4}, 0.7};
    profile.terms["chromatic_shift_R"] = {{"c1_px", "c3_px"}, {1.0 / 3.0, -2e-17}, {1e-4, 1e-5, 1e-5, 2e-4}};
    profile.not_measured["chromatic_shift"] = "the pictures are grey";
    return profile;
}

std::string message_of(const std::string& text) {
    return complaint_about([&] { parse_profile(text, "some.json"); });
}

// Shortest decimal that reads back to the same bits: writing, reading and writing again changes no byte.
TEST(CalibrationProfile, ReadingReturnsTheSameBits) {
    const Profile written = example();
    const std::string text = to_json(written).dump(1);
    const Profile read = parse_profile(text, "memory");
    EXPECT_EQ(to_json(read).dump(1), text);
    EXPECT_EQ(parameters(read.geometry->model), parameters(written.geometry->model));
    EXPECT_EQ(read.geometry->covariance, written.geometry->covariance);
    EXPECT_EQ(read.geometry->reprojection_rms_px, 0.1 + 0.2);
    EXPECT_EQ(read.views[0].points[0].image_px, written.views[0].points[0].image_px);
    EXPECT_FALSE(read.views[0].points[0].used);
    EXPECT_EQ(read.views[1].reason, written.views[1].reason);
    EXPECT_EQ(read.curves, written.curves);
    EXPECT_EQ(read.terms, written.terms);
    EXPECT_EQ(read.not_measured, written.not_measured);
    EXPECT_EQ(read.source.images, written.source.images);
    EXPECT_EQ(read.source.notes, written.source.notes);
    EXPECT_EQ(read.source.suspicions, written.source.suspicions);
    EXPECT_EQ(read.pictures, written.pictures);
}

// What a profile says of square pixels is what it said before there were others: no stretch_y. One that was fitted
// comes back with its errors, by noise and by views.
TEST(CalibrationProfile, AStretchIsWrittenWhereThereIsOne) {
    Profile profile = example();
    profile.geometry->covariance.assign(81, 0.0);
    const auto square = to_json(profile);
    EXPECT_FALSE(square["model"]["parameters"].contains("stretch_y"));
    EXPECT_EQ(square["model"]["covariance"]["matrix"].size(), 8u);
    EXPECT_EQ(parse_profile(square.dump(), "memory").geometry->covariance, profile.geometry->covariance);
    std::vector<double> values = parameters(profile.geometry->model);
    values.back() = 0.25;
    profile.geometry->model = with_parameters(profile.geometry->model, values);
    profile.geometry->view_standard_error.assign(9, 0.5);
    const Profile read = parse_profile(to_json(profile).dump(), "memory");
    EXPECT_EQ(stretch_y(read.geometry->model), 0.25);
    EXPECT_EQ(read.geometry->view_standard_error, profile.geometry->view_standard_error);
}

TEST(CalibrationProfile, AFlatFieldProfileHasNoCamera) {
    Profile profile = example();
    profile.geometry.reset();
    profile.pixel_pitch_um.reset();
    const auto json = to_json(profile);
    EXPECT_FALSE(json.contains("model"));
    EXPECT_TRUE(json["pixel_pitch_um"].is_null());
    EXPECT_FALSE(parse_profile(json.dump(), "memory").geometry);
}

// Focal length in mm is px times pitch: 820 px of 1/3 µm.
TEST(CalibrationProfile, FocalLengthHasAUnitInEachKey) {
    const auto json = to_json(example());
    EXPECT_DOUBLE_EQ(json["focal_length_mm"].number(), 820.0 / 3.0 * 1e-3);
    EXPECT_DOUBLE_EQ(json["focal_length_px"].number(), 820.0);
    EXPECT_DOUBLE_EQ(json["half_diagonal_px"].number(), 400.0);
}

TEST(CalibrationProfile, DamageIsNamed) {
    const std::string text = to_json(example()).dump();
    EXPECT_NE(message_of(text.substr(0, text.size() / 2)).find("some.json: not JSON"), std::string::npos);
    EXPECT_NE(message_of("[1, 2]").find("some.json: the file is [1,2]: expected an object"), std::string::npos);
    EXPECT_NE(message_of("{}").find("schema is missing"), std::string::npos);
    EXPECT_NE(message_of("{\"schema\": \"other/2\"}").find("schema is \"other/2\": expected \"lensproof-profile/1\""),
              std::string::npos);
    EXPECT_NE(message_of(""), "");
    EXPECT_NE(message_of("\xff\xfe{}"), "");

    const auto damaged = [](const std::function<void(nlohmann::ordered_json&)>& damage) {
        auto json = nlohmann::ordered_json::parse(to_json(example()).dump());
        damage(json);
        return message_of(json.dump());
    };
    EXPECT_NE(damaged([](auto& j) {
                  j["image_size_px"] = {640, -3};
              }).find("image_size_px[1] is -3: expected a count"),
              std::string::npos);
    EXPECT_NE(damaged([](auto& j) {
                  j["pixel_pitch_um"] = "wide";
              }).find("pixel_pitch_um is \"wide\": expected a finite number"),
              std::string::npos);
    EXPECT_NE(damaged([](auto& j) { j["model"]["kind"] = "cubic"; }).find("model.kind is \"cubic\""),
              std::string::npos);
    EXPECT_NE(damaged([](auto& j) { j["model"]["parameters"].erase("k2"); }).find("model.parameters.k2 is missing"),
              std::string::npos);
    EXPECT_NE(damaged([](auto& j) { j["model"]["covariance"]["matrix"].erase(0); }).find("covariance.matrix"),
              std::string::npos);
    EXPECT_NE(damaged([](auto& j) {
                  j["curves"]["field_angle_deg"]["value"].push_back(1.0);
              }).find("curves.field_angle_deg.value"),
              std::string::npos);
    EXPECT_NE(damaged([](auto& j) {
                  j["views"][0]["points"][0]["image_px"] = nullptr;
              }).find("views[0].points[0].image_px is null"),
              std::string::npos);
    EXPECT_NE(damaged([](auto& j) { j["not_measured"] = 3; }).find("not_measured is 3"), std::string::npos);
}

// Every prefix of a profile is a damaged file: always InputError, never anything else.
TEST(CalibrationProfile, EveryTruncationIsRefusedCleanly) {
    const std::string text = to_json(example()).dump();
    for (std::size_t length = 0; length < text.size(); length += 7) {
        EXPECT_THROW(parse_profile(text.substr(0, length), "cut"), InputError);
    }
}

}  // namespace lensproof::calibration::profile_test
