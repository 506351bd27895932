#include "calibration/sharpness/siemens_star.h"

#include <gtest/gtest.h>

#include "calibration/measure/measure.h"
#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "tests/calibration/sharpness/sharpness_edge.h"

namespace lensproof::calibration::siemens_star_test {

using namespace synthetic;

const scene::SiemensStar kStar{.sectors = 144, .radius_mm = 100.0};

struct View {
    double blur_px = 0.8;
    double tilt_deg = 0.0;
    double distance_mm = 600.0;
};

Pose pose_of(const View& view) {
    const double tilt = radians(view.tilt_deg);
    return {{0.7 * tilt, -0.6 * tilt, 0.1}, {20.0, -10.0, view.distance_mm}};
}

formats::Image picture(const View& view, const scene::SiemensStar& star = kStar) {
    SimulatedCamera camera{
        .model = perspective_camera(), .width_px = 640, .height_px = 480, .channels = {{.name = "Y"}}};
    camera.blur_px = view.blur_px;
    camera.white = 0.7;
    camera.channels[0].vignetting = [](double height) { return 1.0 - 0.2 * height * height; };
    return simulate_chart(camera, pose_of(view), {.pattern = star, .white_reflectance = 1.0, .black_reflectance = 0.05},
                          1);
}

StarMtf measured(const formats::Image& image, const scene::SiemensStar& star = kStar) {
    const auto found = find_stars(image, 0, star);
    if (const auto* refusal = std::get_if<StarRefusal>(&found)) {
        ADD_FAILURE() << refusal->reason;
        return {};
    }
    const auto& maps = std::get<std::vector<StarMap>>(found);
    EXPECT_EQ(maps.size(), 1u);
    const auto result = measure_star(image, 0, maps.front(), star);
    if (const auto* refusal = std::get_if<StarRefusal>(&result)) {
        ADD_FAILURE() << refusal->reason;
        return {};
    }
    return std::get<StarMtf>(result);
}

/// MTF50 of a Gaussian and the pixel's box, of the mean over a segment's 45° of directions: half way between the two
/// extremes to 1e-3, as those are 1 % apart.
double true_mtf50(double sigma, double frequency_deg) {
    double mean = 0.0;
    for (int i = -2; i <= 2; ++i) {
        mean += true_frequency(gaussian_blur(sigma), frequency_deg + 9.0 * i, 0.5) / 5.0;
    }
    return mean;
}

// The centre's image is known; so is how large a circle looks: as the chart's own circle, projected.
TEST(CalibrationSiemensStar, IsFoundWhereItIs) {
    const View view{.blur_px = 1.2, .tilt_deg = 40.0};
    formats::Image image = picture(view);
    add_noise(image, 0.005, 3);
    const StarMtf star = measured(image);
    const Vec2d centre = project(perspective_camera(), to_camera(pose_of(view), {0.0, 0.0})).value();
    EXPECT_NEAR(star.centre_px.x, centre.x, 0.02);
    EXPECT_NEAR(star.centre_px.y, centre.y, 0.02);
    double longest = 0.0;
    double shortest = 1e9;
    for (int i = 0; i < 90; ++i) {
        const double a = i * std::numbers::pi / 90.0;
        const auto at = [&](double sign) {
            return project(perspective_camera(),
                           to_camera(pose_of(view), {sign * 100.0 * std::cos(a), sign * 100.0 * std::sin(a)}))
                .value();
        };
        const double half = 0.5 * std::hypot(at(1.0).x - at(-1.0).x, at(1.0).y - at(-1.0).y);
        longest = std::max(longest, half);
        shortest = std::min(shortest, half);
    }
    // Distortion makes the circle's image no ellipse, by 0.5 px.
    EXPECT_NEAR(star.outline.long_half_axis_px, longest, 1.0);
    EXPECT_NEAR(star.outline.short_half_axis_px, shortest, 1.0);
}

// The target of 2 %, in every direction, from 0.44 to 0.12 cycles per pixel, upright and tilted, with 20 % vignetting.
TEST(CalibrationSiemensStar, Mtf50IsWithinTwoPercentInEveryDirection) {
    for (const View& view : {View{.blur_px = 0.3}, View{.blur_px = 0.8, .tilt_deg = 30.0},
                             View{.blur_px = 1.5, .tilt_deg = 40.0, .distance_mm = 500.0}}) {
        formats::Image image = picture(view);
        add_noise(image, 0.007, 5);
        const StarMtf star = measured(image);
        EXPECT_EQ(star.segments.size(), 8u);
        for (const StarSegment& segment : star.segments) {
            ASSERT_TRUE(segment.mtf50);
            EXPECT_NEAR(segment.mtf50->cycles_per_px / true_mtf50(view.blur_px, segment.frequency_deg), 1.0, 0.02)
                << "blur " << view.blur_px << ", along " << segment.frequency_deg;
            EXPECT_NEAR(segment.contrast, 0.95 / 1.05, 0.02);
        }
    }
}

// Light that is smeared over three pixels of a row is less sharp along x alone. The smear's own transform is
// (1 + 2 cos 2πf) / 3; a segment is the mean over directions that are up to 22.5° aside, hence 6 %.
TEST(CalibrationSiemensStar, DirectionsAreToldApart) {
    const formats::Image image = picture({.blur_px = 0.6});
    formats::Image smeared = image;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 1; x + 1 < image.width; ++x) {
            smeared.at(x, y, 0) = (image.at(x - 1, y, 0) + image.at(x, y, 0) + image.at(x + 1, y, 0)) / 3.0F;
        }
    }
    const Blur gaussian = gaussian_blur(0.6);
    const Blur along_x{.edge_spread = {}, .mtf = [&](double f) {
                           return gaussian.mtf(f) * (1.0 + 2.0 * std::cos(2.0 * std::numbers::pi * f)) / 3.0;
                       }};
    for (const StarSegment& segment : measured(smeared).segments) {
        const double found = segment.mtf50->cycles_per_px;
        if (segment.frequency_deg == 0.0) {
            EXPECT_NEAR(found / true_frequency(along_x, 0.0, 0.5), 1.0, 0.06);
        } else if (segment.frequency_deg == 90.0) {
            EXPECT_NEAR(found / true_mtf50(0.6, 90.0), 1.0, 0.06);
        }
    }
}

// The star's map as known without noise; 30 noises × 8 segments. Of 240 intervals that hold the truth with 95 %, 93.75
// to 99 % do within three standard errors (1.4 %); what is left of 64 samples a pixel adds some bias, so 91 %.
TEST(CalibrationSiemensStar, StatedIntervalsCoverTheTruth) {
    const formats::Image clean = picture({.blur_px = 0.8, .tilt_deg = 15.0});
    const StarMap map = std::get<std::vector<StarMap>>(find_stars(clean, 0, kStar)).front();
    int covered = 0;
    int count = 0;
    for (unsigned seed = 0; seed < 30; ++seed) {
        formats::Image image = clean;
        add_noise(image, 0.014, seed);
        const auto star = std::get<StarMtf>(measure_star(image, 0, map, kStar));
        for (const StarSegment& segment : star.segments) {
            const double truth = true_mtf50(0.8, segment.frequency_deg);
            covered += truth > segment.mtf50->lower_95 && truth < segment.mtf50->upper_95 ? 1 : 0;
            ++count;
        }
    }
    EXPECT_EQ(count, 240);
    EXPECT_GT(covered, 0.91 * count);
    EXPECT_LT(covered, 0.995 * count);
}

std::string refusal(const formats::Image& image, const scene::SiemensStar& star = kStar) {
    const auto found = find_stars(image, 0, star);
    const auto* none = std::get_if<StarRefusal>(&found);
    return none == nullptr ? "" : none->reason;
}

// Pictures of something else, of another star, of too little light or too much say so.
TEST(CalibrationSiemensStar, WrongPicturesHaveTheirReasons) {
    const formats::Image image = picture({});
    EXPECT_NE(refusal(image, {.sectors = 72, .radius_mm = 100.0}).find("no circle in it crosses 72 sectors"),
              std::string::npos);
    formats::Image board = formats::make_image(640, 480, {"Y"});
    paint(board, 0, perspective_camera(), pose_of({}), {.pattern = scene::Checkerboard{10, 7, 30.0}}, 2);
    EXPECT_NE(refusal(board).find("no circle in it crosses 144 sectors"), std::string::npos);
    EXPECT_NE(refusal(formats::make_image(64, 48, {"Y"})).find("of one tone"), std::string::npos);
    EXPECT_NE(refusal(formats::make_image(8, 8, {"Y"})).find("too small"), std::string::npos);
    formats::Image clipped = image;
    for (float& value : clipped.pixels) {
        value = std::min(1.0F, 2.0F * value);
    }
    const auto found = find_stars(clipped, 0, kStar);
    const auto result = measure_star(clipped, 0, std::get<std::vector<StarMap>>(found).front(), kStar);
    EXPECT_EQ(std::get<StarRefusal>(result).reason, "the star is clipped at white");
}

// From a picture to a profile and its file.
TEST(CalibrationSiemensStar, AProfileOfAStarIsItsSharpness) {
    MeasureInput input;
    input.name = "star";
    input.chart = {.pattern = kStar};
    input.pictures = {{"star", PictureRole::chart, [] { return picture({}); }},
                      {"grey", PictureRole::chart, [] { return formats::make_image(640, 480, {"Y"}); }}};
    input.pixel_pitch_um = 4.0;
    const Profile profile = measure(input);
    ASSERT_EQ(profile.siemens_stars.at("Y").size(), 1u);
    EXPECT_TRUE(profile.pictures[0].used);
    EXPECT_FALSE(profile.pictures[1].used);
    EXPECT_NE(profile.pictures[1].reason.find("no Siemens star"), std::string::npos);
    EXPECT_EQ(profile.not_measured.at("geometry"), "a Siemens star has but one point");
    const std::string text = to_json(profile).dump();
    EXPECT_EQ(to_json(parse_profile(text, "memory")).dump(), text);
    input.pictures.erase(input.pictures.begin());
    EXPECT_THROW(measure(input), InputError);
}

}  // namespace lensproof::calibration::siemens_star_test
