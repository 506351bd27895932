// Rings in a flat field: pupil maps are made of pieces, and no piece may show.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/optics/illumination.h"
#include "engine/render/camera/lens_paths.h"

namespace lensproof::ring_spectrum_test {

constexpr std::uint32_t kPixels = 2000;  // of the picture's side
constexpr int kRings = 900;  // a pixel wide each, from 50 pixels on: farther in there are few paths to a ring
constexpr int kFirstRing = 50;
constexpr int kSamples = 4;       // of each pixel
constexpr int kReferences = 181;  // of the smooth curve beneath
const std::vector<double> kWavelengths = {450.0, 550.0, 650.0};

/// How much brighter than it should be a flat field is, ring by ring, and how sure that is.
struct RingProfile {
    std::vector<double> excess;  // relative
    std::vector<double> weight;  // 1 / variance
};

/// The mean over the wavelengths of what an even scene yields, by quadrature of the bundle.
std::vector<double> expected_by_radius(const optics::SpectralLens<double>& lens, double step_mm) {
    std::vector<double> expected;
    for (int i = 0; i < kReferences; ++i) {
        double sum = 0.0;
        for (const optics::TraceLens<double>& at : lens.at()) {
            sum += optics::image_bundle(at, i * step_mm).transmitted / lens.wavelengths();
        }
        expected.push_back(sum);
    }
    return expected;
}

RingProfile flat_field(const optics::SpectralLens<double>& lens, double half_side_mm) {
    const pupil::PupilMap map(lens.at(), true, half_side_mm * std::numbers::sqrt2);
    const pupil::PupilSlices slices(map, lens.wavelengths());
    const render::Sensor sensor{.width = kPixels, .height = kPixels, .pixel_pitch_mm = 2.0 * half_side_mm / kPixels};
    render::LensPaths producer({.sensor = sensor, .seed = 3}, lens, slices);
    producer.start({.first_pixel = 0, .pixels = kPixels * kPixels, .first_sample = 0, .samples = kSamples});

    const double step_mm = half_side_mm / (kReferences - 1);
    const std::vector<double> expected = expected_by_radius(lens, step_mm);
    const auto expected_at = [&](double r) {
        const auto i = std::min(static_cast<std::size_t>(r / step_mm), expected.size() - 2);
        return std::lerp(expected[i], expected[i + 1], r / step_mm - static_cast<double>(i));
    };
    // A pixel belongs to the ring that its middle lies in, so that each ring's number of samples is known.
    const auto ring_of = [&](std::uint32_t pixel) {
        const std::uint32_t row = pixel / kPixels;
        const Vec2d middle = sensor.position(pixel % kPixels, row);
        return static_cast<std::size_t>(std::hypot(middle.x, middle.y) / sensor.pixel_pitch_mm);
    };
    std::vector<double> samples(std::size_t{2} * kPixels);
    for (std::uint32_t pixel = 0; pixel < kPixels * kPixels; ++pixel) {
        samples[ring_of(pixel)] += kSamples;
    }
    std::vector<double> sum(samples.size());
    std::vector<double> sum_of_squares(samples.size());
    render::CameraPathBuffer paths;
    while (producer.fill(paths)) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(paths.size); ++i) {
            const std::size_t ring = ring_of(paths.pixel[i]);
            const double r = std::hypot(paths.film_x[i], paths.film_y[i]);
            if (ring < kFirstRing + kRings) {
                const double ratio = paths.weight[i] / expected_at(r);
                sum[ring] += ratio;
                sum_of_squares[ring] += ratio * ratio;
            }
        }
    }
    RingProfile profile;
    for (std::size_t ring = kFirstRing; ring < kFirstRing + kRings; ++ring) {
        const double mean = sum[ring] / samples[ring];
        profile.excess.push_back(mean - 1.0);
        profile.weight.push_back(samples[ring] / (sum_of_squares[ring] / samples[ring] - mean * mean));
    }
    return profile;
}

/// The largest amplitude of any number of rings between 2 and half as many as there are pixels, over its standard
/// error.
struct Peak {
    double amplitude = 0.0;
    double sigmas = 0.0;
    int rings = 0;
};

Peak largest_ring(const RingProfile& profile) {
    double weights = 0.0;
    double mean = 0.0;
    for (std::size_t i = 0; i < profile.excess.size(); ++i) {
        weights += profile.weight[i];
        mean += profile.weight[i] * profile.excess[i];
    }
    mean /= weights;
    Peak peak;
    for (int rings = 2; rings < kRings / 2; ++rings) {
        double cosine = 0.0;
        double sine = 0.0;
        for (std::size_t i = 0; i < profile.excess.size(); ++i) {
            const double phase = 2.0 * std::numbers::pi * rings * static_cast<double>(i) / kRings;
            cosine += profile.weight[i] * (profile.excess[i] - mean) * std::cos(phase);
            sine += profile.weight[i] * (profile.excess[i] - mean) * std::sin(phase);
        }
        const double amplitude = 2.0 * std::hypot(cosine, sine) / weights;
        if (amplitude > peak.amplitude) {
            peak = {.amplitude = amplitude, .sigmas = amplitude / std::sqrt(2.0 / weights), .rings = rings};
        }
    }
    return peak;
}

// Of 450 amplitudes that are noise alone, each with a Rayleigh distribution, the largest is beyond five standard errors
// once in 600 runs; rings of 0.1 % are not seen by any eye (the contrast sensitivity of the eye is 0.3 % at best) and
// are found here all the same.
TEST(PupilMap, ShowsNoRingsInAFlatField) {
    for (const auto& [name, f_number, half_side_mm] :
         {std::tuple{"tessar", 2.8, 40.0}, std::tuple{"muller-fisheye", 4.0, 11.5}}) {
        const optics::Lens lens = optics::focused_at(optics::with_f_number(formats::load_lens(name), f_number), 1e4);
        RingProfile profile = flat_field(optics::at_wavelengths<double>(lens, kWavelengths), half_side_mm);
        const Peak found = largest_ring(profile);
        RecordProperty(std::string(name) + "_ring_amplitude_percent", std::to_string(100.0 * found.amplitude));
        EXPECT_LT(found.sigmas, 5.0) << name << ": " << found.rings << " rings of " << found.amplitude;
        EXPECT_LT(found.amplitude, 1e-3) << name << ": " << found.rings << " rings";
        for (std::size_t i = 0; i < profile.excess.size(); ++i) {
            profile.excess[i] += 1e-3 * std::sin(2.0 * std::numbers::pi * 40.0 * static_cast<double>(i) / kRings);
        }
        const Peak planted = largest_ring(profile);
        EXPECT_EQ(planted.rings, 40) << name;
        EXPECT_NEAR(planted.amplitude, 1e-3, 3e-4) << name;
    }
}

}  // namespace lensproof::ring_spectrum_test
