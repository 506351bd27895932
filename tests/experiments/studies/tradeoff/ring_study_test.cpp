// tests/experiments/studies/tradeoff/ring_study_test.cpp — what fewer rings of rays in an analysis get wrong.
#include "experiments/studies/tradeoff/ring_study.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/analysis/best_focus.h"
#include "engine/analysis/spot.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"

namespace lensproof::studies::ring_study_test {

const analysis::AnalysisSettings kOneLine{
    .wavelengths_nm = {spectral::kLineD}, .reference_wavelength_nm = spectral::kLineD, .fields_deg = {0.0, 20.0}};

// spot.h: with kSpotRings the rms of a camera lens's spot has converged to 1e-9 mm. A ring alone weighs all zones of a
// wide beam alike.
TEST(RingErrors, TheUsualRingsHaveConverged) {
    const optics::Lens lens = optics::with_f_number(formats::load_lens("tessar"), 2.8);
    const std::vector<RingError> found = ring_errors(lens, kOneLine, {1, 6, analysis::kSpotRings});
    ASSERT_EQ(found.size(), 3U);
    EXPECT_GT(found[0].spot_um, 1.0);
    EXPECT_LT(found[1].spot_um, found[0].spot_um);
    EXPECT_LT(found[2].spot_um, 1e-6);
    EXPECT_LT(found[2].centroid_um, 1e-6);
    EXPECT_GT(found[0].milliseconds, 0.0);
}

// Far out of focus a ray's offset is a ρ, and its mean square 2 ∫ (a ρ)² ρ dρ = a²/2. One Gauss node, ρ = 1/2, has a²/4
// for it, an rms too small by the factor 1/√2; two are exact for the cubic. Spherical aberration adds b ρ³, which in
// focus is alone and has the rms b/2. Out of focus it makes the rms b √2/3 larger, one node's b/8, and leaves two nodes
// off by (1/6 − 11/72) 2√2 b.
TEST(RingErrors, OutOfFocusTwoRingsSuffice) {
    const optics::Lens in_focus = optics::with_f_number(formats::load_lens("tessar"), 22.0);
    const optics::Lens lens = analysis::with_image_shift(in_focus, 1.0);
    analysis::AnalysisSettings axis = kOneLine;
    axis.fields_deg = {0.0};
    const double spot_um = 1e3 * analysis::analyze_lens(lens, axis).fields[0].spot_rms.value();
    const double b = 2e3 * analysis::analyze_lens(in_focus, axis).fields[0].spot_rms.value();
    const std::vector<RingError> found = ring_errors(lens, axis, {1, 2});
    ASSERT_LT(b, 0.05 * spot_um);
    EXPECT_NEAR(found[0].spot_um, spot_um * (1.0 - std::sqrt(0.5)) + (1.0 / 3.0 - 1.0 / 8.0) * b, 0.1 * b);
    EXPECT_NEAR(found[1].spot_um, (1.0 / 6.0 - 11.0 / 72.0) * 2.0 * std::sqrt(2.0) * b, 0.1 * b);
}

}  // namespace lensproof::studies::ring_study_test
