// Profiles written for OpenCV, read by cv::FileStorage and applied by OpenCV's own projections.
#include "calibration/export/opencv_yaml.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/core/persistence.hpp>

#include "engine/base/input_error.h"
#include "tests/calibration/export/export_profile.h"

namespace lensproof::calibration::opencv_yaml_test {

using namespace synthetic;

struct ReadCamera {
    int width = 0;
    int height = 0;
    int fisheye = -1;
    cv::Mat matrix;
    cv::Mat distortion;

    explicit ReadCamera(const std::string& yaml) {
        cv::FileStorage file(yaml, cv::FileStorage::READ | cv::FileStorage::MEMORY);
        file["image_width"] >> width;
        file["image_height"] >> height;
        file["fisheye_model"] >> fisheye;
        file["camera_matrix"] >> matrix;
        file["distortion_coefficients"] >> distortion;
    }
    [[nodiscard]] Vec2d project(const Vec3d& direction) const {
        std::vector<cv::Point2d> pixels;
        const std::vector<cv::Point3d> points{{direction.x, direction.y, direction.z}};
        const cv::Vec3d none(0.0, 0.0, 0.0);
        if (fisheye == 1) {
            cv::fisheye::projectPoints(points, pixels, none, none, matrix, distortion);
        } else {
            cv::projectPoints(points, none, none, matrix, distortion, pixels);
        }
        return {pixels[0].x, pixels[0].y};
    }
};

double largest_difference(const Profile& profile, const ReadCamera& camera) {
    double largest = 0.0;
    for (const Vec2d& pixel : covered_pixels(profile)) {
        const Vec2d there = camera.project(*unproject(profile.geometry->model, pixel));
        largest = std::max(largest, std::hypot(there.x - pixel.x, there.y - pixel.y));
    }
    return largest;
}

// OpenCV has these two models: the file says the same to the digits that the YAML keeps (16).
TEST(ExportOpencv, ModelsThatOpencvHasAreWrittenAsTheyAre) {
    for (const CameraModel& model : {CameraModel(perspective_camera()), CameraModel(fisheye_camera())}) {
        const Profile profile = profile_of(model, 640, 480, 0.75);  // to 80° at most: OpenCV divides by Z
        const OpencvExport result = opencv_export(profile);
        const ReadCamera camera(result.yaml);
        EXPECT_EQ(camera.width, 640);
        EXPECT_EQ(camera.height, 480);
        EXPECT_EQ(camera.fisheye, std::holds_alternative<KannalaBrandt>(model) ? 1 : 0);
        EXPECT_EQ(camera.matrix.at<double>(0, 0), focal_length_px(model));
        EXPECT_LT(result.largest_difference_px, 1e-9);
        EXPECT_LT(largest_difference(profile, camera), 1e-9);
    }
}

// A model that OpenCV does not have is fitted by one that it has, and what it says of itself is what OpenCV's functions
// show: on a lattice that is coarser than the exporter's no more than stated, and a third of it at least. Heights may
// be stretched: OpenCV has a vertical focal length of its own.
TEST(ExportOpencv, TheStatedDifferenceIsTheLibrarysOwn) {
    struct Case {
        CameraModel model;
        double largest_px;  // that the fit may differ by, for a model of that smoothness
    };
    const std::vector<Case> cases = {
        {Division{{820.0, 318.5, 243.0, -0.12, 0.0}}, 0.01},
        {RationalBrownConrady{{820.0, 318.5, 243.0, 0.2, 0.02, 0.0, 0.0005, -0.001, 0.4, 0.05, 0.0, 0.0}}, 0.01},
        {PtLens{{820.0, 318.5, 243.0, -0.03, 0.008, 0.01, 239.5, 0.0}}, 0.05},
        {Poly3{{820.0, 318.5, 243.0, -0.02, 239.5, 0.006}}, 0.01},
        {Equidistant{{260.0, 322.0, 236.0, -0.02, 0.003, 0.0}}, 0.01},
        {Equisolid{{260.0, 322.0, 236.0, -0.02, 0.003, -0.004}}, 0.01},
        {Stereographic{{260.0, 322.0, 236.0, -0.02, 0.003, 0.0}}, 0.01},
        {Orthographic{{400.0, 322.0, 236.0, -0.02, 0.003, 0.0}}, 0.05},
        {Spline{{260.0, 322.0, 236.0, 0.001, 0.002, -0.003, -0.01, -0.015, -0.02, -0.03, -0.04, -0.05, -0.06, -0.07,
                 1.4, 0.003}},
         0.2}};
    for (const Case& c : cases) {
        SCOPED_TRACE(kind_name(c.model));
        const Profile profile = profile_of(c.model, 640, 480, 0.75);
        const OpencvExport result = opencv_export(profile);
        SCOPED_TRACE(result.notes.front());
        const ReadCamera camera(result.yaml);
        EXPECT_NEAR(camera.matrix.at<double>(1, 1) / camera.matrix.at<double>(0, 0), 1.0 + stretch_y(c.model), 1e-12);
        EXPECT_LT(result.largest_difference_px, c.largest_px);
        const double found = largest_difference(profile, camera);
        EXPECT_LE(found, result.largest_difference_px + 1e-9);
        EXPECT_GE(found, result.largest_difference_px / 3.0 - 1e-9);
    }
}

// A fisheye that sees beyond 90° keeps its coefficients; what OpenCV's functions cannot project is said.
TEST(ExportOpencv, AFieldBeyondARightAngleIsSaid) {
    KannalaBrandt wide = fisheye_camera();
    wide.parameters[0] = 200.0;
    const OpencvExport result = opencv_export(profile_of(wide, 640, 480, 0.95));
    EXPECT_EQ(result.model, "fisheye");
    ASSERT_EQ(result.notes.size(), 2u);
    EXPECT_NE(result.notes[1].find("88°"), std::string::npos);
}

TEST(ExportOpencv, WithoutACameraModelThereIsNothingToWrite) {
    Profile profile = profile_of(perspective_camera(), 640, 480);
    profile.geometry.reset();
    EXPECT_THROW(opencv_export(profile), InputError);
}

}  // namespace lensproof::calibration::opencv_yaml_test
