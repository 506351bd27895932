#include <gtest/gtest.h>

#include "calibration/sharpness/chart_edges.h"
#include "engine/base/angle.h"
#include "tests/calibration/sharpness/sharpness_edge.h"

namespace lensproof::calibration::slanted_edge_test {

using namespace synthetic;

constexpr double kNoise = 0.01;  // of white

EdgeMtf measured(const formats::Image& image, const EdgeRegion& region) {
    const auto result = measure_edge(image, 0, region);
    if (const auto* refusal = std::get_if<EdgeRefusal>(&result)) {
        ADD_FAILURE() << "the edge " << refusal->reason;
        return {};
    }
    return std::get<EdgeMtf>(result);
}

std::string refused(const formats::Image& image, const EdgeRegion& region) {
    const auto result = measure_edge(image, 0, region);
    const auto* refusal = std::get_if<EdgeRefusal>(&result);
    return refusal != nullptr ? refusal->reason : "";
}

// Without noise the whole curve is the blur's MTF times the pixel box's, whatever the edge's direction. What is left is
// the cubic through 64 px of edge and the curvature within a bin: 0.1 % of MTF50, 0.002 of modulation up to Nyquist.
TEST(CalibrationSharpnessEdge, TheCurveIsThatOfTheBlurAndThePixel) {
    const Blur blurs[] = {gaussian_blur(0.5), gaussian_blur(1.0), gaussian_blur(2.0), smeared_blur(0.6, 1.2)};
    for (const Blur& blur : blurs) {
        for (const double normal_deg : {5.0, 30.0, 100.0, -170.0, -85.0}) {
            const EdgePicture edge{.normal_deg = normal_deg, .width = 80, .height = 80, .middle = {39.6, 39.3}};
            const EdgeMtf mtf = measured(paint_edge(edge, blur), region_of(edge));
            ASSERT_TRUE(mtf.mtf50);
            EXPECT_NEAR(mtf.mtf50->cycles_per_px / true_frequency(blur, normal_deg, 0.5), 1.0, 1e-3);
            EXPECT_NEAR(mtf.normal_deg, normal_deg, 0.01);
            for (std::size_t i = 0; i * kMtfStep <= 0.5; ++i) {
                const double frequency = static_cast<double>(i) * kMtfStep;
                EXPECT_NEAR(mtf.mtf[i], true_mtf(blur, normal_deg, frequency), 2e-3) << frequency;
            }
        }
    }
}

// No blur but the pixel's own: MTF50 lies at 0.6 cycles per pixel, beyond Nyquist, and is not hurt by aliasing. The
// edge-spread function has kinks there, which bins of a quarter of a pixel blunt: within 1 %.
TEST(CalibrationSharpnessEdge, APixelsBoxIsMeasuredBeyondNyquist) {
    for (const double normal_deg : {5.0, 10.0, 30.0}) {
        const EdgePicture edge{.normal_deg = normal_deg};
        const EdgeMtf mtf = measured(paint_edge(edge, no_blur(), 16), region_of(edge));
        ASSERT_TRUE(mtf.mtf50);
        EXPECT_NEAR(mtf.mtf50->cycles_per_px / true_frequency(no_blur(), normal_deg, 0.5), 1.0, 0.01);
    }
}

// The target is 2 % at 1 % noise. Over 500 pictures of each blur, stated intervals cover 93 to 97 %, give or take two
// binomial standard deviations (1 %); MTF50's spread is within 15 % of its stated error and well below the target.
TEST(CalibrationSharpnessEdge, IntervalsCoverTheTruth) {
    constexpr int trials = 500;
    for (const auto& [blur, normal_deg] :
         {std::pair{gaussian_blur(0.5), 5.0}, {gaussian_blur(1.0), 30.0}, {smeared_blur(0.6, 1.2), 8.0}}) {
        const EdgePicture edge{.normal_deg = normal_deg};
        const formats::Image clean = paint_edge(edge, blur);
        const double truth50 = true_frequency(blur, normal_deg, 0.5);
        const double truth10 = true_frequency(blur, normal_deg, 0.1);
        int covered50 = 0;
        int covered10 = 0;
        double squares = 0.0;
        double stated = 0.0;
        for (int trial = 0; trial < trials; ++trial) {
            formats::Image noisy = clean;
            add_noise(noisy, kNoise, static_cast<unsigned>(trial));
            const EdgeMtf mtf = measured(noisy, region_of(edge));
            ASSERT_TRUE(mtf.mtf50 && mtf.mtf10);
            covered50 += mtf.mtf50->lower_95 < truth50 && truth50 < mtf.mtf50->upper_95 ? 1 : 0;
            covered10 += mtf.mtf10->lower_95 < truth10 && truth10 < mtf.mtf10->upper_95 ? 1 : 0;
            squares += std::pow(mtf.mtf50->cycles_per_px / truth50 - 1.0, 2);
            stated += std::pow(mtf.mtf50->standard_error / truth50, 2);
        }
        for (const int covered : {covered50, covered10}) {
            EXPECT_GE(covered, (0.93 - 0.01) * trials);
            EXPECT_LE(covered, (0.97 + 0.01) * trials);
        }
        EXPECT_LT(std::sqrt(squares / trials), 0.012);
        EXPECT_NEAR(std::sqrt(squares / stated), 1.0, 0.15);
        RecordProperty("mtf50_covered", covered50);
    }
}

// Noise correlated over neighbours, as demosaicking leaves it: an error that took every pixel for its own would be half
// of the truth. The same blur of the noise (1 2 1 along both axes), 300 pictures.
TEST(CalibrationSharpnessEdge, CorrelatedNoiseWidensTheInterval) {
    constexpr int trials = 300;
    const Blur blur = gaussian_blur(1.0);
    const EdgePicture edge{.normal_deg = 12.0};
    const formats::Image clean = paint_edge(edge, blur);
    const double truth = true_frequency(blur, edge.normal_deg, 0.5);
    int covered = 0;
    for (int trial = 0; trial < trials; ++trial) {
        formats::Image white = formats::make_image(edge.width, edge.height, {"Y"});
        add_noise(white, kNoise, static_cast<unsigned>(trial));
        formats::Image noisy = clean;
        for (int y = 1; y + 1 < edge.height; ++y) {
            for (int x = 1; x + 1 < edge.width; ++x) {
                for (int k = 0; k < 9; ++k) {
                    const int dx = k % 3 - 1;
                    const int dy = k / 3 - 1;
                    const int weight = (2 - std::abs(dx)) * (2 - std::abs(dy));
                    noisy.at(x, y, 0) += static_cast<float>(weight) / 8.0F * white.at(x + dx, y + dy, 0);
                }
            }
        }
        const EdgeMtf mtf = measured(noisy, region_of(edge));
        covered += mtf.mtf50->lower_95 < truth && truth < mtf.mtf50->upper_95 ? 1 : 0;
    }
    EXPECT_GE(covered, 0.91 * trials);
    EXPECT_LE(covered, 0.985 * trials);
}

// Distortion bends an edge by half a pixel over its length; a straight line through it would lose 5 % of MTF50. Light
// that grows by a tenth across the picture would move it by as much.
TEST(CalibrationSharpnessEdge, BentEdgesAndUnevenLightDoNotMatter) {
    const Blur blur = gaussian_blur(0.8);
    EdgePicture edge{.normal_deg = 8.0, .curvature = 1e-3};
    edge.light = [](const Vec2d& p) { return 1.0 + 2e-3 * (p.x - 30.0) + 1e-3 * (p.y - 40.0); };
    const EdgeMtf mtf = measured(paint_edge(edge, blur), region_of(edge));
    EXPECT_NEAR(mtf.mtf50->cycles_per_px / true_frequency(blur, 8.0, 0.5), 1.0, 2e-3);
    EXPECT_NEAR(mtf.bend_px, 0.5 * 1e-3 * 32.0 * 32.0 * (2.0 / 3.0), 0.02);  // of a parabola, about its mean
}

// A region that is off by three pixels and two degrees gives the same answer: the edge is found in it.
TEST(CalibrationSharpnessEdge, TheRegionNeedNotBeExact) {
    const Blur blur = gaussian_blur(1.0);
    const EdgePicture edge{.normal_deg = 10.0};
    const formats::Image image = paint_edge(edge, blur);
    EdgeRegion region = region_of(edge, 26.0, 18.0);
    region.centre_px.x += 3.0;
    const double turn = radians(2.0);
    region.along = {region.along.x * std::cos(turn) - region.along.y * std::sin(turn),
                    region.along.x * std::sin(turn) + region.along.y * std::cos(turn)};
    EXPECT_NEAR(measured(image, region).mtf50->cycles_per_px / true_frequency(blur, 10.0, 0.5), 1.0, 2e-3);
}

TEST(CalibrationSharpnessEdge, WhatCannotBeMeasuredSaysWhy) {
    const Blur blur = gaussian_blur(1.0);
    EdgePicture along_columns{.normal_deg = 0.0};
    EXPECT_EQ(refused(paint_edge(along_columns, blur), region_of(along_columns)),
              "is too short, or lies along the pixels' rows, columns or diagonals");
    const EdgePicture edge{.normal_deg = 5.0};
    formats::Image clipped = paint_edge(edge, blur);
    for (float& value : clipped.pixels) {
        value = std::min(1.0F, value * 1.2F);
    }
    EXPECT_EQ(refused(clipped, region_of(edge)), "is clipped at white");
    formats::Image cut = paint_edge(edge, blur);
    add_noise(cut, 0.05, 3);
    for (float& value : cut.pixels) {
        value = std::max(0.0F, value);
    }
    EXPECT_EQ(refused(cut, region_of(edge)), "is clipped at black");
    const EdgePicture faint{.normal_deg = 5.0, .dark = 0.5, .bright = 0.55};
    EXPECT_EQ(refused(paint_edge(faint, blur), region_of(faint)), "has too little contrast");
    EXPECT_EQ(refused(paint_edge(edge, gaussian_blur(6.0)), region_of(edge)), "is too narrow for its blur");
    EXPECT_EQ(refused(paint_edge(edge, blur), region_of(edge, 80.0)), "reaches beyond the picture");
    EXPECT_EQ(refused(paint_edge(edge, blur), region_of(edge, 5.0)), "is too small");
    formats::Image holes = paint_edge(edge, blur);
    holes.at(30, 40, 0) = std::nanf("");
    EXPECT_EQ(refused(holes, region_of(edge)), "has pixels without a value");
}

// A picture that is only an edge: found by its gradients, whichever way it runs.
TEST(CalibrationSharpnessEdge, AnEdgeIsFoundInARectangle) {
    const Blur blur = gaussian_blur(1.0);
    for (const double normal_deg : {5.0, 85.0, -140.0, -10.0}) {
        const EdgePicture edge{.normal_deg = normal_deg, .width = 90, .height = 90, .middle = {44.0, 47.0}};
        formats::Image image = paint_edge(edge, blur);
        add_noise(image, 0.005, 1);
        const auto found = find_edge(image, 0, {0, 0, 90, 90});
        ASSERT_TRUE(std::holds_alternative<EdgeRegion>(found));
        const EdgeMtf mtf = measured(image, std::get<EdgeRegion>(found));
        EXPECT_NEAR(mtf.mtf50->cycles_per_px / true_frequency(blur, normal_deg, 0.5), 1.0, 0.02);
        EXPECT_NEAR(mtf.normal_deg, normal_deg, 0.1);
    }
    EXPECT_TRUE(std::holds_alternative<EdgeRefusal>(find_edge(formats::make_image(40, 40, {"Y"}), 0, {0, 0, 40, 40})));
    EXPECT_TRUE(std::holds_alternative<EdgeRefusal>(find_edge(formats::make_image(40, 40, {"Y"}), 0, {0, 0, 41, 40})));
    EXPECT_TRUE(std::holds_alternative<EdgeRefusal>(find_edge(formats::make_image(40, 40, {"Y"}), 0, {-1, 0, 4, 4})));
}

// Every region of a chart lies on an edge of the chart, wherever a tilted camera sees it: on its axis both tones meet,
// and everywhere else in it there is but one on either side.
TEST(CalibrationSharpnessEdge, RegionsOfAChartLieOnItsEdges) {
    const CameraModel camera = perspective_camera();
    const Pose pose{{0.15, -0.2, 0.1}, {0.0, 0.0, 500.0}};
    scene::CharucoBoard charuco{
        .columns = 6, .rows = 5, .square_mm = 50.0, .marker_mm = 30.0, .cells = 4, .markers = {}};
    charuco.markers.assign(15, 0);
    const scene::Chart charts[] = {{.pattern = scene::SlantedEdges{5, 4, 60.0, 40.0, 8.0}},
                                   {.pattern = scene::Checkerboard{7, 6, 40.0}},
                                   {.pattern = charuco}};
    const std::size_t expected[] = {80, 49, 31};  // 4 · 20, 5 · 5 + 6 · 4, 4 · 4 + 5 · 3
    for (std::size_t i = 0; i < std::size(charts); ++i) {
        const std::vector<Vec2d> features = scene::feature_points(charts[i]);
        const ChartPoints points{.image_px = view_of(camera, pose, charts[i]).image_px,
                                 .found = std::vector<bool>(features.size(), true)};
        const std::vector<EdgeRegion> regions = chart_edges(points, charts[i]);
        EXPECT_EQ(regions.size(), expected[i]);
        for (const EdgeRegion& region : regions) {
            const auto black = [&](double u, double v) {
                const Vec2d pixel{region.centre_px.x + u * region.along.x - v * region.along.y,
                                  region.centre_px.y + u * region.along.y + v * region.along.x};
                const Vec2d mm = chart_point(camera, pose, pixel).value();
                return scene::is_black(charts[i], mm.x, mm.y);
            };
            for (const double u : {-1.0, 0.0, 1.0}) {
                for (const double v : {0.2, 0.6, 1.0}) {
                    EXPECT_NE(black(u * region.half_length_px, v * region.half_width_px),
                              black(u * region.half_length_px, -v * region.half_width_px));
                    EXPECT_EQ(black(u * region.half_length_px, v * region.half_width_px),
                              black(0.0, 0.2 * region.half_width_px));
                }
            }
        }
    }
    const scene::Chart discs{.pattern = scene::DiscGrid{4, 3, 20.0, 10.0}};
    EXPECT_TRUE(chart_edges({.image_px = std::vector<Vec2d>(12), .found = std::vector<bool>(12, true)}, discs).empty());
}

}  // namespace lensproof::calibration::slanted_edge_test
