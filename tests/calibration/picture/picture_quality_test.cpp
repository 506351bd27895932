// Whether pictures are judged as blurred, badly exposed or corrected where they are, and only there.
#include "calibration/picture/picture_quality.h"

#include <gtest/gtest.h>

#include "calibration/geometry/geometry_curves.h"
#include "calibration/photos/photo_survey.h"
#include "tests/calibration/export/export_profile.h"

namespace lensproof::calibration::picture_quality_test {

using namespace synthetic;

const scene::Chart kBoard{.pattern = scene::Checkerboard{10, 7, 30.0}};

const BrownConrady kCamera{{410.0, 159.5, 119.5, 0, 0, 0, 0, 0}};
const Pose kPose{{0.0, 0.0, 0.0}, {-120.0, -90.0, 450.0}};

// A board that faces the camera, its edges a Gaussian of `sigma` px: 27 px between corners. What is brighter than full
// scale is clipped.
formats::Image board_picture(double white, double sigma) {
    formats::Image image = formats::make_image(320, 240, {"Y"});
    paint(image, 0, kCamera, kPose, kBoard, 4, [&](const Vec2d&) { return white; });
    const int reach = static_cast<int>(4.0 * sigma);
    for (const bool across : {true, false}) {
        const formats::Image sharp = image;
        for (int y = 0; y < image.height && reach > 0; ++y) {
            for (int x = 0; x < image.width; ++x) {
                double sum = 0.0;
                double weights = 0.0;
                for (int i = -reach; i <= reach; ++i) {
                    const double weight = std::exp(-0.5 * i * i / (sigma * sigma));
                    const int sx = std::clamp(across ? x + i : x, 0, image.width - 1);
                    const int sy = std::clamp(across ? y : y + i, 0, image.height - 1);
                    sum += weight * sharp.at(sx, sy, 0);
                    weights += weight;
                }
                image.at(x, y, 0) = static_cast<float>(sum / weights);
            }
        }
    }
    for (float& value : image.pixels) {
        value = std::min(value, 1.0F);
    }
    return image;
}

ChartPoints corners() {
    ChartPoints points;
    const ChartView view = view_of(kCamera, kPose, kBoard);
    points.image_px = view.image_px;
    points.found.assign(view.image_px.size(), true);
    return points;
}

// The pixel's box adds 1/12 px² to σ². Edges rise from 10 % to 90 % within 2 · 1.2816 σ: those of 3.5 px are 9 px wide,
// 33 % of the corners' distance.
TEST(PictureQuality, EdgesAreAsWideAsTheirBlur) {
    const auto traits = [](double white, double sigma) {
        return picture_traits(board_picture(white, sigma), 0, corners()).value();
    };
    for (const double sigma : {1.0, 2.0}) {
        const PictureTraits seen = traits(0.7, sigma);
        EXPECT_NEAR(seen.blur_px.value() / std::sqrt(sigma * sigma + 1.0 / 12.0), 1.0, 0.15);
        EXPECT_FALSE(is_white_clipped(seen));
        EXPECT_EQ(too_blurred(seen, corners(), kBoard), "");
    }
    EXPECT_NE(too_blurred(traits(0.7, 3.5), corners(), kBoard).find("blurred: edges are 9."), std::string::npos);
    EXPECT_TRUE(is_white_clipped(traits(1.5, 1.0)));
}

TEST(PictureQuality, FaultsAreSeenWhereTheyAre) {
    EXPECT_EQ(visible_fault(board_picture(0.7, 1.0), 0), "");
    EXPECT_NE(visible_fault(board_picture(0.7, 9.0), 0).find("blurred"), std::string::npos);
    EXPECT_NE(visible_fault(board_picture(1.5, 1.0), 0).find("over-exposed"), std::string::npos);
    EXPECT_NE(visible_fault(board_picture(0.01, 1.0), 0).find("under-exposed"), std::string::npos);
    EXPECT_EQ(visible_fault(formats::make_image(1, 1, {"Y"}), 0), "");
}

Profile with_curves(const BrownConrady& model) {
    Profile profile = profile_of(model, 640, 480);
    GeometryFit fit;
    fit.model = model;
    fit.covariance.assign(81, 0.0);
    fit.covered_radius_px = 0.9 * 400.0;
    profile.curves["field_angle_deg"] = field_angle_curve(fit, 400.0);
    profile.curves["distortion_percent"] = rectilinear_distortion_curve(fit, 400.0);
    return profile;
}

// 360 px at f 500 px are 36° from the axis: without distortion that is a corrected picture; with 2 % it is a lens, and
// at f 2000 px (10°) nothing follows from none.
TEST(CorrectionSuspected, WhereAWideLensHasNoDistortion) {
    const auto sees = [](const BrownConrady& model) { return suspicions_of(with_curves(model)).size(); };
    EXPECT_EQ(sees({{500.0, 319.5, 239.5, 0, 0, 0, 0, 0}}), 1u);
    EXPECT_EQ(sees({{500.0, 319.5, 239.5, -0.04, 0, 0, 0, 0}}), 0u);
    EXPECT_EQ(sees({{2000.0, 319.5, 239.5, 0, 0, 0, 0, 0}}), 0u);
}

// 820 px on a diagonal of 800 px are 44.3 mm on one of 43.27 mm: what the camera rounds to 44, not 50.
TEST(CorrectionSuspected, WhereTheFocalLengthIsNotTheStatedOne) {
    Profile profile = profile_of(perspective_camera(), 640, 480);
    profile.source.notes = formats::CameraNotes{.focal_length_mm = 4.0, .equivalent_focal_length_mm = 44.0};
    EXPECT_TRUE(suspicions_of(profile).empty());
    profile.source.notes->equivalent_focal_length_mm = 50.0;
    ASSERT_EQ(suspicions_of(profile).size(), 1u);
    EXPECT_NE(suspicions_of(profile)[0].find("44.3 mm"), std::string::npos);
}

}  // namespace lensproof::calibration::picture_quality_test
