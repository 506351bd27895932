// The wave far from a point's image against closed forms.
#include "engine/analysis/edge_wave.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/optics/polygon_transform.h"
#include "engine/spectral/wavelengths.h"
#include "tests/engine/perfect_lens.h"

namespace lensproof::analysis::edge_wave_test {

constexpr double kBeamRadius = 0.5;
constexpr double kFocalLength = 50.0;
constexpr double kWavelength = 1e-6 * spectral::kLineD;
constexpr double kAiry = kWavelength * kFocalLength / (2.0 * kBeamRadius);  // λN, mm

/// f/50 without aberration: the sine condition, which a hyperboloid breaks, holds to sin²U = 1e-4.
EdgeWave perfect_wave(const optics::StopMask& mask, int pieces) {
    const PerfectLens perfect{.focal_length = kFocalLength,
                              .beam_radius = kBeamRadius,
                              .stop_distance = PerfectLens{}.telecentric_distance()};
    const optics::TraceLens<double> lens = optics::at_wavelength<double>(perfect.lens(), spectral::kLineD);
    return {optics::StopAim(lens, 0), mask, {.at = {0.0, 0.0, 1.0}, .is_far = true}, spectral::kLineD, pieces};
}

/// ∫ exp(−i k·x) over the opening, mm², to the irradiance on the film over the light's: |F|² / (λ f)², less what two
/// faces of index 1.5 reflect.
double focused(double transform) {
    return 0.96 * 0.96 * transform * transform / (kWavelength * kWavelength * kFocalLength * kFocalLength);
}

// Airy's amplitude, 2 J₁(v) / v, on bright rings; the pieces' chords lie 5e-6 of the radius inside the circle, a phase
// of 1e-3 at 60 λN.
TEST(EdgeWave, OfACircleIsAirys) {
    const EdgeWave wave = perfect_wave({}, 1024);
    for (const double ring : {5.75, 10.75, 30.75, 59.75}) {  // J₁ has its extremes near (n + 3/4) π
        const double v = std::numbers::pi * ring;
        const double airy = std::numbers::pi * kBeamRadius * kBeamRadius * 2.0 * std::cyl_bessel_j(1.0, v) / v;
        for (const double azimuth : {0.0, 2.0}) {
            const Vec2d place{ring * kAiry * std::cos(azimuth), ring * kAiry * std::sin(azimuth)};
            EXPECT_NEAR(wave.irradiance(place) / focused(airy), 1.0, 3e-3) << ring;
        }
    }
}

// The closed form of a polygon's far field, on its streaks and off them; to 3e-3 of the streak's envelope.
TEST(EdgeWave, OfBladesIsThePolygonsTransform) {
    const optics::StopMask mask(optics::PolygonStop{.blades = 5, .curvature = 0.0, .rotation_deg = 10.0});
    const EdgeWave wave = perfect_wave(mask, 5 * 16);
    std::vector<Vec2d> corners;
    for (int i = 0; i < 5; ++i) {
        const double azimuth = radians(10.0 + 72.0 * i);
        corners.push_back({kBeamRadius * std::cos(azimuth), kBeamRadius * std::sin(azimuth)});
    }
    const auto closed = [&](const Vec2d& place) {
        const double k = 2.0 * std::numbers::pi / (kWavelength * kFocalLength);
        return focused(std::abs(optics::polygon_transform(corners, k * place)));
    };
    for (double r = 5.0; r < 60.0; r += 3.1) {
        const auto at = [&](double azimuth_deg) {
            return Vec2d{r * kAiry * std::cos(radians(azimuth_deg)), r * kAiry * std::sin(radians(azimuth_deg))};
        };
        const double on_streak = closed(at(46.0));
        EXPECT_NEAR(wave.irradiance(at(46.0)) / on_streak, 1.0, 3e-3) << r;
        for (const double azimuth_deg : {20.0, 47.0, 250.0}) {
            EXPECT_NEAR(wave.irradiance(at(azimuth_deg)) / on_streak, closed(at(azimuth_deg)) / on_streak, 3e-3) << r;
        }
    }
}

TEST(EdgeWave, NeedsTheStopToBoundTheBeam) {
    PerfectLens perfect{.beam_radius = 45.0};  // beyond the lens's rim
    const optics::TraceLens<double> lens = optics::at_wavelength<double>(perfect.lens(), spectral::kLineD);
    EXPECT_THROW(EdgeWave(optics::StopAim(lens, 0), {}, {.at = {0.0, 0.0, 1.0}, .is_far = true}, 550.0, 16),
                 InputError);
}

}  // namespace lensproof::analysis::edge_wave_test
