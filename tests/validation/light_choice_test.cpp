// Which of many lights a surface point samples, and that it makes no difference but of noise.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "engine/base/angle.h"
#include "engine/render/sampling/path_sampler.h"
#include "engine/scene/light/light.h"
#include "tests/validation/small_scene.h"

namespace lensproof::light_choice_test {

const spectral::SpectralGrid kGrid = spectral::spectral_grid(420.0, 680.0, 16);
constexpr double kSky = 0.01;  // radiance

/// A row of lamps, each as bright, 500 mm above the plane z = 0 and 1 m apart, of which the first stands over the
/// origin; under a sky or not.
struct Row {
    explicit Row(int lamps, bool has_sky) : parts(kGrid) {
        constexpr double kRadius_mm = 20.0;
        constexpr double kAbove_mm = 500.0;
        constexpr double kRadiance = 3.0;
        for (int i = 0; i < lamps; ++i) {
            const Vec3d at{1000.0 * i, 0.0, kAbove_mm};
            parts.lights.emplace_back(scene::AreaLight{
                .object = parts.add(scene::Sphere{kRadius_mm}, {.linear = kIdentity3, .translation = at}, 0.0),
                .radiance = spectral::constant_spectrum(kRadiance, kGrid)});
            // π L (r/d)² cos θ of a sphere above the horizon.
            const double distance2 = dot(at, at);
            irradiance.push_back(kPi * kRadiance * kRadius_mm * kRadius_mm / distance2 * kAbove_mm /
                                 std::sqrt(distance2));
        }
        if (has_sky) {
            parts.lights.emplace_back(scene::ConstantLight{spectral::constant_spectrum(kSky, kGrid)});
            irradiance.push_back(kPi * kSky);
        }
    }

    SceneParts parts;
    std::vector<double> irradiance;  // on the plane at the origin, of each light
};

struct Found {
    double mean = 0.0;
    double variance = 0.0;  // of one sample
};

/// Of the plane's irradiance at the origin; a point of it passes on light as a matt surface does.
Found estimated(Row& row, int samples) {
    const scene::Scene scene = row.parts.scene();
    render::PathSampler numbers(1, 2, 3);
    Found found;
    double squares = 0.0;
    for (int i = 0; i < samples; ++i) {
        const auto u = numbers.next();
        const auto sample = scene.lights.sample({}, kGrid.path(i % kGrid.size()), {u[0], {u[1], u[2]}},
                                                [](const Vec3d& direction) { return std::max(0.0, direction.z); });
        const double light = sample ? std::max(0.0, sample->value[0] * sample->direction.z) : 0.0;
        found.mean += light / samples;
        squares += light * light / samples;
    }
    found.variance = squares - found.mean * found.mean;
    return found;
}

double sum_of(const std::vector<double>& terms) {
    return std::accumulate(terms.begin(), terms.end(), 0.0);
}

/// Of one sample, if light i is drawn with probability(i): Σ Eᵢ²/pᵢ − E².
template <class Probability>
double expected_variance(const std::vector<double>& irradiance, const Probability& probability) {
    double squares = 0.0;
    for (const double light : irradiance) {
        squares += light * light / probability(light);
    }
    return squares - sum_of(irradiance) * sum_of(irradiance);
}

// A tenth of the samples goes evenly, the others by what arrives. 3 %: cones of 2.3° have cosines of their own, and so
// many samples their noise.
TEST(Lights, APointSamplesMostWhatItPassesOnMost) {
    constexpr int kSamples = 400000;
    Row row(40, false);
    const Found found = estimated(row, kSamples);
    const double all = sum_of(row.irradiance);
    EXPECT_NEAR(found.mean, all, 5.0 * std::sqrt(found.variance / kSamples));
    const double expected =
        expected_variance(row.irradiance, [&](double light) { return 0.1 / 40 + 0.9 * light / all; });
    EXPECT_NEAR(found.variance, expected, 0.03 * expected);
    EXPECT_LT(found.variance, 0.01 * expected_variance(row.irradiance, [](double) { return 1.0 / 40; }));
}

// The sky lights from no one direction, and is drawn by power beside them.
TEST(Lights, ASkyBesideLampsIsNotForgotten) {
    constexpr int kSamples = 400000;
    Row row(5, true);
    const Found found = estimated(row, kSamples);
    EXPECT_NEAR(found.mean, sum_of(row.irradiance), 5.0 * std::sqrt(found.variance / kSamples));
    EXPECT_GT(kPi * kSky, 50.0 * std::sqrt(found.variance / kSamples));  // which its absence would show
}

// As light paths do, where there are too many to ask for each. 5 %: of the samples 5000 are of the lamp overhead, which
// gives nearly all of the variance, so that it is known to 1.4 %.
TEST(Lights, MoreOfThemThanAreWeighedLightAsMuch) {
    constexpr int kSamples = 400000;
    Row row(80, false);
    const Found found = estimated(row, kSamples);
    EXPECT_NEAR(found.mean, sum_of(row.irradiance), 5.0 * std::sqrt(found.variance / kSamples));
    const double expected = expected_variance(row.irradiance, [](double) { return 1.0 / 80; });
    EXPECT_NEAR(found.variance, expected, 0.05 * expected);
}

}  // namespace lensproof::light_choice_test
