// tests/calibration/comparison/same_places_test.cpp — patches of light and edges, as two registered pictures show them.
#include "calibration/comparison/same_places.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "calibration/self_test/simulated_chart.h"
#include "engine/base/angle.h"
#include "tests/calibration/sharpness/sharpness_edge.h"
#include "tests/complaint.h"

namespace lensproof::calibration::same_places_test {

/// An even ellipse of light on a plane, each pixel the mean of 8 × 8 places in it.
struct Ellipse {
    Vec2d middle{40.3, 37.8};
    double longer = 15.0;  // half axes, px
    double shorter = 11.0;
    double turn_deg = 25.0;
    std::array<double, 3> light{0.6, 0.4, 0.2};

    [[nodiscard]] double covers(int x, int y) const {
        constexpr int kPlaces = 8;
        const double c = std::cos(turn_deg * kDegree);
        const double s = std::sin(turn_deg * kDegree);
        int inside = 0;
        for (int i = 0; i < kPlaces * kPlaces; ++i) {
            const int row = i / kPlaces;
            const double dx = x - 0.5 + (i % kPlaces + 0.5) / kPlaces - middle.x;
            const double dy = y - 0.5 + (row + 0.5) / kPlaces - middle.y;
            inside += std::hypot((c * dx + s * dy) / longer, (c * dy - s * dx) / shorter) < 1.0 ? 1 : 0;
        }
        return static_cast<double>(inside) / (kPlaces * kPlaces);
    }

    [[nodiscard]] formats::Image picture(int width, int height) const {
        formats::Image image = formats::make_image(width, height, {"R", "G", "B"});
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const double covered = covers(x, y);
                for (int c = 0; c < 3; ++c) {
                    image.at(x, y, c) = static_cast<float>(0.05 + 0.0002 * x - 0.0001 * y +
                                                           light[static_cast<std::size_t>(c)] * covered);
                }
            }
        }
        return image;
    }
};

formats::Image noisy(formats::Image image, double noise, unsigned seed) {
    std::mt19937 chance(seed);
    std::normal_distribution<float> normal(0.0F, static_cast<float>(noise));
    for (float& value : image.pixels) {
        value += normal(chance);
    }
    return image;
}

const PixelRectangle kBox{.x = 4, .y = 4, .width = 72, .height = 68};

// A pixel's own width adds 1/12 px² to the variance along either axis, of 15²/4 and 11²/4: 0.07 and 0.14 % of the axes;
// places of an eighth of a pixel leave less.
TEST(LightSpot, OfAnEvenEllipseHasItsCentreItsAxesAndItsColour) {
    const Ellipse ellipse;
    const LightSpot spot = measure_spot(ellipse.picture(80, 76), kBox, 0.99);
    EXPECT_NEAR(spot.x_px.value, 40.3, 0.01);
    EXPECT_NEAR(spot.y_px.value, 37.8, 0.01);
    EXPECT_NEAR(spot.diameter_px.value, 2.0 * std::sqrt(15.0 * 11.0), 0.002 * 26.0);
    EXPECT_NEAR(spot.elongation.value, 15.0 / 11.0, 0.003);
    EXPECT_NEAR(spot.angle_deg.value, 25.0, 0.2);
    EXPECT_NEAR(spot.light[0].value, 0.6 * kPi * 15.0 * 11.0, 0.002 * 311.0);
    EXPECT_NEAR(spot.colour_ev(0, 1).value, std::log2(1.5), 0.002);
    EXPECT_EQ(spot.clipped_fraction, 0.0);
    EXPECT_GT(measure_spot(ellipse.picture(80, 76), kBox, 0.5).clipped_fraction, 0.9);
}

// Of 200 pictures 95 % intervals hold the truth, taken from a picture without noise, in 90 to 99 %: a binomial of 0.95
// leaves that range once in 640.
TEST(LightSpot, StatesItsErrors) {
    const Ellipse ellipse;
    const formats::Image picture = ellipse.picture(80, 76);
    const LightSpot truth = measure_spot(picture, kBox, 0.99);
    const std::array<std::function<Estimate(const LightSpot&)>, 7> quantities = {
        [](const LightSpot& s) { return s.x_px; },           [](const LightSpot& s) { return s.y_px; },
        [](const LightSpot& s) { return s.diameter_px; },    [](const LightSpot& s) { return s.elongation; },
        [](const LightSpot& s) { return s.angle_deg; },      [](const LightSpot& s) { return s.light[1]; },
        [](const LightSpot& s) { return s.colour_ev(2, 1); }};
    std::array<int, quantities.size()> held{};
    constexpr int kTrials = 200;
    for (unsigned seed = 0; seed < kTrials; ++seed) {
        const LightSpot spot = measure_spot(noisy(picture, 0.02, seed), kBox, 0.99);
        for (std::size_t q = 0; q < quantities.size(); ++q) {
            const Estimate found = quantities[q](spot);
            held[q] += std::abs(found.value - quantities[q](truth).value) < 1.96 * found.standard_error ? 1 : 0;
        }
    }
    for (std::size_t q = 0; q < held.size(); ++q) {
        EXPECT_GE(held[q], 180) << q;
        EXPECT_LE(held[q], 198) << q;
    }
}

TEST(LightSpot, RefusesBoxesWithoutLight) {
    const formats::Image picture = noisy(Ellipse{}.picture(80, 76), 0.02, 1);
    EXPECT_TRUE(says(complaint_about([&] {
                         measure_spot(picture, {70, 60, 20, 20}, 0.99);
                     }),
                     "the box 70,60,20,20 in a picture of 80 × 76 px"));
    EXPECT_TRUE(says(complaint_about([&] { measure_spot(picture, {0, 0, 9, 20}, 0.99); }), "of 10 px a side or more"));
    EXPECT_TRUE(says(complaint_about([&] { measure_spot(picture, {0, 0, 16, 16}, 0.99); }), "no light stands out"));
}

/// b shows what a shows, `enlarged` about the frame's middle and moved.
Registration similarity(double enlarged, const Vec2d& shift_px, int width, int height) {
    const double half = FrameScale(width, height).half_diagonal_px;
    return {.model = WarpModel::similarity,
            .warp = small_warp({shift_px.x / half, shift_px.y / half, enlarged - 1.0, 0.0, 0.0, 0.0, 0.0, 0.0})};
}

// A disc that is 10 % larger and lies 1.5 px further right than the registration has it, in half of the light and
// redder.
TEST(SamePlaces, ASpotIsToldWithoutTheRegistration) {
    const Vec2d middle = FrameScale(160, 120).middle_px;
    const Ellipse a{.middle = {60.0, 50.0}, .longer = 12.0, .shorter = 12.0};
    Ellipse b = a;
    b.middle = {middle.x + 1.25 * (a.middle.x - middle.x) + 3.0 + 1.5, middle.y + 1.25 * (a.middle.y - middle.y) - 2.0};
    b.longer = b.shorter = 1.1 * 1.25 * 12.0;
    b.light = {0.3 * 1.2, 0.2, 0.1};
    const ExposureMatch exposure{.is_matched = true, .gains = {{2.0, 0.0}, {2.0, 0.0}, {2.0, 0.0}}};
    const SpotPair pair =
        compare_spots(a.picture(160, 120), b.picture(160, 120), similarity(1.25, {3.0, -2.0}, 160, 120), exposure,
                      {.a = 0.99, .b = 0.99}, {38, 30, 44, 42});
    EXPECT_NEAR(pair.shift_x_px.value, 1.5, 0.02);
    EXPECT_NEAR(pair.shift_y_px.value, 0.0, 0.02);
    EXPECT_NEAR(pair.diameter_ratio.value, 1.1, 0.002);
    // Twice the half of the light, over 1.1² of the area: red 1.2 times as much.
    EXPECT_NEAR(pair.light_ev.value, std::log2(1.21 * (0.72 + 0.4 + 0.2) / 1.2), 0.005);
    EXPECT_NEAR(pair.colour_ev[0].value, std::log2(1.2), 0.003);
    EXPECT_EQ(pair.colour_ev[1].value, 0.0);
    EXPECT_NEAR(pair.colour_ev[2].value, 0.0, 0.003);
}

// The same squares, a tenth larger and more blurred: both MTFs are those of the closed form in the first picture's
// pixels. Single edges are good to 2.5 %, of which there are more than eighty.
TEST(SamePlaces, EdgesAreToldInThePixelsOfTheFirst) {
    using namespace synthetic;
    const auto seen = [](double focal_px, double blur_px, unsigned seed) {
        SimulatedCamera camera{.model = BrownConrady{{focal_px, 319.5, 239.5, 0, 0, 0, 0, 0}},
                               .width_px = 640,
                               .height_px = 480,
                               .channels = {{.name = "G"}}};
        camera.blur_px = blur_px;
        camera.read_noise = 0.004;
        const scene::Chart squares{.pattern = scene::SlantedEdges{7, 5, 60.0, 34.0, 6.0}};
        return simulate_chart(camera, {{0.02, -0.03, 0.0}, {0.0, 0.0, 600.0}}, squares, seed);
    };
    const formats::Image a = seen(820.0, 0.8, 3);
    const formats::Image b = seen(902.0, 1.6, 4);
    const SharpnessComparison found = compare_sharpness(a, b, similarity(1.1, {0.0, 0.0}, 640, 480), {});
    EXPECT_GT(found.pairs.size(), 40u);
    const double truth =
        1.1 * true_frequency(gaussian_blur(1.6), 6.0, 0.5) / true_frequency(gaussian_blur(0.8), 6.0, 0.5);
    EXPECT_NEAR(found.mtf50_ratio.value / truth, 1.0, 0.02);
    EXPECT_LT(found.mtf50_ratio.standard_error, 0.02 * truth);
    EXPECT_NEAR(found.mtf_a[0], 1.0, 0.02);
    for (std::size_t i = 0; i < found.mtf_a.size(); ++i) {
        EXPECT_NEAR(found.mtf_b[i] - found.mtf_a[i], found.difference[i].value, 1e-12);
    }
    EXPECT_LT(found.difference[10].value, -5.0 * found.difference[10].standard_error);  // at 0.2 cycles per pixel
    EXPECT_TRUE(says(complaint_about([&] {
                         compare_sharpness(a, b, similarity(1.1, {0.0, 0.0}, 640, 480), {{0, 0, 30, 30}});
                     }),
                     "the edge in 0,0,30,30"));
}

}  // namespace lensproof::calibration::same_places_test
