#include "calibration/sharpness/sharpness_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "tests/calibration/synthetic.h"

namespace lensproof::calibration::sharpness_field_test {

constexpr Vec2d kCentre{500.0, 400.0};
constexpr double kHalfDiagonal = 640.0;

using Blur2 = std::function<double(double height)>;  // variance in units of 1/MTF50²

// Edges in four directions at every point of a grid, MTF50 known to 1 %.
std::vector<EdgeMtf> edges_of(const Blur2& tangential, const Blur2& sagittal, double relative_noise,
                              synthetic::Noise& noise) {
    std::vector<EdgeMtf> edges;
    for (int y = 40; y < 800; y += 90) {
        for (int x = 40; x < 1000; x += 90) {
            const double dx = x - kCentre.x;
            const double dy = y - kCentre.y;
            const double h = std::hypot(dx, dy) / kHalfDiagonal;
            for (const double normal_deg : {5.0, 95.0, -175.0, -85.0}) {
                const double phi = radians(normal_deg) - std::atan2(dy, dx);
                const double b = tangential(h) * std::pow(std::cos(phi), 2) + sagittal(h) * std::pow(std::sin(phi), 2);
                const double f = (1.0 + relative_noise * noise()) / std::sqrt(b);
                EdgeMtf edge{.centre_px = {static_cast<double>(x), static_cast<double>(y)}, .normal_deg = normal_deg};
                edge.mtf50 = MtfFrequency{f, 0.01 * f, 0.0, 0.0};
                edges.push_back(edge);
            }
        }
    }
    return edges;
}

double mtf50(const Blur2& blur, double height) {
    return 1.0 / std::sqrt(blur(height));
}

// Astigmatism that grows with r², coma-like r⁴: both directions come apart, each within its band in 95 % of 300 sets of
// edges (binomial standard deviation 1.3 %; the number of terms is chosen by the same data), and within 2 %.
TEST(CalibrationSharpnessField, TangentialAndSagittalComeApart) {
    const Blur2 tangential = [](double h) { return 9.0 + 60.0 * h * h + 20.0 * std::pow(h, 4); };
    const Blur2 sagittal = [](double h) { return 9.0 + 12.0 * h * h; };
    synthetic::Noise noise(11);
    constexpr int trials = 300;
    int covered[4] = {0, 0, 0, 0};
    for (int trial = 0; trial < trials; ++trial) {
        const auto field = fit_sharpness_field(edges_of(tangential, sagittal, 0.01, noise), kCentre, kHalfDiagonal);
        int k = 0;
        for (const double height : {0.3, 0.8}) {
            for (const bool is_tangential : {true, false}) {
                const Banded band =
                    sample(is_tangential ? field.tangential_cycles_per_px : field.sagittal_cycles_per_px, height)
                        .value();
                const double truth = mtf50(is_tangential ? tangential : sagittal, height);
                EXPECT_NEAR(band.value / truth, 1.0, 0.02);
                covered[k++] += truth > band.lower_95 && truth < band.upper_95 ? 1 : 0;
            }
        }
    }
    for (const int count : covered) {
        EXPECT_GE(count, 0.91 * trials);
        EXPECT_LE(count, 0.985 * trials);
    }
}

// With no astigmatism the two are the same, and their ratio is 1 within its band.
TEST(CalibrationSharpnessField, WithoutAstigmatismTheRatioIsOne) {
    const Blur2 round = [](double h) { return 9.0 + 10.0 * h * h; };
    synthetic::Noise noise(5);
    const auto field = fit_sharpness_field(edges_of(round, round, 0.0, noise), kCentre, kHalfDiagonal);
    for (const double value : field.tangential_over_sagittal.value) {
        EXPECT_NEAR(value, 1.0, 1e-9);
    }
    EXPECT_EQ(field.tangential_over_sagittal.value.size(), field.sagittal_cycles_per_px.value.size());
}

// A smudged print here and there (a third of the sharpness) is left out.
TEST(CalibrationSharpnessField, OutliersAreLeftOut) {
    const Blur2 round = [](double) { return 9.0; };
    synthetic::Noise noise(6);
    auto edges = edges_of(round, round, 0.01, noise);
    for (std::size_t i = 7; i < edges.size(); i += 29) {
        edges[i].mtf50->cycles_per_px /= 3.0;
    }
    const auto field = fit_sharpness_field(edges, kCentre, kHalfDiagonal);
    EXPECT_NEAR(sample(field.tangential_cycles_per_px, 0.5)->value, 1.0 / 3.0, 0.005);
    EXPECT_LT(field.edges_used, static_cast<int>(edges.size()));
    EXPECT_LT(field.relative_rms, 0.015);
}

TEST(CalibrationSharpnessField, TooFewEdgesAreRefused) {
    EXPECT_THROW(fit_sharpness_field({}, kCentre, kHalfDiagonal), InputError);
    EXPECT_THROW(fit_sharpness_field(std::vector<EdgeMtf>(20), kCentre, kHalfDiagonal), InputError);
}

// A Petzval surface with astigmatism: focus moves by −0.3 h² mm tangentially and −0.1 h² mm sagittally. Blur is a disc
// whose diameter grows by one pixel per 0.05 mm, over a Gaussian: 1/MTF50² of both in quadrature.
constexpr double kBestOnAxis_mm = 0.07;

std::vector<FocusedEdges> focus_series(synthetic::Noise& noise) {
    std::vector<FocusedEdges> series;
    for (int i = -4; i <= 4; ++i) {
        const double z = 0.12 * i;
        const auto blur = [&](double curvature_mm) {
            return [=](double h) { return 9.0 + 1500.0 * std::pow(z - kBestOnAxis_mm - curvature_mm * h * h, 2); };
        };
        series.push_back({z, edges_of(blur(-0.3), blur(-0.1), 0.01, noise)});
    }
    return series;
}

TEST(CalibrationSharpnessField, BestFocusFollowsTheFieldsCurvature) {
    synthetic::Noise noise(8);
    constexpr int trials = 60;
    int covered[3] = {0, 0, 0};
    for (int trial = 0; trial < trials; ++trial) {
        const BestFocus focus = fit_best_focus(focus_series(noise), kCentre, kHalfDiagonal);
        const auto within = [](double truth, double lower, double upper) { return truth > lower && truth < upper; };
        const Banded t = sample(focus.tangential_mm, 0.8).value();
        const Banded s = sample(focus.sagittal_mm, 0.8).value();
        EXPECT_NEAR(focus.axis_position_mm, kBestOnAxis_mm, 5e-3);
        EXPECT_NEAR(t.value, -0.3 * 0.64, 0.01);
        EXPECT_NEAR(s.value, -0.1 * 0.64, 0.01);
        covered[0] += within(-0.3 * 0.64, t.lower_95, t.upper_95) ? 1 : 0;
        covered[1] += within(-0.1 * 0.64, s.lower_95, s.upper_95) ? 1 : 0;
        covered[2] += std::abs(focus.axis_position_mm - kBestOnAxis_mm) < k95 * focus.axis_standard_error_mm ? 1 : 0;
    }
    for (const int count : covered) {  // 57 of 60 expected, standard deviation 1.7
        EXPECT_GE(count, 52);
    }
}

TEST(CalibrationSharpnessField, AFocusSeriesNeedsThreePositionsAboutTheFocus) {
    synthetic::Noise noise(9);
    auto series = focus_series(noise);
    EXPECT_THROW(fit_best_focus({series[0], series[1]}, kCentre, kHalfDiagonal), InputError);
    const Blur2 flat = [](double) { return 9.0; };
    std::vector<FocusedEdges> unmoved;
    for (const double z : {0.0, 1.0, 2.0, 3.0}) {
        unmoved.push_back({z, edges_of(flat, flat, 0.01, noise)});
    }
    EXPECT_THROW(fit_best_focus(unmoved, kCentre, kHalfDiagonal), InputError);
}

}  // namespace lensproof::calibration::sharpness_field_test
