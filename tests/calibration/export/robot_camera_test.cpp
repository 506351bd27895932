// Profiles written for ROS and Kalibr, read by a YAML library and applied by OpenCV's own projections; for mrcal its
// file's own words (tests/validation/mrcal_test.py reads them with mrcal itself).
#include "calibration/export/robot_camera.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <opencv2/calib3d.hpp>

#include "engine/base/input_error.h"
#include "tests/calibration/export/export_profile.h"
#include "tests/complaint.h"

namespace lensproof::calibration::robot_camera_test {

using namespace synthetic;

/// What a reader of the file has: OpenCV's matrix and coefficients.
struct ReadCamera {
    cv::Matx33d matrix;
    std::vector<double> distortion;
    bool is_fisheye = false;

    [[nodiscard]] Vec2d project(const Vec3d& direction) const {
        std::vector<cv::Point2d> pixels;
        const std::vector<cv::Point3d> points{{direction.x, direction.y, direction.z}};
        const cv::Vec3d none(0.0, 0.0, 0.0);
        if (is_fisheye) {
            cv::fisheye::projectPoints(points, pixels, none, none, matrix, distortion);
        } else {
            cv::projectPoints(points, none, none, matrix, distortion, pixels);
        }
        return {pixels[0].x, pixels[0].y};
    }
};

cv::Matx33d matrix_of(const std::vector<double>& f_and_centre) {
    return {f_and_centre[0], 0.0, f_and_centre[2], 0.0, f_and_centre[1], f_and_centre[3], 0.0, 0.0, 1.0};
}

ReadCamera read_ros(const std::string& text) {
    const YAML::Node file = YAML::Load(text);
    EXPECT_EQ(file["image_width"].as<int>(), 640);
    EXPECT_EQ(file["image_height"].as<int>(), 480);
    const auto k = file["camera_matrix"]["data"].as<std::vector<double>>();
    const auto p = file["projection_matrix"]["data"].as<std::vector<double>>();
    EXPECT_EQ(p.size(), 12u);
    EXPECT_EQ((std::vector<double>{p[0], p[2], p[5], p[6]}), (std::vector<double>{k[0], k[2], k[4], k[5]}));
    EXPECT_EQ(file["rectification_matrix"]["data"].as<std::vector<double>>(),
              (std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
    const auto model = file["distortion_model"].as<std::string>();
    const auto d = file["distortion_coefficients"]["data"].as<std::vector<double>>();
    EXPECT_EQ(d.size(), model == "plumb_bob" ? 5u : model == "equidistant" ? 4u : 8u) << model;
    EXPECT_EQ(file["distortion_coefficients"]["cols"].as<std::size_t>(), d.size());
    return {matrix_of({k[0], k[4], k[2], k[5]}), d, model == "equidistant"};
}

ReadCamera read_kalibr(const std::string& text) {
    const YAML::Node camera = YAML::Load(text)["cam0"];
    EXPECT_EQ(camera["camera_model"].as<std::string>(), "pinhole");
    EXPECT_EQ(camera["resolution"].as<std::vector<int>>(), (std::vector<int>{640, 480}));
    const auto model = camera["distortion_model"].as<std::string>();
    EXPECT_TRUE(model == "radtan" || model == "equidistant") << model;
    const auto d = camera["distortion_coeffs"].as<std::vector<double>>();
    EXPECT_EQ(d.size(), 4u);
    return {matrix_of(camera["intrinsics"].as<std::vector<double>>()), d, model == "equidistant"};
}

double largest_difference(const Profile& profile, const ReadCamera& camera) {
    double largest = 0.0;
    for (const Vec2d& pixel : covered_pixels(profile)) {
        const Vec2d there = camera.project(*unproject(profile.geometry->model, pixel));
        largest = std::max(largest, std::hypot(there.x - pixel.x, there.y - pixel.y));
    }
    return largest;
}

const BrownConrady kBrown{{820.0, 318.5, 243.0, -0.2, 0.05, 0.02, 0.0005, -0.001, 0.003}};
const BrownConrady kRadtan{{820.0, 318.5, 243.0, -0.2, 0.05, 0.0, 0.0005, -0.001, 0.003}};

// What both programs have is written digit by digit: 1e-9 px is what sixteen digits of some hundred px leave.
TEST(ExportRobotCamera, ModelsThatAProgramHasAreWrittenAsTheyAre) {
    const Profile brown = profile_of(kBrown, 640, 480);
    const Profile radtan = profile_of(kRadtan, 640, 480);
    const Profile fisheye = profile_of(fisheye_camera(), 640, 480, 0.75);  // to 80° at most: OpenCV divides by Z
    const RobotCameraExport plumb_bob = robot_camera_export(brown, RobotProgram::ros);
    EXPECT_EQ(plumb_bob.model, "plumb_bob");
    EXPECT_LT(largest_difference(brown, read_ros(plumb_bob.text)), 1e-9);
    const RobotCameraExport equidistant = robot_camera_export(fisheye, RobotProgram::ros);
    EXPECT_EQ(equidistant.model, "equidistant");
    EXPECT_LT(largest_difference(fisheye, read_ros(equidistant.text)), 1e-9);
    const RobotCameraExport four = robot_camera_export(radtan, RobotProgram::kalibr);
    EXPECT_EQ(four.model, "pinhole-radtan");
    EXPECT_LT(largest_difference(radtan, read_kalibr(four.text)), 1e-9);
    const RobotCameraExport equi = robot_camera_export(fisheye, RobotProgram::kalibr);
    EXPECT_EQ(equi.model, "pinhole-equi");
    EXPECT_LT(largest_difference(fisheye, read_kalibr(equi.text)), 1e-9);
}

// What a program does not have is fitted, and the file states a difference that OpenCV's functions confirm: on a
// lattice coarser than the exporter's, whose pixels are others, a tenth more at most, and a third of it at least.
TEST(ExportRobotCamera, TheStatedDifferenceIsOpencvsOwn) {
    const Division division{{820.0, 318.5, 243.0, -0.12, 0.0}};
    for (const RobotProgram program : {RobotProgram::ros, RobotProgram::kalibr}) {
        for (const CameraModel& model : {CameraModel(division), CameraModel(kBrown)}) {
            const Profile profile = profile_of(model, 640, 480);
            const RobotCameraExport result = robot_camera_export(profile, program);
            const ReadCamera camera = program == RobotProgram::ros ? read_ros(result.text) : read_kalibr(result.text);
            const double found = largest_difference(profile, camera);
            EXPECT_LE(found, 1.1 * result.largest_difference_px + 1e-9) << result.notes.front();
            EXPECT_GE(found, result.largest_difference_px / 3.0 - 1e-9) << result.notes.front();
            EXPECT_TRUE(says(result.text, result.notes.front()));
        }
    }
}

TEST(ExportRobotCamera, MrcalHasItsModelsByName) {
    const auto of = [](const CameraModel& model, double covered = 0.9) {
        return robot_camera_export(profile_of(model, 640, 480, covered), RobotProgram::mrcal);
    };
    EXPECT_EQ(of(kRadtan).model, "LENSMODEL_OPENCV4");
    EXPECT_EQ(of(kBrown).model, "LENSMODEL_OPENCV5");
    EXPECT_TRUE(says(of(kBrown).text, "'lensmodel': 'LENSMODEL_OPENCV5'"));
    EXPECT_TRUE(says(of(kBrown).text, "'imagersize': [640, 480]"));
    const Stereographic round{{260.0, 322.0, 236.0, 0.0, 0.0, 0.01}};
    EXPECT_EQ(of(round).model, "LENSMODEL_STEREOGRAPHIC");
    EXPECT_TRUE(says(of(round).text, "'intrinsics': [260, 262.6, 322, 236]"));
    // It has no fisheye with a formula, and a pinhole shows nothing at 90°.
    KannalaBrandt wide = fisheye_camera();
    wide.parameters[0] = 200.0;
    EXPECT_TRUE(says(complaint_about([&] { of(wide, 0.95); }), "less than 88"));
}

}  // namespace lensproof::calibration::robot_camera_test
