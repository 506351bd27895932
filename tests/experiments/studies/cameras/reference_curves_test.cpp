// tests/experiments/studies/cameras/reference_curves_test.cpp — what others say of a camera's lens, beside its own
// curves.
#include "experiments/studies/cameras/reference_curves.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/photographed/lensfun_database.h"
#include "engine/analysis/lens_analysis.h"
#include "engine/base/write_file.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/spectral/wavelengths.h"
#include "tests/calibration/photographed/dng_file.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::studies::reference_curves_test {

using calibration::kQuantities;

/// 36 × 24 mm.
calibration::Profile camera() {
    calibration::Profile profile{.name = "camera", .width_px = 6000, .height_px = 4000};
    profile.pixel_pitch_um = 6.0;
    return profile;
}

ReferenceSource source_of(const std::string& text, const std::filesystem::path& folder = ".") {
    TomlTable table = TomlTable::parse("references = []\n", folder / "experiment.toml");
    return read_reference(table, "references", text);
}

double at(const calibration::Profile& profile, const std::string& curve, double height) {
    return calibration::sample(profile.curves.at(curve), height)->value;
}

// A warp takes the pixel at the distance d from where d (k0 + k1 d² + k2 d⁴ + k3 d⁶) is, in units of the farthest
// corner's: what is imaged there would ideally lie at d. Its unit, to the corner's pixel, is 0.02 % less than the
// frame's.
TEST(ReferenceCurves, OfAMakersCorrectionAreThoseOfItsWarp) {
    using namespace calibration::synthetic;
    const TestFolder folder;
    const std::vector<double> warp = {1.01, -0.03, 0.004, -0.001, 0.0, 0.0, 0.5, 0.5};
    Dng dng;
    dng.photo = with_focal_plane(dng.photo);
    dng.opcodes = opcode_list({warp_opcode(1, warp)});
    write_file(folder.path() / "raw.dng", dng_bytes(dng));
    const calibration::Profile found = reference_curves(source_of("dng:raw.dng", folder.path()), camera(), 8.0);
    EXPECT_EQ(found.name, "dng: raw");
    for (const double d : {0.2, 0.5, 0.8, 0.95}) {
        const double height = d * (warp[0] + d * d * (warp[1] + d * d * (warp[2] + d * d * warp[3])));
        EXPECT_NEAR(at(found, kQuantities.distortion.key(), height), 100.0 * (height / (warp[0] * d) - 1.0), 0.01) << d;
    }
    EXPECT_FALSE(found.curves.contains(kQuantities.chromatic_shift.key("R")));
}

// A prescription's own rays: the chief ray's distortion in green, which this lens has 0.018 % less at 500 nm than at
// 600, against that of the d line.
TEST(ReferenceCurves, OfAPrescriptionAreItsRays) {
    const calibration::Profile found = reference_curves(source_of("lens:nikkor-50"), camera(), 0.0);
    const optics::Lens lens = formats::load_lens("nikkor-50");
    const auto field_at = [&](double nm) {
        analysis::AnalysisSettings settings;
        settings.wavelengths_nm = {nm};
        settings.reference_wavelength_nm = nm;
        settings.fields_deg = {15.0};
        return analysis::analyze_lens(lens, settings).fields.front();
    };
    const analysis::FieldAnalysis field = field_at(spectral::kLineD);
    const double height = std::abs(field.chief_ray_point->y) / (0.5 * std::hypot(36.0, 24.0));
    EXPECT_NEAR(at(found, kQuantities.distortion.key(), height), field.distortion_percent.value(), 0.02);
    // Of single wavelengths too; between samples, 1 % of the height apart, the curve is straight.
    const auto shift = [&](const char* wavelength) {
        return at(found, kQuantities.chromatic_shift.key(wavelength), height);
    };
    const double red_less_blue_px =
        (std::abs(field_at(650.0).chief_ray_point->y) - std::abs(field_at(450.0).chief_ray_point->y)) / 6e-3;
    EXPECT_GT(std::abs(red_less_blue_px), 0.2);
    EXPECT_NEAR(shift("650nm") - shift("450nm"), red_less_blue_px, 0.02);
}

// Of three calibrations of that model the one of the camera's own size of sensor; vignetting at the camera's f-number
// alone.
TEST(ReferenceCurves, OfADatabaseAreItsPolynomials) {
    const std::string model = "Canon EF 50mm f/1.8 MkII";
    const calibration::PhotographedLens entry =
        calibration::LensfunDatabase::of_system().find({.model = model, .crop_factor = 1.0, .focal_length_mm = 50.0});
    const calibration::Profile found = reference_curves(source_of("lensfun:" + model), camera(), 0.0);
    const double radius = 0.5 * entry.half_diagonal_mm();
    const double height = radius / (0.5 * std::hypot(36.0, 24.0));
    const double ideal = calibration::ideal_radius(entry, radius).value();
    EXPECT_NEAR(calibration::photographed_radius(entry, ideal), radius, 1e-9);
    EXPECT_NEAR(at(found, kQuantities.distortion.key(), height),
                100.0 * (radius / (calibration::photographed_slope(entry, 0.0) * ideal) - 1.0), 1e-3);
    EXPECT_FALSE(found.curves.contains(kQuantities.vignetting_ev.key("G")));
    const double f_number = entry.vignetting.front().f_number;
    const calibration::Profile at_stop = reference_curves(source_of("lensfun:" + model), camera(), f_number);
    EXPECT_NEAR(at(at_stop, kQuantities.vignetting_ev.key("G"), height),
                std::log2(entry.vignetting.front().brightness(0.5)), 1e-3);
}

TEST(ReferenceCurves, RefusesWhatIsNone) {
    const TestFolder folder;
    const auto refusal = [&](const std::string& text) {
        return complaint_about([&] { source_of(text, folder.path()); });
    };
    EXPECT_TRUE(says(refusal("tessar"), "expected profile:FILE, lens:NAME, lensfun:MODEL or dng:FILE"));
    EXPECT_TRUE(says(refusal("lensfun:"), "names \"lensfun:\""));
    EXPECT_TRUE(says(refusal("dng:none.dng"), "none.dng is not there"));
    EXPECT_TRUE(says(refusal("lens:tesar"), "experiment.toml:1: references"));
    calibration::Profile without = camera();
    without.pixel_pitch_um.reset();
    EXPECT_TRUE(says(complaint_about([&] { reference_curves(source_of("lens:tessar"), without, 0.0); }),
                     "camera: has no pixel_pitch_um"));
}

}  // namespace lensproof::studies::reference_curves_test
