// Ideal lenses, gratings, kinoforms and immersion in files: what each form's records become, and come back as.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/infinity.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/optics/lens.h"
#include "tests/complaint.h"

namespace lensproof::formats::thin_element_files_test {

optics::Prescription everything_thin() {
    optics::Prescription lens;
    lens.file = "folder/thin.toml";
    lens.name = "thin";
    lens.source = "typed";
    lens.object_medium = {.glass = "", .n_d = 1.33, .V_d = 55.0};
    optics::PrescribedSurface ideal{.thickness_mm = 10.0, .semi_diameter_mm = 5.0, .medium = {}, .is_stop = true};
    ideal.ideal_focal_length_mm = -1.0 / 3.0 * 100.0;
    optics::PrescribedSurface ruled{.radius_mm = 80.0, .thickness_mm = 7.0, .semi_diameter_mm = 6.0, .medium = {}};
    ruled.phase = optics::PhaseElement{.order = -1.0, .lines_per_mm = 600.5};
    optics::PrescribedSurface kinoform{.thickness_mm = 30.0, .semi_diameter_mm = 6.0, .medium = {}};
    kinoform.phase =
        optics::PhaseElement{.order = 2.0, .radial = {-1e-3, 0.1 + 0.2, 7e-9}, .design_wavelength_nm = 550.0};
    lens.surfaces = {ideal, ruled, kinoform};
    return lens;
}

TEST(ThinElementFiles, TheProjectsOwnFormReadsBackTheSame) {
    const optics::Prescription lens = everything_thin();
    const WrittenPrescription written = to_toml(lens);
    EXPECT_TRUE(written.lost.empty());
    const optics::Prescription back = parse_toml_prescription(written.text, lens.file);
    EXPECT_EQ(back.object_medium, lens.object_medium);
    ASSERT_EQ(back.surfaces.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(back.surfaces[i].ideal_focal_length_mm, lens.surfaces[i].ideal_focal_length_mm) << i;
        EXPECT_EQ(back.surfaces[i].phase, lens.surfaces[i].phase) << i;
    }
    const auto complaint_of = [](const std::string& keys) {
        return complaint_about([&] {
            parse_toml_prescription("name = \"x\"\nsource = \"y\"\nsurfaces = [{ thickness_mm = 1.0, " + keys + " }]\n",
                                    "x.toml");
        });
    };
    EXPECT_TRUE(says(complaint_of("diffraction_order = 2.0"), "stands without grating_lines_per_mm"));
    EXPECT_TRUE(says(complaint_of("kinoform = [1e-3]"), "kinoform_nm"));
}

// Zemax states a kinoform by its phase in radians: the path at any wavelength, λ A / 2π, is the same, to rounding.
TEST(ThinElementFiles, ZemaxsFormSaysTheSame) {
    const optics::Prescription lens = everything_thin();
    const WrittenPrescription written = to_zmx(lens);
    const optics::Prescription back = parse_zmx(written.text, "thin.zmx");
    EXPECT_EQ(back.object_medium.n_d, 1.33);
    ASSERT_EQ(back.surfaces.size(), 3u);
    EXPECT_EQ(back.surfaces[0].ideal_focal_length_mm, lens.surfaces[0].ideal_focal_length_mm);
    ASSERT_TRUE(back.surfaces[1].phase && back.surfaces[2].phase);
    EXPECT_EQ(back.surfaces[1].phase->order, -1.0);
    EXPECT_NEAR(back.surfaces[1].phase->lines_per_mm, 600.5, 1e-12);
    EXPECT_EQ(back.surfaces[1].radius_mm, 80.0);
    for (const double nm : {450.0, 700.0}) {
        const optics::ThinElement<double> found = optics::thin_element(back.surfaces[2], nm);
        const optics::ThinElement<double> expected = optics::thin_element(lens.surfaces[2], nm);
        for (std::size_t i = 0; i < expected.radial.size(); ++i) {
            EXPECT_NEAR(found.radial[i], expected.radial[i], 1e-14 * std::abs(expected.radial[i])) << nm << " " << i;
        }
    }
}

TEST(ThinElementFiles, ZemaxsRecordsAreReadInTheirUnits) {
    const std::string text =
        "MODE SEQ\nUNIT CM X W X CM MR CPMM\nENPD 1\nSURF 0\n  TYPE STANDARD\n  DISZ INFINITY\n  GLAS WATER 0 0 1.33 "
        "55\n"
        "SURF 1\n  STOP\n  TYPE PARAXIAL\n  PARM 1 5.0\n  DISZ 1\nSURF 2\n  TYPE DGRATING\n  CURV 0.1\n  PARM 1 0.6\n"
        "  PARM 2 -1\n  DISZ 1\nSURF 3\n  TYPE BINARY_2\n  PARM 0 1\n  XDAT 1 1\n  XDAT 2 2.0\n  XDAT 3 "
        "-628.318530717958648\n"
        "  DISZ 1\nSURF 4\n  TYPE STANDARD\n  DISZ 0\n";
    const optics::Prescription lens = parse_zmx(text, "thin.zmx");
    EXPECT_EQ(lens.object_medium.glass, "WATER");
    EXPECT_EQ(lens.surfaces[0].ideal_focal_length_mm, 50.0);
    EXPECT_EQ(lens.surfaces[1].phase->lines_per_mm, 600.0);  // a µm is a µm
    EXPECT_EQ(lens.surfaces[1].radius_mm, 100.0);
    // A phase of −100 waves at 20 mm: a focal length of R² / (200 λ) = 4 m at 500 nm.
    EXPECT_NEAR(optics::thin_element(lens.surfaces[2], 500.0).first_order_power(), 1.0 / 4000.0, 1e-16);
}

TEST(ThinElementFiles, CodeVsKinoformsAreRead) {
    const std::string head = "RDM;LEN\nEPD 4\nDIM I\nWL 587.6\nSO 0 1e13 1.33\nS 2.0 0.2 1.5\nSTO\n";
    const optics::Prescription lens = parse_seq(
        head + "DIF DOE\nHOR 1\nHWL 500; HCT R\nHCO C1 -0.02; HCC C1 0\nHCO C2 1e-3\nS 0 3\nSI 0 0\n", "k.seq");
    EXPECT_EQ(lens.object_medium.n_d, 1.33);
    ASSERT_TRUE(lens.surfaces[0].phase);
    EXPECT_EQ(lens.surfaces[0].phase->design_wavelength_nm, 500.0);
    EXPECT_NEAR(lens.surfaces[0].phase->radial[0], -0.02 / 25.4, 1e-18);
    EXPECT_NEAR(lens.surfaces[0].phase->radial[1], 1e-3 / std::pow(25.4, 3), 1e-22);
    // A linear grating is named, and not traced as if it were none.
    const optics::Prescription ruled = parse_seq(head + "GRT\nGRO 1\nGRS 0.01\nS 0 3\nSI 0 0\n", "g.seq");
    EXPECT_TRUE(says(complaint_about([&] { optics::make_lens(ruled, {}); }), "GRT"));
}

TEST(ThinElementFiles, OptilandsAreRead) {
    const auto surface = [](const std::string& geometry, double z, const std::string& interaction) {
        return "{\"type\": \"Surface\", \"is_stop\": " + std::string(z == 0.0 ? "true" : "false") +
               ", \"geometry\": {\"cs\": {\"z\": " + std::to_string(z) + "}, " + geometry +
               "}, \"material_post\": {\"type\": \"IdealMaterial\", \"index\": 1.0}, \"interaction_model\": {\"type\": "
               "\"" +
               interaction + "}}";
    };
    const std::string plane = R"("type": "Plane", "radius": Infinity)";
    const std::string grating =
        R"("type": "PlaneGrating", "radius": Infinity, "order": -1.0, "period": 5.0, "angle": 0.0)";
    const std::string plain = "RefractiveReflectiveModel\"";
    const std::string text = "{\"surface_group\": {\"surfaces\": [" + surface(plane, -100.0, plain) + ", " +
                             surface(plane, 0.0, R"(ThinLensInteractionModel", "focal_length": 50.0)") + ", " +
                             surface(grating, 10.0, "DiffractiveInteractionModel\"") + ", " +
                             surface(plane, 60.0, plain) + "]}}";
    const optics::Prescription lens = parse_optiland(text, "thin.json");
    ASSERT_EQ(lens.surfaces.size(), 2u);
    EXPECT_EQ(lens.surfaces[0].ideal_focal_length_mm, 50.0);
    ASSERT_TRUE(lens.surfaces[1].phase);
    EXPECT_NEAR(lens.surfaces[1].phase->lines_per_mm, 200.0, 1e-12);
    EXPECT_EQ(lens.surfaces[1].phase->order, -1.0);
}

// What a plain table of radii cannot say is no lens without it.
TEST(ThinElementFiles, PlainTablesRefuseThem) {
    const optics::Prescription lens = everything_thin();
    EXPECT_TRUE(says(complaint_about([&] { to_csv(lens); }), "cannot say"));
    EXPECT_TRUE(says(complaint_about([&] { to_pbrt_lens(lens); }), "cannot say"));
}

}  // namespace lensproof::formats::thin_element_files_test
