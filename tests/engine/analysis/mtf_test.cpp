// Modulation transfer against closed forms, the FFT of the PSF, and rays.
#include "engine/analysis/mtf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "engine/analysis/psf.h"
#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/spectral/wavelengths.h"
#include "tests/engine/analysis/analysis_field.h"
#include "tests/engine/perfect_lens.h"

namespace lensproof::analysis::mtf_test {

/// f/50, so that the sine condition holds to 1e-4; telecentric.
PolychromaticField slow_field(double defocus) {
    return field_of(
        PerfectLens{.beam_radius = 0.5, .stop_distance = PerfectLens{}.telecentric_distance(), .defocus = defocus}
            .lens(),
        0.0);
}

std::vector<double> up_to(double highest, int count) {
    std::vector<double> frequencies;
    for (int i = 0; i <= count; ++i) {
        frequencies.push_back(highest * i / count);
    }
    return frequencies;
}

/// Of a circular pupil, at s = frequency / cutoff (Goodman, Introduction to Fourier Optics, 6.3).
double circle_mtf(double s) {
    return s < 1.0 ? 2.0 / std::numbers::pi * (std::acos(s) - s * std::sqrt(1.0 - s * s)) : 0.0;
}

/// Of a circular pupil with W020 waves of defocus at its rim: ∫∫ cos(8π W020 s x) dx dy over the lens that two discs of
/// radius 1, 2 s apart, have in common, over π (Hopkins, Proc. Roy. Soc. A 231, 91 (1955), eq. 22, in units of the
/// radius); Simpson's rule over x = (1 − s) sin t.
double defocused_mtf(double s, double w020) {
    constexpr int kSteps = 400;
    double sum = 0.0;
    for (int i = 0; i <= kSteps; ++i) {
        const double t = 0.5 * std::numbers::pi * (2.0 * i / kSteps - 1.0);
        const double x = (1.0 - s) * std::sin(t);
        const double half_height = std::sqrt(std::max(0.0, 1.0 - (std::abs(x) + s) * (std::abs(x) + s)));
        const double value =
            2.0 * half_height * std::cos(8.0 * std::numbers::pi * w020 * s * x) * (1.0 - s) * std::cos(t);
        const double simpson = i == 0 || i == kSteps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
        sum += simpson * value;
    }
    return sum * std::numbers::pi / kSteps / 3.0 / std::numbers::pi;
}

// 128 samples: cells at the rim that are split alike on both sides of the shear are counted by the product of their
// weights, too little by up to 1e-3 where the shear runs along the rim.
constexpr double kRimCells = 1e-3;

TEST(Mtf, CircularPupilIsClosedForm) {
    const PolychromaticField field = slow_field(0.0);
    const double cutoff = cutoff_frequency(field);
    EXPECT_NEAR(cutoff, 0.02 / (spectral::kLineD * 1e-6), 0.01);
    const std::vector<double> frequencies = up_to(1.2 * cutoff, 60);
    for (const MtfKind kind : {MtfKind::diffraction, MtfKind::diffraction_limited}) {
        const MtfCurve curve = diffraction_mtf(field, frequencies, kind);
        ASSERT_EQ(curve.status, PupilStatus::ok);
        EXPECT_EQ(curve.tangential.front(), 1.0);
        for (std::size_t i = 0; i < frequencies.size(); ++i) {
            EXPECT_NEAR(curve.tangential[i], circle_mtf(frequencies[i] / cutoff), kRimCells) << frequencies[i];
            EXPECT_NEAR(curve.sagittal[i], curve.tangential[i], 1e-9);
        }
    }
}

TEST(Mtf, DefocusedLensIsHopkins) {
    for (const double w020 : {0.25, 0.7, 2.0}) {
        // W = ζ (1 − cos U) = ζ sin²U / 2, to 1e-4.
        const PolychromaticField field = slow_field(w020 * 2.0 * spectral::kLineD * 1e-6 / 1e-4);
        const double cutoff = cutoff_frequency(field);
        const std::vector<double> frequencies = up_to(cutoff, 50);
        const MtfCurve curve = diffraction_mtf(field, frequencies);
        ASSERT_EQ(curve.status, PupilStatus::ok);
        for (std::size_t i = 0; i < frequencies.size(); ++i) {
            const double expected = std::abs(defocused_mtf(frequencies[i] / cutoff, w020));
            EXPECT_NEAR(curve.tangential[i], expected, 2.0 * kRimCells) << w020 << " " << frequencies[i] / cutoff;
            EXPECT_NEAR(curve.sagittal[i], expected, 2.0 * kRimCells) << w020 << " " << frequencies[i] / cutoff;
        }
    }
}

// The picture of a point out of focus is an evenly lit disc of radius a: 2 J₁(2π a f) / (2π a f). A slope is tan U
// where an even pupil has sin U: 1e-4.
TEST(Mtf, GeometricDiscIsBessels) {
    constexpr double kDefocus = 2.0;
    const PolychromaticField field = slow_field(kDefocus);
    const double radius = kDefocus * 0.01;
    const std::vector<double> frequencies = up_to(100.0, 50);
    const MtfCurve curve = geometric_mtf(field, frequencies);
    ASSERT_EQ(curve.status, PupilStatus::ok);
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
        const double x = 2.0 * std::numbers::pi * radius * frequencies[i];
        const double expected = x > 0.0 ? std::abs(2.0 * std::cyl_bessel_j(1.0, x) / x) : 1.0;
        EXPECT_NEAR(curve.tangential[i], expected, 3e-4) << frequencies[i];
        EXPECT_NEAR(curve.sagittal[i], expected, 3e-4) << frequencies[i];
    }
}

// The Fourier transform of the picture is the second way to the same curve, with lateral colour and vignetting. Both
// are normalised by all of the light, also that beyond the window, which is structure of the lowest frequencies only.
// The rim's cells, in two different grids: 3e-3 each across a slim pupil.
TEST(Mtf, IsTheTransformOfThePsf) {
    for (const Case& c : {Case{"tessar", 8.0, 15.0}, Case{"muller-fisheye", 5.6, 75.5}}) {
        const PolychromaticField field =
            field_of(lens_of(c), c.field_deg * kDegree, {{spectral::kLineF, 1.0}, {spectral::kLineC, 1.0}});
        const Psf psf = fft_psf(field, {.size = 256});
        const std::vector<double> frequencies = {10.0, 30.0, 50.0, 80.0, 120.0};
        const MtfCurve curve = diffraction_mtf(field, frequencies);
        ASSERT_EQ(curve.status, PupilStatus::ok) << c.lens;
        ASSERT_EQ(psf.status, PupilStatus::ok) << c.lens;
        for (std::size_t i = 0; i < frequencies.size(); ++i) {
            std::complex<double> tangential = 0.0;
            std::complex<double> sagittal = 0.0;
            for (int row = 0; row < psf.size; ++row) {
                for (int column = 0; column < psf.size; ++column) {
                    const double turn = -2.0 * std::numbers::pi * frequencies[i] * 1e-3;
                    tangential += std::polar(psf.at(row, column), turn * psf.position_um(row));
                    sagittal += std::polar(psf.at(row, column), turn * psf.position_um(column));
                }
            }
            const double light = 1.0 / (psf.pixel_um * psf.pixel_um);
            EXPECT_NEAR(curve.tangential[i], std::abs(tangential) / light, 6e-3) << c.lens << " " << frequencies[i];
            EXPECT_NEAR(curve.sagittal[i], std::abs(sagittal) / light, 6e-3) << c.lens << " " << frequencies[i];
        }
    }
}

// With shorter and shorter waves the diffraction MTF becomes the rays', by an error that falls with the wavelength, and
// stays below what the shear leaves out of the common area. The lens has the same index for all of them.
TEST(Mtf, GeometricIsTheLimitOfShortWaves) {
    const optics::Lens lens = PerfectLens{.stop_distance = 30.0, .defocus = 0.15, .spherical = 2e-7}.lens();
    const std::vector<double> frequencies = up_to(60.0, 12);
    double last = 0.0;
    for (const double wavelength_nm : {1600.0, 400.0, 200.0}) {
        const PolychromaticField field = field_of(lens, 1.5 * kDegree, {{wavelength_nm, 1.0}});
        const MtfCurve exact = diffraction_mtf(field, frequencies);
        const MtfCurve rays = geometric_mtf(field, frequencies);
        ASSERT_EQ(exact.status, PupilStatus::ok);
        ASSERT_EQ(rays.status, PupilStatus::ok);
        ASSERT_LT(rays.tangential.back(), 0.2);
        double worst = 0.0;
        for (std::size_t i = 0; i < frequencies.size(); ++i) {
            worst = std::max(worst, std::abs(exact.tangential[i] - rays.tangential[i]));
            worst = std::max(worst, std::abs(exact.sagittal[i] - rays.sagittal[i]));
        }
        if (last > 0.0) {
            EXPECT_LT(worst, 0.7 * last) << wavelength_nm;
        }
        last = worst;
        // f/5: a shear of λ f N of the pupil's width takes 4/π of that fraction of the common area.
        EXPECT_LT(worst, 4.0 / std::numbers::pi * wavelength_nm * 1e-6 * 60.0 * 5.0 + kRimCells) << wavelength_nm;
    }
}

// Transfer is never better than without aberration (Schwarz's inequality); cubics across the kink at the cutoff: 1e-4.
TEST(Mtf, IsBoundByThatOfThePerfectPupil) {
    const PolychromaticField field = field_of(lens_of({"tessar", 5.6, 12.0}), 12.0 * kDegree);
    const std::vector<SampledPupil> pupils = sample_pupils(field, 96);
    const std::vector<double> frequencies = up_to(300.0, 30);
    const MtfCurve exact = diffraction_mtf(pupils, frequencies);
    const MtfCurve perfect = diffraction_mtf(pupils, frequencies, MtfKind::diffraction_limited);
    ASSERT_EQ(exact.status, PupilStatus::ok);
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
        EXPECT_LE(exact.tangential[i], perfect.tangential[i] + 1e-4);
        EXPECT_LE(exact.sagittal[i], perfect.sagittal[i] + 1e-4);
    }
}

// Off the axis the cone seen from the image is narrower in the meridional plane by cos³, and at full aperture rims cut
// it: tangential lines are transferred less by a perfect lens of this pupil.
TEST(Mtf, DiffractionLimitIsTheVignettedPupils) {
    const PolychromaticField field = field_of(formats::load_lens("double-gauss-tronnier"), 18.0 * kDegree);
    const CosineBox box = cosine_box(field, field.parts.front());
    const double tangential_cutoff = (box.high.y - box.low.y) / (spectral::kLineD * 1e-6);
    const double sagittal_cutoff = (box.high.x - box.low.x) / (spectral::kLineD * 1e-6);
    ASSERT_LT(tangential_cutoff, 0.9 * sagittal_cutoff);
    const MtfCurve curve = diffraction_mtf(
        field, std::vector<double>{0.5 * tangential_cutoff, 1.02 * tangential_cutoff}, MtfKind::diffraction_limited);
    EXPECT_LT(curve.tangential[0], curve.sagittal[0]);
    EXPECT_NEAR(curve.tangential[1], 0.0, 1e-3);
    EXPECT_GT(curve.sagittal[1], 0.01);
}

TEST(Mtf, SaysWhatItCannotSample) {
    const PolychromaticField wide = field_of(optics::with_f_number(formats::load_lens("tessar"), 4.0), 15.0 * kDegree);
    const std::vector<double> frequencies = {30.0};
    EXPECT_EQ(diffraction_mtf(wide, frequencies, MtfKind::diffraction, 32).status, PupilStatus::aliased);
    EXPECT_EQ(diffraction_mtf(wide, frequencies, MtfKind::diffraction_limited, 32).status, PupilStatus::ok);
    const MtfCurve automatic = diffraction_mtf(wide, frequencies);
    EXPECT_EQ(automatic.status, PupilStatus::ok);
    const MtfCurve fine = diffraction_mtf(wide, frequencies, MtfKind::diffraction, 256);
    EXPECT_NEAR(automatic.tangential.front(), fine.tangential.front(), 2.0 * kRimCells);
    EXPECT_NEAR(automatic.sagittal.front(), fine.sagittal.front(), 2.0 * kRimCells);
    EXPECT_EQ(geometric_mtf(wide, std::vector<double>{400.0}, {.azimuths = 8, .rings = 4}).status,
              PupilStatus::aliased);
    EXPECT_THROW(diffraction_mtf(wide, std::vector<double>{-1.0}), InputError);
    EXPECT_THROW(diffraction_mtf(wide, frequencies, MtfKind::diffraction, 2), InputError);
    EXPECT_THROW(geometric_mtf(wide, frequencies, {.azimuths = 0}), InputError);
}

}  // namespace lensproof::analysis::mtf_test
