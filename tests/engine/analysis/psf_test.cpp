// Point spread functions against Airy's pattern, conservation of energy, and each other.
#include "engine/analysis/psf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/spectral/wavelengths.h"
#include "tests/engine/analysis/analysis_field.h"
#include "tests/engine/perfect_lens.h"

namespace lensproof::analysis::psf_test {

/// f/50: the sine condition, which a hyperboloid breaks, holds to sin²U = 1e-4, and the beam is a circle in direction
/// cosines.
optics::Lens slow_lens() {
    return PerfectLens{.beam_radius = 0.5, .stop_distance = PerfectLens{}.telecentric_distance()}.lens();
}

/// Half the beam's width in direction cosines.
double sine(const PolychromaticField& field) {
    return 0.5 * cosine_box(field, field.parts.front()).width();
}

/// (2 J₁(v) / v)², v = 2π r sin U / λ (Airy 1835; Born & Wolf 8.5.2).
double airy(double r_um, double sine) {
    const double v = 2.0 * std::numbers::pi * r_um * sine / (spectral::kLineD * 1e-3);
    const double amplitude = v > 0.0 ? 2.0 * std::cyl_bessel_j(1.0, v) / v : 1.0;
    return amplitude * amplitude;
}

double total(const Psf& psf) {
    return std::accumulate(psf.irradiance.begin(), psf.irradiance.end(), 0.0) * psf.pixel_um * psf.pixel_um;
}

// Errors: the cells at the rim, whose fraction is known to 1/64 each, 256 of them with random signs: 1e-4 of the peak;
// the sine condition: 1e-4.
TEST(Psf, FftOfAPerfectPupilIsAirys) {
    const PolychromaticField field = field_of(slow_lens(), 0.0);
    // 64 samples across the pupil.
    const Psf psf = fft_psf(field, {.size = 256, .pixel_um = 0.25 * spectral::kLineD * 1e-3 / (2.0 * sine(field))});
    ASSERT_EQ(psf.status, PupilStatus::ok);
    // The peak of a disc of area a in direction cosines: a / λ².
    const double area = std::numbers::pi * sine(field) * sine(field);
    EXPECT_NEAR(psf.perfect_peak * spectral::kLineD * spectral::kLineD * 1e-6 / area, 1.0, 3e-4);
    EXPECT_NEAR(psf.strehl, 1.0, 1e-9);
    for (int row = 80; row < 176; ++row) {
        for (int column = 80; column < 176; ++column) {
            const double r = std::hypot(psf.position_um(row), psf.position_um(column));
            EXPECT_NEAR(psf.at(row, column) / psf.perfect_peak, airy(r, sine(field)), 3e-4) << r;
        }
    }
    // 1 − J₀² of the light lies within the first dark ring, 1.2197 λN (Rayleigh; Born & Wolf 8.5.2): 83.8 %. Pixels of
    // an eighth of λN: the ring is dark, so that its place does not matter, but for the far light that the window
    // loses.
    const double ring = 1.219670 * spectral::kLineD * 1e-3 / (2.0 * sine(field));
    const double dark = std::cyl_bessel_j(0.0, 3.8317059702);
    double energy = 0.0;
    for (int row = 0; row < psf.size; ++row) {
        for (int column = 0; column < psf.size; ++column) {
            const bool is_inside = std::hypot(psf.position_um(row), psf.position_um(column)) <= ring;
            energy += is_inside ? psf.at(row, column) * psf.pixel_um * psf.pixel_um : 0.0;
        }
    }
    EXPECT_NEAR(energy, 1.0 - dark * dark, 1e-3);
    EXPECT_NEAR(airy(ring, sine(field)), 0.0, 1e-12);
}

// Gauss-Legendre and even azimuths are exact far beyond the sine condition's 1e-4.
TEST(Psf, HuygensSumOfAPerfectPupilIsAirys) {
    const PolychromaticField field = field_of(slow_lens(), 0.0);
    const Psf psf = huygens_psf(field, {.size = 32, .pixel_um = 5.0, .azimuths = 48, .rings = 16});
    ASSERT_EQ(psf.status, PupilStatus::ok);
    for (int row = 0; row < 32; ++row) {
        for (int column = 0; column < 32; ++column) {
            const double r = std::hypot(psf.position_um(row), psf.position_um(column));
            EXPECT_NEAR(psf.at(row, column) / psf.perfect_peak, airy(r, sine(field)), 1e-4) << r;
        }
    }
}

constexpr Case kCases[] = {{"tessar", 8.0, 0.0},
                           {"tessar", 8.0, 15.0},
                           {"double-gauss-tronnier", 0.0, 0.0},
                           {"double-gauss-tronnier", 8.0, 18.0},
                           {"muller-fisheye", 0.0, 70.0},
                           {"fisheye-220", 8.0, 95.0},
                           {"muller-fisheye", 5.6, 75.5},  // whose chief ray a rim clips
                           {kMirror, 0.0, 0.3},
                           {kSensorInGlass, 12.0, 12.0}};

class PsfOfLens : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Cases, PsfOfLens, testing::ValuesIn(kCases));

// The largest fraction of the perfect peak by which FFT and Huygens sum may differ. At the rim the FFT takes a cell's
// phase in its middle, not in the middle of its open part: with s the cell's size and k ε the phase's slope, the sum
// along the rim is wrong by ∮ k ε s²/24, k ε sin U / (3 M²) of the whole, and twice that in irradiance.
double sampling_error(const PolychromaticField& field, const Psf& psf, double samples, double reach_um) {
    const double phase = 2.0 * std::numbers::pi / (field.parts.front().wavelength_nm * 1e-3) * sine(field) *
                         (psf.largest_aberration_um + reach_um);
    return 2.0 * phase / (3.0 * samples * samples) + 3e-4;
}

// With plane waves instead of spherical ones both sum the same field; with the exit pupil's sphere the aperture is
// wider by u − d = c ε (the unit vectors to the image point, and along the ray), so the irradiance differs by 2 c ε /
// sin U.
TEST_P(PsfOfLens, FftAndHuygensSumAgree) {
    const Case& c = GetParam();
    PolychromaticField field = field_of(lens_of(c), c.field_deg * kDegree);
    const double curvature = field.sphere.curvature;
    for (const bool from_exit_pupil : {false, true}) {
        field.sphere.curvature = from_exit_pupil ? curvature : 0.0;
        const Psf fft = fft_psf(field, {.size = 256});
        ASSERT_EQ(fft.status, PupilStatus::ok) << c.lens << " " << c.field_deg;
        constexpr int kSize = 16;
        const Psf sum =
            huygens_psf(field, {.size = kSize, .pixel_um = 2.0 * fft.pixel_um, .azimuths = 64, .rings = 32});
        double scale = 0.0;
        if (from_exit_pupil) {
            scale = 2.0 * std::abs(curvature) * fft.largest_aberration_um * 1e-3 / sine(field);
        }
        const double top = std::ranges::max(fft.irradiance) / fft.perfect_peak;
        const double tolerance = sampling_error(field, fft, 128.0, kSize * fft.pixel_um) + scale * top;
        for (int row = 0; row < kSize; ++row) {
            for (int column = 0; column < kSize; ++column) {
                EXPECT_NEAR(sum.at(row, column) / fft.perfect_peak,
                            fft.at(2 * row + 128 - kSize, 2 * column + 128 - kSize) / fft.perfect_peak, tolerance)
                    << c.lens << " f/" << c.f_number << " " << c.field_deg << " " << row << " " << column;
            }
        }
        EXPECT_NEAR(sum.strehl, fft.strehl, tolerance + scale * top);
        EXPECT_NEAR(sum.perfect_peak / fft.perfect_peak, 1.0, scale + 1e-3);
    }
}

// Parseval: what the picture holds is the pupil's own sum; and that is the beam's cross-section.
TEST_P(PsfOfLens, ConservesEnergy) {
    const Case& c = GetParam();
    const PolychromaticField field = field_of(lens_of(c), c.field_deg * kDegree);
    const Psf psf = fft_psf(field, {.size = 128});
    const double spacing = 1e-6 * spectral::kLineD / (psf.size * psf.pixel_um * 1e-3);  // as fft_psf has it
    const SampledPupil pupil = sample_pupil(field, field.parts.front(), spacing);
    double squares = 0.0;
    for (const double amplitude : pupil.amplitude) {
        squares += amplitude * amplitude;
    }
    EXPECT_NEAR(total(psf), squares * spacing * spacing / pupil.energy, 1e-12);
    // What is missing lies beyond the window, 32 λN to each side: of a disc's light 2 / (π v) beyond v = 32 π (Born
    // & Wolf 8.5.2), 0.6 % for each of its sides, and more across a slim pupil.
    EXPECT_LT(total(psf), 1.0);
    EXPECT_GT(total(psf), 0.93);
    // The rim's cells, known to 1/64: 1e-3 where the rim is bent by less than a cell.
    EXPECT_NEAR(pupil.energy / field.parts.front().outline.area, 1.0, 1e-3) << c.lens << " " << c.field_deg;
}

// The centroid of the irradiance is the rays' (the mean of the phase's gradient), so the picture is the right way up.
// The window cuts the far light, even from place to place, and with it a part of the centroid of the order of that
// fraction.
TEST_P(PsfOfLens, CentroidIsThatOfTheRays) {
    const Case& c = GetParam();
    const PolychromaticField field = field_of(lens_of(c), c.field_deg * kDegree);
    const Psf psf = fft_psf(field, {.size = 256});
    Vec2d mean{};
    const double all = total(psf) / (psf.pixel_um * psf.pixel_um);
    for (int row = 0; row < psf.size; ++row) {
        for (int column = 0; column < psf.size; ++column) {
            mean.x += psf.at(row, column) * psf.position_um(column) / all;
            mean.y += psf.at(row, column) * psf.position_um(row) / all;
        }
    }
    double rays = 0.0;
    double energy = 0.0;
    for (const optics::RegionNode& node : optics::region_quadrature(field.parts.front().outline, 10)) {
        rays += 1e3 * node.weight * image_ray(field.parts.front(), field, node.point)->aberration.y;
        energy += node.weight;
    }
    EXPECT_NEAR(mean.x, 0.0, 0.02);
    EXPECT_NEAR(mean.y, rays / energy, 0.02 * std::abs(rays / energy) + 0.03) << c.lens << " " << c.field_deg;
}

// Maréchal: S = exp(−(2πσ)²) for small σ, up to terms of the order (2πσ)³ of the wavefront's skewness and (2πσ)⁴ (Ross,
// Appl. Opt. 48, 1812 (2009)).
TEST(Psf, StrehlRatioIsMarechals) {
    for (const double spherical : {2e-7, 4e-7, -4e-7}) {
        const PerfectLens perfect{
            .beam_radius = 4.0, .stop_distance = PerfectLens{}.telecentric_distance(), .spherical = spherical};
        const PolychromaticField field = field_of(perfect.lens(), 0.0);
        const PolychromaticField::Part& part = field.parts.front();
        const double sigma = wavefront_errors(wavefront(part.lens, spectral::kLineD, field.bundle, field.sphere,
                                                        optics::region_quadrature(part.outline, 8)))
                                 .rms_without_tilt;
        ASSERT_GT(sigma, 0.01);
        const double phase = 2.0 * std::numbers::pi * sigma;
        EXPECT_NEAR(fft_psf(field, {.size = 128}).strehl, std::exp(-phase * phase), std::pow(phase, 3) + 1e-4) << sigma;
    }
}

// Wavelengths add up on one grid about one image point.
TEST(Psf, WavelengthsAddUp) {
    const optics::Lens lens = optics::with_f_number(formats::load_lens("biotar"), 8.0);
    const PolychromaticField both = field_of(lens, 0.1, {{spectral::kLineF, 1.0}, {spectral::kLineC, 3.0}});
    const FftPsfSettings settings{.size = 128, .pixel_um = 1.5};
    const Psf sum = fft_psf(both, settings);
    const Psf blue = fft_psf(field_of(lens, 0.1, {{spectral::kLineF, 1.0}}), settings);
    const Psf red = fft_psf(field_of(lens, 0.1, {{spectral::kLineC, 1.0}}), settings);
    ASSERT_EQ(sum.status, PupilStatus::ok);
    const double weight = both.parts.front().weight;
    EXPECT_NEAR(weight, 0.25, 0.01);
    for (std::size_t i = 0; i < sum.irradiance.size(); i += 7) {
        EXPECT_NEAR(sum.irradiance[i], weight * blue.irradiance[i] + (1.0 - weight) * red.irradiance[i],
                    1e-12 * sum.perfect_peak);
    }
}

TEST(Psf, SaysWhatItCannotSample) {
    const PolychromaticField wide = field_of(optics::with_f_number(formats::load_lens("tessar"), 4.0), 15.0 * kDegree);
    const Psf small = fft_psf(wide, {.size = 64});
    EXPECT_EQ(small.status, PupilStatus::aliased);
    EXPECT_GT(small.needed_size, 64);
    EXPECT_EQ(fft_psf(wide, {.size = small.needed_size, .pixel_um = small.pixel_um}).status, PupilStatus::ok);
    EXPECT_EQ(huygens_psf(wide, {.size = 4, .azimuths = 8, .rings = 4}).status, PupilStatus::aliased);
    EXPECT_THROW(fft_psf(wide, {.size = 100}), InputError);
    EXPECT_THROW(fft_psf(wide, {.size = 64, .pixel_um = 50.0}), InputError);
    EXPECT_THROW(huygens_psf(wide, {.pixel_um = 0.0}), InputError);
    optics::Lens closed = formats::load_lens("tessar");
    for (optics::LensSurface& surface : closed.surfaces) {
        surface.semi_diameter = surface.is_stop ? 0.0 : surface.semi_diameter;
    }
    EXPECT_EQ(fft_psf(field_of(closed, 0.0), {}).status, PupilStatus::no_light);
    EXPECT_EQ(huygens_psf(field_of(closed, 0.0), {}).status, PupilStatus::no_light);
}

}  // namespace lensproof::analysis::psf_test
