#include "calibration/self_test/simulated_chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lensproof::calibration::simulated_chart_test {

constexpr double kFocal_px = 200.0;
constexpr double kDistance_mm = 1000.0;
constexpr double kMmPerPixel = kDistance_mm / kFocal_px;

SimulatedCamera grey_camera() {
    return {.model = BrownConrady{{kFocal_px, 79.5, 59.5}},
            .width_px = 160,
            .height_px = 120,
            .channels = {{.name = "Y"}},
            .white = 1.0,
            .blur_px = 0.0};
}

const Pose kFacing{{0.0, 0.0, 0.0}, {0.0, 0.0, kDistance_mm}};

// A board of white, so that only its middle edge is in the picture: columns meet at x = 0, rows far outside.
const scene::Chart kEdge{
    .pattern = scene::Checkerboard{2, 1, 100.0 * kMmPerPixel}, .white_reflectance = 1.0, .black_reflectance = 0.0};

// ∫ Φ(s) ds, Φ the normal distribution's function.
double integrated_phi(double s) {
    return s * 0.5 * std::erfc(-s / std::numbers::sqrt2) + std::exp(-0.5 * s * s) / std::sqrt(2.0 * std::numbers::pi);
}

// Light of the pixel at `x` beside an edge at `edge`, white beyond it: a step, blurred by a Gaussian, over the pixel.
double blurred_edge(double x, double edge, double sigma) {
    const double from = (x - 0.5 - edge) / sigma;
    const double to = (x + 0.5 - edge) / sigma;
    return sigma * (integrated_phi(to) - integrated_phi(from));
}

// An edge, blurred, is the normal distribution over a pixel. Blur acts on a grid of quarter pixels, whose own box has a
// variance of 1/192 px²: at σ = 0.5 that is 2 % of the variance, 1 % of the edge's width, and the light there goes from
// 0 to 1 with a slope of 0.8 a pixel, over half a pixel: 0.004.
TEST(SimulatedChart, AnEdgeIsTheIntegralOfTheBlur) {
    for (const double sigma : {0.5, 1.0, 2.0}) {
        for (const double edge_px : {0.0, 0.13, 0.5, 0.77}) {
            SimulatedCamera camera = grey_camera();
            camera.blur_px = sigma;
            Pose pose = kFacing;
            pose.translation_mm.x = edge_px * kMmPerPixel;
            const formats::Image image = simulate_chart(camera, pose, kEdge, 0);
            for (int x = 70; x < 90; ++x) {
                EXPECT_NEAR(image.at(x, 60, 0), blurred_edge(x, 79.5 + edge_px, sigma), 0.004) << sigma << " " << x;
            }
        }
    }
}

// Without blur, the fraction of a pixel beyond a turned edge is its area there. 64 places of which no two share a row
// or column: an edge that is nearly along one of them is known to 1/64. One that is turned leaves a row through two or
// three pixels, each off by that much. Errors of 41 rows average out to a few thousandths.
TEST(SimulatedChart, ATurnedEdgeLiesWhereItShould) {
    for (const double turn : {0.0, 0.02, 0.1, 0.3, 0.7}) {
        Pose pose = kFacing;
        pose.rotation_rad.z = turn;
        const formats::Image image = simulate_chart(grey_camera(), pose, kEdge, 0);
        double mean_error = 0.0;
        constexpr int kRows = 41;
        for (int y = 40; y < 40 + kRows; ++y) {
            double black = 0.0;  // pixels of the row that are black, from x = 30
            for (int x = 30; x < 130; ++x) {
                black += 1.0 - image.at(x, y, 0);
            }
            const double edge = 79.5 - (y - 59.5) * std::tan(turn);
            const double error = 29.5 + black - edge;
            EXPECT_NEAR(error, 0.0, 3.0 / 64.0) << turn << " row " << y;
            mean_error += error / kRows;
        }
        EXPECT_NEAR(mean_error, 0.0, 0.005) << turn;
    }
}

// A channel's shift moves what lies at image height ρ outwards by what it says, and its vignetting takes light away.
TEST(SimulatedChart, ShiftAndVignettingAreWhatTheyAreSaidToBe) {
    SimulatedCamera camera = grey_camera();
    const double half_diagonal = 100.0;  // of 160 × 120
    camera.channels = {{.name = "G"},
                       {.name = "R",
                        .radial_shift_px = [](double rho) { return 0.8 * rho; },
                        .vignetting = [](double rho) { return 1.0 - 0.5 * rho * rho; }}};
    Pose pose = kFacing;
    pose.translation_mm.x = 50.0 * kMmPerPixel;  // the edge at x = 129.5
    const formats::Image image = simulate_chart(camera, pose, kEdge, 0);
    const auto edge = [&](int channel, double white) {
        double black = 0.0;
        for (int x = 120; x < 140; ++x) {
            black += 1.0 - image.at(x, 59, channel) / white;
        }
        return 119.5 + black;
    };
    EXPECT_NEAR(edge(0, 1.0), 129.5, 1.0 / 64.0);
    const double rho = 50.0 / half_diagonal;
    // Light changes by 1 % a pixel there, so the ten white pixels are off by up to 5 %, evenly to both sides.
    EXPECT_NEAR(edge(1, 1.0 - 0.5 * 0.55 * 0.55), 129.5 + 0.8 * rho, 0.05);
    const formats::Image flat = simulate_flat_field(camera, 0);
    EXPECT_FLOAT_EQ(flat.at(130, 60, 0), 1.0F);
    const double own = std::hypot(130 - 79.5, 60 - 59.5) / half_diagonal;
    EXPECT_FLOAT_EQ(flat.at(130, 60, 1), static_cast<float>(1.0 - 0.5 * own * own));
}

// The sample variance of n = 19200 normal numbers is within 4 √(2/n) = 4 % of the one stated, read noise and shot noise
// together; the mean within 4 σ/√n. Another seed gives other noise, the same seed the same for any number of threads.
TEST(SimulatedChart, NoiseHasTheVarianceStated) {
    SimulatedCamera camera = grey_camera();
    camera.white = 0.5;
    camera.read_noise = 0.003;
    camera.shot_noise = 0.01;
    camera.threads = 1;
    const formats::Image image = simulate_flat_field(camera, 1);
    double sum = 0.0;
    double squares = 0.0;
    for (const float value : image.pixels) {
        sum += value - 0.5;
        squares += (value - 0.5) * (value - 0.5);
    }
    const auto n = static_cast<double>(image.pixels.size());
    const double variance = 0.003 * 0.003 + 0.01 * 0.01 * 0.5;
    EXPECT_NEAR(squares / n / variance, 1.0, 4.0 * std::sqrt(2.0 / n));
    EXPECT_NEAR(sum / n, 0.0, 4.0 * std::sqrt(variance / n));
    EXPECT_NE(simulate_flat_field(camera, 2).pixels, image.pixels);
    camera.threads = 3;
    EXPECT_EQ(simulate_flat_field(camera, 1).pixels, image.pixels);
}

// JPEG rounds to 8-bit sRGB (half a step of 1/255 through a slope of at most 2.3 is 0.005 of full scale) and, at full
// quality, adds rounding of the same size; at low quality an edge rings.
TEST(SimulatedChart, JpegCostsWhatItsQualitySays) {
    SimulatedCamera camera = grey_camera();
    camera.blur_px = 0.7;
    camera.white = 0.8;
    const formats::Image exact = simulate_chart(camera, kFacing, kEdge, 0);
    const auto largest_error = [&](int quality) {
        camera.jpeg_quality = quality;
        const formats::Image image = simulate_chart(camera, kFacing, kEdge, 0);
        double largest = 0.0;
        for (std::size_t i = 0; i < image.pixels.size(); ++i) {
            largest = std::max(largest, std::abs(static_cast<double>(image.pixels[i]) - exact.pixels[i]));
        }
        return largest;
    };
    EXPECT_LT(largest_error(100), 0.02);
    EXPECT_GT(largest_error(40), largest_error(100));
}

// Parts of a picture that no edge is near are not looked at place by place. A chart whose parts are not stated to be
// wide is, and is the same: one column of squares between endless white, as a board and as a cross of two lines.
TEST(SimulatedChart, WhatIsSkippedIsWhatIsSeen) {
    const double side = 20.0 * kMmPerPixel;
    const scene::Chart board{.pattern = scene::Checkerboard{1, 1, side}};
    const scene::Chart square{.pattern = scene::SlantedEdges{1, 1, 2.0 * side, side, 0.0}};
    Pose pose = kFacing;
    pose.rotation_rad = {0.2, -0.1, 0.4};
    const formats::Image skipped = simulate_chart(grey_camera(), pose, board, 0);
    const formats::Image seen = simulate_chart(grey_camera(), pose, square, 0);
    EXPECT_EQ(skipped.pixels, seen.pixels);
}

// What the camera does not image, and what is behind the chart, is black; the chart's own plane seen from its edge too.
TEST(SimulatedChart, WhereThereIsNoChartItIsBlack) {
    SimulatedCamera camera = grey_camera();
    camera.model = KannalaBrandt{{60.0, 79.5, 59.5}};  // 95° at the corners
    camera.white = 1.0;
    const formats::Image image = simulate_chart(camera, kFacing, kEdge, 0);
    EXPECT_EQ(image.at(0, 0, 0), 0.0F);
    EXPECT_EQ(image.at(120, 59, 0), 1.0F);
    Pose behind = kFacing;
    behind.translation_mm.z = -kDistance_mm;
    for (const float value : simulate_chart(grey_camera(), behind, kEdge, 0).pixels) {
        EXPECT_EQ(value, 0.0F);
    }
}

}  // namespace lensproof::calibration::simulated_chart_test
