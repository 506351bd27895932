#include "calibration/self_test/self_test.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/measure/measure.h"
#include "calibration/picture/flat_field_traits.h"
#include "calibration/picture/picture_traits.h"
#include "calibration/self_test/simulated_chart.h"
#include "tests/calibration/synthetic.h"

namespace lensproof::calibration::self_test_test {

using namespace synthetic;

const scene::Chart kBoard{
    .pattern = scene::Checkerboard{10, 7, 30.0}, .white_reflectance = 0.8, .black_reflectance = 0.1};
Profile measure_with_self_test(const MeasureInput& input) {
    Profile profile = measure(input);
    add_self_test(profile, input);
    return profile;
}

const scene::Chart kDiscs{
    .pattern = scene::DiscGrid{9, 6, 30.0, 16.0}, .white_reflectance = 0.8, .black_reflectance = 0.1};

SimulatedCamera camera_with(double blur_px, double noise) {
    return {.model = perspective_camera(),
            .width_px = 640,
            .height_px = 480,
            .channels = {{.name = "Y"}},
            .white = 0.5,
            .blur_px = blur_px,
            .read_noise = noise};
}

/// A picture of half the size takes a quarter of the time.
SimulatedCamera small_camera_with(double blur_px, double noise) {
    SimulatedCamera camera = camera_with(blur_px, noise);
    BrownConrady half = perspective_camera();
    for (const std::size_t i : {0, 1, 2}) {
        half.parameters[i] *= 0.5;
    }
    camera.model = half;
    camera.width_px /= 2;
    camera.height_px /= 2;
    return camera;
}

ChartPoints exact_points(const CameraModel& camera, const Pose& pose, const scene::Chart& chart) {
    ChartPoints points;
    points.image_px = view_of(camera, pose, chart).image_px;
    points.found.assign(points.image_px.size(), true);
    return points;
}

// Tones are the chart's, within a tenth of their difference: the percentiles reach into the edges. Sharp edges add to
// the response of the mask that tells the noise, which is the larger the less noise there is (a fifth at 0.1 %); the
// steepest pixel of a sharp edge depends on where the edge lies in it, and noise takes some steeper ones (a fifth). The
// blur stated has the pixel's box (1/12 px²) in it.
TEST(PictureTraits, AreThoseThatThePictureWasMadeWith) {
    const Pose pose{{0.3, -0.2, 0.1}, {0.0, 0.0, 480.0}};
    for (const scene::Chart& chart : {kBoard, kDiscs}) {
        for (const double blur : {0.4, 0.8, 2.5}) {
            const SimulatedCamera camera = camera_with(blur, 0.0);
            const formats::Image clean = simulate_chart(camera, pose, chart, 3);
            for (const double noise : {0.001, 0.005}) {
                formats::Image image = clean;
                add_noise(image, noise, 3);
                const auto traits = picture_traits(image, 0, exact_points(camera.model, pose, chart));
                ASSERT_TRUE(traits);
                EXPECT_NEAR(traits->white, 0.4, 0.1 * 0.35);
                EXPECT_NEAR(traits->black, 0.05, 0.1 * 0.35);
                EXPECT_NEAR(traits->noise / noise, 1.0, 0.25)
                    << scene::kind_name(chart) << " blur " << blur << " " << noise;
                ASSERT_TRUE(traits->blur_px);
                EXPECT_NEAR(*traits->blur_px / std::sqrt(blur * blur + 1.0 / 12.0), 1.0, 0.25)
                    << scene::kind_name(chart) << " blur " << blur << " " << noise;
            }
        }
    }
}

// 77 000 pixels tell the noise to 0.3 % (and the median of its absolute value to half as well); vignetting has no part
// in it, and none in the middle, where it is 0.9992 at most a fortieth of the width away.
TEST(PictureTraits, AFlatFieldHasItsOwn) {
    SimulatedCamera camera = small_camera_with(0.7, 0.004);
    camera.channels[0].vignetting = [](double height) { return 1.0 - 0.5 * height * height; };
    const FlatFieldTraits traits = flat_field_traits(simulate_flat_field(camera, 5), 0);
    EXPECT_NEAR(traits.noise, 0.004, 0.02 * 0.004);
    EXPECT_NEAR(traits.white, 0.5, 0.005 * 0.5);
    EXPECT_EQ(flat_field_traits(formats::make_image(4, 4, {"Y"}), 0).white, 0.0);
}

TEST(PictureTraits, NoPointsHaveNone) {
    EXPECT_FALSE(picture_traits(formats::make_image(64, 64, {"Y"}), 0, {}));
}

MeasureInput input_of(const SimulatedCamera& camera, const scene::Chart& chart) {
    MeasureInput input;
    input.name = "simulated";
    input.chart = chart;
    input.model = ModelKind::brown_conrady;
    std::uint32_t seed = 100;
    for (const Pose& pose : tilted_poses(520.0, 0.35, 60.0)) {
        input.pictures.push_back({"view" + std::to_string(seed), PictureRole::chart,
                                  [camera, pose, chart, seed] { return simulate_chart(camera, pose, chart, seed); }});
        ++seed;
    }
    return input;
}

// The points of a measurement of simulated pictures have an error that is known. Its self-test, which knows only what
// was measured, must find the same: within a quarter, since the rms of 2 N = 540 numbers scatters by 3 % (four standard
// errors: 12 %), and noise and blur are known to 10 % each.
TEST(SelfTest, SaysTheErrorThatTheMeasurementHas) {
    for (const scene::Chart& chart : {kBoard, kDiscs}) {
        const SimulatedCamera camera = small_camera_with(0.7, 0.005);
        const MeasureInput input = input_of(camera, chart);
        const Profile profile = measure_with_self_test(input);
        ASSERT_TRUE(profile.self_test);
        EXPECT_EQ(profile.self_test->pictures, 5);
        const double diameter_mm = std::holds_alternative<scene::DiscGrid>(chart.pattern)
                                       ? std::get<scene::DiscGrid>(chart.pattern).diameter_mm
                                       : 0.0;
        double squares = 0.0;
        int count = 0;
        const auto poses = tilted_poses(520.0, 0.35, 60.0);
        for (std::size_t v = 0; v < poses.size(); ++v) {
            for (const ProfilePoint& point : profile.views[v].points) {
                const Vec2d truth = *predict(camera.model, poses[v], point.chart_mm, diameter_mm);
                squares += std::pow(point.image_px.x - truth.x, 2) + std::pow(point.image_px.y - truth.y, 2);
                count += 2;
            }
        }
        const double rms = std::sqrt(squares / count);
        EXPECT_NEAR(profile.self_test->point_rms_px / rms, 1.0, 0.25) << scene::kind_name(chart);
        EXPECT_LT(profile.self_test->point_bias_px, rms);
        // The second fit is off by its own error, which the first states as its own band.
        const Curve& angle = profile.curves.at("field_angle_deg");
        double widest = 0.0;
        for (std::size_t i = 0; i < angle.value.size() && angle.image_height[i] <= angle.covered_image_height; ++i) {
            widest = std::max(widest, (angle.upper_95[i] - angle.lower_95[i]) / (2.0 * k95));
        }
        EXPECT_GT(profile.self_test->curves.at("field_angle_deg").largest, 0.0);
        EXPECT_LT(profile.self_test->curves.at("field_angle_deg").largest, 4.0 * widest);
        EXPECT_TRUE(profile.self_test->curves.contains("radial_px"));
        EXPECT_TRUE(profile.self_test->curves.contains("vignetting_Y"));
    }
}

// The light falls steeply into the corners, where the measured curve ends: what the self-test makes of it beyond must
// not have a kink there that the lens has not. So the second curve is off by its own error, four of the standard errors
// that the first states, as the field angle above.
TEST(SelfTest, FallsOffIntoTheCornersAsTheLensDoes) {
    SimulatedCamera camera = small_camera_with(0.7, 0.002);
    camera.channels.front().vignetting = [](double height) { return 1.0 - 0.5 * std::pow(height, 4.0); };
    MeasureInput input = input_of(camera, kBoard);
    input.pictures.resize(3);
    input.pictures.push_back({"flat", PictureRole::flat_field, [camera] { return simulate_flat_field(camera, 7); }});
    const Profile profile = measure_with_self_test(input);
    const Curve& light = profile.curves.at("vignetting_Y");
    double widest = 0.0;
    for (std::size_t i = 0; i < light.value.size(); ++i) {
        widest = std::max(widest, (light.upper_95[i] - light.lower_95[i]) / (2.0 * k95));
    }
    EXPECT_LT(profile.self_test->curves.at("vignetting_Y").largest, 4.0 * widest);
}

// Five times the noise is a floor that is higher. (Not five times: sharp edges leave an error without noise.)
TEST(SelfTest, MoreNoiseIsAHigherFloor) {
    MeasureInput quiet = input_of(small_camera_with(0.7, 0.001), kBoard);
    MeasureInput loud = input_of(small_camera_with(0.7, 0.02), kBoard);
    quiet.pictures.resize(2);
    loud.pictures.resize(2);
    EXPECT_GT(measure_with_self_test(loud).self_test->point_rms_px,
              2.0 * measure_with_self_test(quiet).self_test->point_rms_px);
}

/// A measurement of three pictures, to make self-tests of it that differ in one trait.
struct Measured {
    MeasureInput input;
    Profile profile;

    [[nodiscard]] SelfTest floor() const { return self_test(input, profile); }
};

Measured measured_once() {
    static const Measured once = [] {
        Measured made{input_of(small_camera_with(0.7, 0.002), kBoard), {}};
        made.input.pictures.resize(3);
        made.profile = measure_with_self_test(made.input);
        return made;
    }();
    return once;
}

// At quality 40 a luminance block's lowest frequencies are quantised in steps of 14 to 20 of 255, some 1 % of full
// scale for the mean error of a pixel near an edge: several times the noise of 0.2 % that the pictures have.
TEST(SelfTest, CompressionRaisesTheFloor) {
    Measured measured = measured_once();
    for (Picture& picture : measured.input.pictures) {
        picture.jpeg_quality = 40;
    }
    EXPECT_GT(measured.floor().point_rms_px, 2.0 * measured.profile.self_test->point_rms_px);
}

// A board bent by 1 mm: a point that stands 1 mm off the plane is seen 1 mm · tan 20° = 0.36 mm aside, which at 410 px
// / 520 mm is 0.28 px. Who takes the board to be flat has that in the mapping; who fits its shape has not. Where points
// are found does not change by it: the truth that they are held against is bent as well, and made another way (here a
// surface's point is projected, there a ray is followed to the surface).
TEST(SelfTest, ABentBoardRaisesTheFloorOfWhoTakesItToBeFlat) {
    Measured measured = measured_once();
    const SelfTest flat = *measured.profile.self_test;
    measured.profile.geometry->board =
        BoardShape{.frame = {{0.0, 0.0}, {120.0, 75.0}}, .height_mm = {1.0, 0.3, -0.4, 0.0, 0.0}, .covariance = {}};
    const SelfTest bent = measured.floor();
    EXPECT_GT(bent.curves.at("radial_px").rms, 3.0 * flat.curves.at("radial_px").rms);
    EXPECT_GT(*bent.reprojection_rms_px, 3.0 * *flat.reprojection_rms_px);
    EXPECT_NEAR(bent.point_rms_px / flat.point_rms_px, 1.0, 0.2);
    measured.input.geometry.fit_board_shape = true;
    EXPECT_LT(*measured.floor().reprojection_rms_px, 1.2 * *flat.reprojection_rms_px);
}

// A lamp at one side, e^±0.75 over the board's 300 mm: a corner's error goes with noise over contrast, so the mean
// square grows by sinh(1.5) / 1.5 = 1.42 and the rms by 1.19, where noise makes it (a tenth is left for what does not).
// The measurement finds the gradient that was there: 2 % of it over the board is 0.03 in ln(white), six times what
// 5 % of a white square's tone, blurred in from its neighbours, can change.
TEST(SelfTest, UnevenLightRaisesTheFloorAndIsMeasured) {
    Measured measured = measured_once();
    const Vec2d gradient{0.005, -0.0015};
    for (ProfileView& view : measured.profile.views) {
        ASSERT_TRUE(view.traits->light_gradient_per_mm);
        EXPECT_NEAR(view.traits->light_gradient_per_mm->x, 0.0, 0.02 * gradient.x);
        view.traits->light_gradient_per_mm = gradient;
    }
    EXPECT_GT(measured.floor().point_rms_px, 1.09 * measured.profile.self_test->point_rms_px);

    SimulatedCamera camera = small_camera_with(0.7, 0.002);
    camera.white = 0.3;  // the bright side must not clip
    camera.light_gradient_per_mm = gradient;
    MeasureInput lit = input_of(camera, kBoard);
    lit.pictures = {lit.pictures[0], lit.pictures[2]};  // in the second, corners lie 3 px from the frame
    for (const ProfileView& view : measure(lit).views) {
        ASSERT_TRUE(view.traits && view.traits->light_gradient_per_mm) << view.reason;
        EXPECT_NEAR(view.traits->light_gradient_per_mm->x, gradient.x, 0.02 * gradient.x);
        EXPECT_NEAR(view.traits->light_gradient_per_mm->y, gradient.y, 0.02 * gradient.x);
    }
}

TEST(SelfTest, ItIsSaidWhyThereIsNone) {
    MeasureInput input;
    input.name = "flat";
    input.chart = {.pattern = scene::FlatField{}};
    input.pictures.push_back(
        {"flat", PictureRole::flat_field, [] { return simulate_flat_field(camera_with(0.0, 0.001), 1); }});
    const Profile profile = measure_with_self_test(input);
    EXPECT_FALSE(profile.self_test);
    EXPECT_TRUE(profile.not_measured.contains("self_test"));
}

}  // namespace lensproof::calibration::self_test_test
