// Rays that four wavelengths share outside the lens, against paths that belong to one.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/render/camera/camera.h"

namespace lensproof::shared_wavelengths_test {

/// Film irradiance in an even world of radiance 1, a wavelength each, with standard errors; and which fraction of
/// the paths' other wavelengths counted.
struct Sums {
    std::vector<double> mean;
    std::vector<double> error;
    double shared = 0.0;
};

/// Of a row of pixels, from their paths by heroes alone or by shared rays.
Sums irradiance(const std::string& name, const render::Sensor& sensor, bool is_shared) {
    constexpr std::uint32_t kSamples = 1U << 14U;
    const render::Camera camera(
        {.lens = name, .f_number = 4.0, .focus_distance_mm = 1e6, .sensor = sensor, .response = "luminance"},
        {.min_nm = 420.0, .max_nm = 680.0, .layers = 8, .strata_per_layer = 1}, {}, {});
    render::CameraPaths producer = camera.paths(3, render::PathCarry::wavelengths);
    render::CameraPathBuffer paths;
    std::vector<double> sum(8);
    std::vector<double> squares(8);
    std::int64_t counted = 0;
    std::int64_t others = 0;
    // The leftmost pixel of the middle row, far off the axis.
    producer.start({.first_pixel = static_cast<std::uint32_t>(sensor.height / 2 * sensor.width),
                    .pixels = 1,
                    .first_sample = 0,
                    .samples = kSamples});
    while (producer.fill(paths)) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(paths.size); ++i) {
            const spectral::PathWavelengths strata = camera.grid().path(paths.wavelength[i]);
            for (std::size_t m = 0; m < spectral::kWavelengthsPerPath; ++m) {
                const double hero = m == 0 ? 4.0 * paths.weight[i] : 0.0;
                const double value = is_shared ? static_cast<double>(paths.weights[i][m]) : hero;
                sum[strata.index[m]] += value;
                squares[strata.index[m]] += value * value;
                counted += m > 0 && paths.weights[i][m] > 0.0F ? 1 : 0;
                others += m > 0 ? 1 : 0;
            }
        }
    }
    Sums result{.mean = {}, .error = {}, .shared = static_cast<double>(counted) / static_cast<double>(others)};
    for (std::size_t k = 0; k < sum.size(); ++k) {
        // A sample's value is the mean over its four wavelengths, and has this one among them half of the time: four of
        // eight. So the irradiance is half of the mean of these values.
        const double mean = sum[k] / kSamples;
        result.mean.push_back(0.5 * mean);
        result.error.push_back(0.5 * std::sqrt((squares[k] / kSamples - mean * mean) / kSamples));
    }
    return result;
}

// Both are unbiased, so at each wavelength they agree within their errors: where pixels are so large that nearly all
// rays are shared; at the image circle's rim, where red has seven times the light of violet, so that rays are shared
// with wavelengths that draw hardly any there; and where the fisheye's colours part by more than a pixel, so that
// hardly any is.
TEST(SharedRays, CountEachWavelengthAsItsOwnPathsDo) {
    struct Case {
        const char* lens;
        double pitch_mm;
        int width;
        double least_shared;
        double most_shared;
    };
    for (const Case& c :
         {Case{"double-gauss-tronnier", 0.3, 101, 0.9, 1.0}, Case{"double-gauss-tronnier", 0.3, 185, 0.5, 0.9},
          Case{"muller-fisheye", 0.012, 1801, 0.0, 0.6}}) {
        const render::Sensor sensor{.width = c.width, .height = 3, .pixel_pitch_mm = c.pitch_mm};
        const Sums heroes = irradiance(c.lens, sensor, false);
        const Sums shared = irradiance(c.lens, sensor, true);
        fmt::print("{}: {:.1f} % shared; errors at the first wavelength {:.3f} and {:.3f} %\n", c.lens,
                   100.0 * shared.shared, 100.0 * heroes.error[0] / heroes.mean[0],
                   100.0 * shared.error[0] / shared.mean[0]);
        EXPECT_GE(shared.shared, c.least_shared) << c.lens;
        EXPECT_LE(shared.shared, c.most_shared) << c.lens;
        for (std::size_t k = 0; k < heroes.mean.size(); ++k) {
            EXPECT_GT(heroes.mean[k], 0.0);
            EXPECT_LT(heroes.error[k], 0.05 * heroes.mean[k]) << c.lens;
            EXPECT_NEAR(shared.mean[k], heroes.mean[k], 4.0 * std::hypot(shared.error[k], heroes.error[k]))
                << c.lens << ", wavelength " << k;
        }
    }
}

}  // namespace lensproof::shared_wavelengths_test
