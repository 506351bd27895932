// Best focus against closed forms of third-order spherical aberration, and against searches.
#include "engine/analysis/best_focus.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/analysis/mtf.h"
#include "engine/analysis/psf.h"
#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/spectral/wavelengths.h"
#include "tests/engine/analysis/analysis_field.h"
#include "tests/engine/perfect_lens.h"

namespace lensproof::analysis::best_focus_test {

std::vector<WeightedField> axis_of(const optics::Lens& lens) {
    return {{field_of(lens, 0.0)}};
}

/// A slow lens of f/12.5 whose only aberration is an asphere's r⁴, W040 = (n − 1) A4 r⁴; telecentric.
PerfectLens with_spherical(double a4) {
    return {.beam_radius = 2.0, .stop_distance = PerfectLens{}.telecentric_distance(), .spherical = a4};
}

/// Where the marginal ray crosses the axis behind the image plane, by tracing.
double marginal_crossing(const optics::Lens& lens, double radius) {
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, spectral::kLineD);
    const Ray<double> ray = optics::trace<optics::Direction::forward, optics::Rims::follow>(
                                traced, Ray<double>{{0.0, radius, -50.0}, {0.0, 0.0, 1.0}})
                                .ray;
    return ray.origin.z - ray.origin.y * ray.direction.z / ray.direction.y - lens.image_z;
}

// Third order alone: a ray at r crosses r² L behind the paraxial focus, so its height at a plane s behind that is
// r (s − r² L) / f. Over an even disc the mean square ∫ r² (s − r² L)² 2r dr is least at s = 2L/3. The wavefront r⁴ is
// flattest with r² (R40 = 6r⁴ − 6r² + 1), half of what would focus the marginal ray: s = L/2. Fifth order and the
// hyperboloid's offence against the sine condition are of relative order sin²U = 1.6e-3.
TEST(BestFocus, OfSphericalAberration) {
    for (const double a4 : {2e-6, -2e-6}) {
        const PerfectLens perfect = with_spherical(a4);
        const optics::Lens lens = perfect.lens();
        const double marginal = marginal_crossing(lens, perfect.beam_radius);
        ASSERT_GT(std::abs(marginal), 0.02);
        const double infinity = kInfinity;
        EXPECT_NEAR(paraxial_focus_shift(lens, spectral::kLineD, infinity), 0.0, 1e-12);
        EXPECT_NEAR(spot_focus_shift(axis_of(lens)) / marginal, 2.0 / 3.0, 0.01);
        EXPECT_NEAR(wavefront_focus_shift(axis_of(lens)) / marginal, 0.5, 0.01);
    }
}

// Of a lens without aberration all criteria find the focus.
TEST(BestFocus, OfAPerfectLensIsItsFocus) {
    const optics::Lens lens = PerfectLens{.stop_distance = 20.0, .defocus = 0.3}.lens();
    EXPECT_NEAR(paraxial_focus_shift(lens, spectral::kLineD, kInfinity), -0.3, 1e-12);
    EXPECT_NEAR(spot_focus_shift(axis_of(lens)), -0.3, 1e-12);
    EXPECT_NEAR(wavefront_focus_shift(axis_of(lens)), -0.3, 1e-11);
    // The maximum is symmetric but for terms of the order sin²U of the depth of focus, 4 λ / sin²U = 0.06 mm.
    EXPECT_NEAR(mtf_focus_shift(axis_of(lens), 60.0), -0.3, 1e-3);
}

// Each criterion's plane is better by its own measure than those around, for several fields and wavelengths together.
TEST(BestFocus, IsTheBestAround) {
    const optics::Lens lens = optics::with_f_number(formats::load_lens("double-gauss-tronnier"), 4.0);
    const std::vector<WeightedWavelength> light = {{spectral::kLineF, 1.0}, {spectral::kLineC, 1.0}};
    const auto fields_at = [&](double shift) {
        const optics::Lens moved = with_image_shift(lens, shift);
        return std::vector<WeightedField>{{field_of(moved, 0.0, light)}, {field_of(moved, 10.0 * kDegree, light)}};
    };
    const std::vector<WeightedField> fields = fields_at(0.0);

    const auto spot = [&](double shift) {
        double sum = 0.0;
        for (const WeightedField& weighted : fields_at(shift)) {
            double weights = 0.0;
            Vec2d mean{};
            double squares = 0.0;
            for (const PolychromaticField::Part& part : weighted.field.parts) {
                for (const optics::RegionNode& node : optics::region_quadrature(part.outline, 8)) {
                    const Vec2d at = image_ray(part, weighted.field, node.point)->aberration;
                    const double weight = part.weight * node.weight / part.outline.area;
                    weights += weight;
                    mean = {mean.x + weight * at.x, mean.y + weight * at.y};
                    squares += weight * (at.x * at.x + at.y * at.y);
                }
            }
            sum += squares / weights - (mean.x * mean.x + mean.y * mean.y) / (weights * weights);
        }
        return sum;
    };
    const auto waves = [&](double shift) {
        double sum = 0.0;
        for (const WeightedField& weighted : fields_at(shift)) {
            for (const PolychromaticField::Part& part : weighted.field.parts) {
                const double rms =
                    wavefront_errors(wavefront(part.lens, part.wavelength_nm, weighted.field.bundle,
                                               weighted.field.sphere, optics::region_quadrature(part.outline, 8)))
                        .rms_without_tilt;
                sum += part.weight * rms * rms;
            }
        }
        return sum;
    };
    constexpr double kFrequency = 40.0;
    const auto loss = [&](double shift) {
        double sum = 0.0;
        for (const WeightedField& weighted : fields_at(shift)) {
            const MtfCurve curve = diffraction_mtf(sample_pupils(weighted.field, 64), std::vector<double>{kFrequency});
            EXPECT_EQ(curve.status, PupilStatus::ok);
            sum -= 0.5 * (curve.tangential.front() + curve.sagittal.front());
        }
        return sum;
    };
    const double by_spot = spot_focus_shift(fields);
    const double by_wave = wavefront_focus_shift(fields);
    const double by_mtf = mtf_focus_shift(fields, kFrequency);
    const double least = loss(by_mtf);
    for (const double beside : {-0.01, 0.01}) {
        EXPECT_LT(spot(by_spot), spot(by_spot + beside));
        EXPECT_LT(waves(by_wave), waves(by_wave + beside));
        EXPECT_LT(least, loss(by_mtf + beside));
    }
}

// Blurred over many cycles, a field counts by its rays; the answer is still next to where its spot is least.
TEST(BestFocus, GoesOnWithRaysWherePupilsCannotBeSampled) {
    const std::vector<WeightedField> fields = {{field_of(formats::load_lens("petzval"), 0.0)}};
    EXPECT_NEAR(mtf_focus_shift(fields, 5.0), spot_focus_shift(fields), 0.5);
}

TEST(BestFocus, RefusesWhatHasNone) {
    const optics::Lens lens = formats::load_lens("tessar");
    EXPECT_THROW(spot_focus_shift({}), InputError);
    EXPECT_THROW(wavefront_focus_shift({}), InputError);
    EXPECT_THROW(mtf_focus_shift(axis_of(lens), 5000.0), InputError);
    EXPECT_THROW(mtf_focus_shift(axis_of(lens), 0.0), InputError);
    EXPECT_THROW(with_image_shift(lens, -200.0), InputError);
}

}  // namespace lensproof::analysis::best_focus_test
