// Lenses with gratings: what an analysis says of light that is turned away from the axis.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/analysis/lens_analysis.h"
#include "engine/base/angle.h"
#include "engine/optics/lens.h"

namespace lensproof::analysis::grating_test {

constexpr double kFocal = 50.0;
constexpr double kLines = 300.0;
constexpr double kRed_nm = 640.0;
constexpr double kBlue_nm = 480.0;

optics::PrescribedSurface grating(double order, double radius_mm, double thickness_mm) {
    optics::PrescribedSurface row{.radius_mm = radius_mm, .thickness_mm = thickness_mm, .semi_diameter_mm = 5.0};
    row.phase = optics::PhaseElement{.order = order, .lines_per_mm = kLines};
    row.is_stop = true;
    return row;
}

optics::Lens lens_of(std::vector<optics::PrescribedSurface> surfaces) {
    optics::Prescription prescription{.name = "spectrograph", .surfaces = std::move(surfaces)};
    prescription.wavelengths_nm = {kRed_nm, kBlue_nm};
    return make_lens(prescription, {});
}

double grating_path(double nm) {
    return kLines * nm * 1e-6;
}

// A flat grating at the stop sends collimated light on collimated, sin θ' = sin θ + m N λ, and an ideal lens of focal
// length f makes a point of it at f tan θ': where it is, how far colours are apart and that it is a point follow from
// nothing else. 1e-9 mm: chief rays are aimed to 1e-12 rad, over 50 mm.
TEST(Grating, ASpectrographHasItsLinesWhereTheGratingEquationPutsThem) {
    optics::PrescribedSurface camera{.thickness_mm = kFocal, .semi_diameter_mm = 40.0, .medium = {}};
    camera.ideal_focal_length_mm = kFocal;
    const optics::Lens lens = lens_of({grating(1.0, kInfinity, 10.0), camera});
    const AnalysisSettings settings{.wavelengths_nm = {kRed_nm, kBlue_nm},
                                    .reference_wavelength_nm = kRed_nm,
                                    .fields_deg = {0.0, 5.0, -8.0},
                                    .rings = 4};
    const LensAnalysis analysis = analyze_lens(lens, settings, 3);  // threads
    EXPECT_NEAR(analysis.reference_paraxial.efl, kFocal, 1e-12);
    EXPECT_FALSE(analysis.seidel) << "third order counts along the axis";
    ASSERT_EQ(analysis.fields.size(), 6u);
    const auto height = [](const FieldAnalysis& row, double nm) {
        return kFocal * std::tan(std::asin(std::sin(row.field_deg * kDegree) + grating_path(nm)));
    };
    for (const FieldAnalysis& row : analysis.fields) {
        SCOPED_TRACE(testing::Message() << row.field_deg << " deg, " << row.wavelength_nm << " nm");
        ASSERT_EQ(row.status, optics::RayStatus::ok);
        EXPECT_NEAR(row.chief_ray_point->y, height(row, row.wavelength_nm), 1e-9);
        EXPECT_NEAR(row.chief_ray_point->x, 0.0, 1e-9);
        EXPECT_NEAR(*row.lateral_colour, height(row, row.wavelength_nm) - height(row, kRed_nm), 1e-9);
        EXPECT_NEAR(*row.spot_rms, 0.0, 1e-9);
        EXPECT_NEAR(*row.tangential_focus, 0.0, 1e-8);
        EXPECT_NEAR(*row.sagittal_focus, 0.0, 1e-8);
        EXPECT_FALSE(row.distortion_percent) << "there is no axis to count from";
    }
}

// Collimated light at α on a concave grating of radius R comes to foci r along its chief ray,
//     cos²β / r_t = (cos α + cos β) / R,   1 / r_s = (cos α + cos β) / R,
// sin β = sin α + m N λ (Beutler, J. Opt. Soc. Am. 35, 311, 1945, the source drawn away). As distances along z from the
// image plane, which lies in front of the mirror: towards it they are negative there and the light runs that way.
TEST(Grating, AConcaveOneHasRowlandsFoci) {
    constexpr double kRadius = 200.0;
    constexpr double kImage = -100.0;
    optics::PrescribedSurface concave = grating(1.0, -kRadius, kImage);
    concave.is_mirror = true;
    const optics::Lens lens = lens_of({concave});
    const AnalysisSettings settings{.wavelengths_nm = {kRed_nm, kBlue_nm},
                                    .reference_wavelength_nm = kRed_nm,
                                    .fields_deg = {0.0, 6.0},
                                    .rings = 2};
    for (const FieldAnalysis& row : analyze_lens(lens, settings).fields) {
        SCOPED_TRACE(testing::Message() << row.field_deg << " deg, " << row.wavelength_nm << " nm");
        ASSERT_EQ(row.status, optics::RayStatus::ok);
        const double alpha = row.field_deg * kDegree;
        const double beta = std::asin(std::sin(alpha) + grating_path(row.wavelength_nm));
        const double power = (std::cos(alpha) + std::cos(beta)) / kRadius;
        const double tangential = std::cos(beta) * std::cos(beta) / power;
        ASSERT_TRUE(row.tangential_focus && row.sagittal_focus);
        EXPECT_NEAR(*row.tangential_focus, -tangential * std::cos(beta) - kImage, 1e-8 * kRadius);
        EXPECT_NEAR(*row.sagittal_focus, -1.0 / power * std::cos(beta) - kImage, 1e-8 * kRadius);
    }
}

}  // namespace lensproof::analysis::grating_test
