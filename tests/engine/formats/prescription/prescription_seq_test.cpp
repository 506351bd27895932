// CODE V files: what they mean, against the same lens in the project's form and against rayoptics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/input_error.h"
#include "engine/base/text_encoding.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/optics/lens.h"
#include "tests/complaint.h"
#include "tests/engine/formats/prescription/has_finding.h"
#include "tests/engine/formats/prescription/same_rays.h"

namespace lensproof::formats::prescription_seq_test {

optics::Prescription parse(const std::string& text) {
    return parse_seq(text, "test.seq");
}

std::string complaint(const std::string& text) {
    return complaint_about([&] { parse(text); });
}

const std::string kTessar = R"(RDM;LEN      "VERSION: 10.7       LENS VERSION: 80"
TITLE 'Tessar; 100 mm!'
FNO   2.8     ! a comment; with more
DIM   M
WL    656.2725 587.5618 &
      486.1327
REF   2
YAN   0.0 16.0 24.0
SO    0.0 0.1e14
S     42.97 9.8 LAK9
  CIR 19.2
S     -115.33 2.1 LLF7; CIR CLR 19.2; CIR EDG 20
S     306.84 4.16
  CIR 19.2
S     0 4
  STO; CIR 15.0
s     -59.06 1.87 sf7
  cir 17.3
S     40.93 10
  CIR 17.3
S     183.92 7.05 LAK9
S     -48.91 79.8
  CIR 16.5
SI    0.0 0.031
CIR S7 16.5; THI S6 10.64
GO
)";

/// With its stop opened as the other lens says its aperture.
optics::Prescription with_stop_of(optics::Prescription lens, const optics::Prescription& other) {
    lens.aperture = other.aperture;
    std::ranges::find_if(lens.surfaces, &optics::PrescribedSurface::is_stop)->semi_diameter_mm.reset();
    return lens;
}

TEST(Seq, TessarIsTheTomlLens) {
    const optics::Prescription lens = parse(kTessar);
    const optics::Prescription expected = read_prescription(find_lens_file("tessar"));
    expect_same_rays(with_stop_of(expected, lens), lens);
    EXPECT_TRUE(lens.remarks.empty());
    EXPECT_EQ(lens.name, "Tessar; 100 mm!");
    EXPECT_EQ(lens.aperture, (optics::SystemAperture{optics::ApertureKind::f_number, 2.8}));
    EXPECT_EQ(lens.fields.points, (std::vector<Vec2d>{{0.0, 0.0}, {0.0, 16.0}, {0.0, 24.0}}));
    EXPECT_EQ(lens.stated.half_field_deg, 24.0);
    EXPECT_EQ(lens.wavelengths_nm, (std::vector<double>{587.5618, 656.2725, 486.1327}));
    EXPECT_EQ(lens.surfaces[1].rim_mm, 20.0);
    EXPECT_TRUE(std::isinf(lens.object_distance_mm));
    expect_same_rays(with_stop_of(expected, lens), parse(to_utf16(kTessar)));
}

// The ray from (0.5, 1, −20) along (0.03, −0.02, 1) through basic, DAR and REV decentres, as rayoptics 0.9.8 traces it
// in global coordinates at the d line, where its model glasses are 1.5 and 1.6 too. Decimals as printed.
TEST(Seq, DecentresAddUpAsInRayoptics) {
    const optics::Prescription lens = parse(
        "RDM;LEN\nDIM M\nEPD 4\nWL 587.5618\nYAN 0\nSO 0 20\nS 0 10\n STO\nS 50 5 500.600\n"
        " XDE 0.5; YDE -0.3; ADE 7; BDE 4; CDE 11\nS -33 1\nS 100 3 600.600\n"
        " DAR; XDE -0.4; YDE 0.2; ADE -3; BDE 2; CDE 5\nS 0 6\n ADE 2\nS 80 4 600.600\n"
        "S 0 40\n REV\n YDE 0.4; ADE 1.5; BDE 3\nSI 0 0\n");
    const double norm = std::sqrt(0.03 * 0.03 + 0.02 * 0.02 + 1.0);
    const std::array<Vec3d, 7> expected = {{{1.1, 0.5999999999999999, 0.0},
                                            {1.3997162714027287, 0.4001891523981809, 9.990542380090966},
                                            {1.3519327714387486, 0.5146243711828953, 14.987110810198843},
                                            {1.3546480152199378, 0.4817910472125567, 16.075966845608257},
                                            {1.2341442267463514, 0.4979289517882002, 19.063498093966288},
                                            {1.1234145451725253, -0.04099434388271894, 25.271694048934773},
                                            {0.9287083978575511, 0.015667018778847464, 29.26936073077089}}};
    std::vector<Vec3d> points;
    optics::trace<optics::Direction::forward, optics::Rims::follow>(
        optics::at_wavelength<double>(optics::make_lens(lens, {}), 587.5618),
        Ray<double>{{0.5, 1.0, -20.0}, {0.03 / norm, -0.02 / norm, 1.0 / norm}},
        [&](const optics::SurfaceEvent<double>& event) { points.push_back(event.ray.origin); });
    ASSERT_EQ(points.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_NEAR(length(points[i] - expected[i]), 0.0, 1e-12) << i;
    }
    // The vertex that the image has there, 68.41347837209321, off the last row's.
    EXPECT_NEAR(lens.surfaces.back().thickness_mm, 68.41347837209321 - 28.760046314408832, 1e-12);
    EXPECT_TRUE(has_finding(lens, "image-tilt", ""));
}

TEST(Seq, ReadsShapesAndUnits) {
    const optics::Prescription lens = parse(
        "RDM N;LEN\nDIM I\nYIM 0 0.5\nSO 0 1e11\nS 0.5 0.1 NBK7_SCHOTT\n STO\n ASP\n K -1; A 2; J 3\n"
        "S 0.2 1\n CYL\nS 0.25 1\n YTO; RDX 8; B 1e-3\nS 0.25 1\n XTO; CUX 0.5; A 1e-3\nSI 0 0\n");
    EXPECT_DOUBLE_EQ(lens.stated.image_circle_mm.value(), 25.4);
    EXPECT_TRUE(has_finding(lens, "units", "inches"));
    const auto& rows = lens.surfaces;
    ASSERT_EQ(rows.size(), 4U);
    EXPECT_DOUBLE_EQ(rows[0].radius_mm, 2 * 25.4);
    EXPECT_EQ(rows[0].medium.glass, "SCHOTT N-BK7");
    EXPECT_EQ(rows[0].conic, -1.0);
    EXPECT_DOUBLE_EQ(rows[0].asphere[1], 2 / std::pow(25.4, 3));
    EXPECT_DOUBLE_EQ(rows[0].asphere[9], 3 / std::pow(25.4, 19));
    EXPECT_TRUE(std::isinf(rows[1].radius_x_mm.value()));
    EXPECT_DOUBLE_EQ(rows[2].radius_x_mm.value(), 8 * 25.4);
    EXPECT_DOUBLE_EQ(rows[2].asphere[2], 1e-3 / std::pow(25.4, 5));
    EXPECT_DOUBLE_EQ(rows[3].radius_mm, 2 * 25.4);
    EXPECT_DOUBLE_EQ(rows[3].radius_x_mm.value(), 4 * 25.4);
    EXPECT_NEAR(rows[3].misalignment.tilt_deg[2], 90.0, 1e-13);
}

// CODE V's odd polynomial: its conic constant and its terms by name or by number, normalized by a radius or not.
TEST(Seq, ReadsOddPolynomials) {
    const optics::Prescription lens = parse(
        "RDM;LEN\nDIM I\nSO 0 1e11\nS 2 0.1 NBK7_SCHOTT\n STO\n SPS ODD 0.0\n SCO K -1; SCO AR3 0.25\n SCO AR20 2\n"
        "S 4 1\n SPS ODD 10\n SCC AR4 0\nSCO S2 C5 3; SCO C33 2\nSI 0 0\n");
    const auto& rows = lens.surfaces;
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0].conic, -1.0);
    EXPECT_DOUBLE_EQ(rows[0].term(3), 0.25 / std::pow(25.4, 2));
    EXPECT_DOUBLE_EQ(rows[0].term(20), 2 / std::pow(25.4, 19));
    EXPECT_DOUBLE_EQ(rows[1].term(4), 3 / std::pow(2, 4) / std::pow(25.4, 3));
    EXPECT_FALSE(has_finding(lens, "surface-type", ""));
    const std::string head = "RDM;LEN\nSO 0 1e13\nS 10 1 517642\n STO\n";
    EXPECT_TRUE(has_finding(parse(head + "SPS ODD; SCO AR21 1e-9\nS 20 5\nSI 0 0\n"), "surface-type",
                            "C22 = 1e-09 of the special surface ODD is left out"));
    EXPECT_TRUE(has_finding(parse(head + "SPS XYP; SCO Y2 1e-9\nS 20 5\nSI 0 0\n"), "surface-type", "XYP"));
    EXPECT_TRUE(
        says(complaint(head + "SPS ODD; SCO Q 1\nSI 0 0\n"), "test.seq:5: SCO is \"Q\", expected K, NRADIUS, AR1"));
    EXPECT_TRUE(says(complaint(head + "SPS ODD; SCO AR3\nSI 0 0\n"), "expected a coefficient"));
}

double sag_of(const optics::PrescribedSurface& row, double r) {
    return optics::sag_profile(optics::prescribed_shape(row), r * r).sag;
}

// The third mirror of CODE V's example threemrc.len, which its listings state twice: as an asphere (threemrc.lis) and
// as Forbes's best fit sphere with terms along its normals (threemrc_qbfs.lis; both come with rayoptics). The listings
// round: the normalizing radius to 5e-3 mm, which moves the sag by 2.2e-5 mm at the rim, and coefficients to five
// digits, 5e-6 mm of the first; what terms beyond the sixth would add is below its 1.4e-7 mm.
TEST(Seq, ReadsForbesMildAsphereAsCodeVStatesIt) {
    const std::string head = "RDM;LEN\nSO 0 1e13\n";
    const optics::PrescribedSurface stated_by_powers =
        parse(head + "S -453.96516 10 517642\n STO\n ASP; K 0.226106; A 0.368950E-10\nS 0 5\nSI 0 0\n").surfaces[0];
    const optics::Prescription mild = parse(
        head +
        "S -449.67012 10 517642\n STO\n SPS QBF\n SCO NRADIUS 1.8986E+02; SCO QB4 4.2605E-01; SCO QB6 -1.6782E-02\n"
        " SCO C5 8.2673E-04; SCO QB10 -4.4487E-05; SCO QB12 2.5242E-06; SCO C8 -1.3595E-07\nS 0 5\nSI 0 0\n");
    EXPECT_TRUE(mild.surfaces[0].along_normal);
    EXPECT_TRUE(mild.remarks.empty());
    for (const double r : {10.0, 50.0, 100.0, 150.0, 189.0}) {
        EXPECT_NEAR(sag_of(mild.surfaces[0], r), sag_of(stated_by_powers, r), r < 180.0 ? 6e-6 : 3e-5) << r;
    }
}

TEST(Seq, ReadsForbesStrongAsphereAndRefusesWhatItCannot) {
    const std::string head = "RDM;LEN\nDIM I\nSO 0 1e13\nS 2 0.1 517642\n STO\n";
    const std::string tail = "\nS 20 5\nSI 0 0\n";
    const optics::PrescribedSurface strong =
        parse(head + "SPS QCN; SCO NRADIUS 0.5; SCO K -1; SCO QC4 1e-3; SCO QC6 2e-4" + tail).surfaces[0];
    EXPECT_EQ(strong.conic, -1.0);
    EXPECT_FALSE(strong.along_normal);
    // u⁴ (a_0 + a_1 (6 u² − 5)), Forbes 2007, table 1.
    EXPECT_NEAR(strong.term(4), (1e-3 - 5 * 2e-4) * 25.4 / std::pow(12.7, 4), 1e-20);
    EXPECT_NEAR(strong.term(6), 6 * 2e-4 * 25.4 / std::pow(12.7, 6), 1e-20);
    EXPECT_TRUE(says(complaint(head + "SPS QBF; SCO QB4 1e-3" + tail), "expected SCO NRADIUS"));
    EXPECT_TRUE(says(complaint(head + "SPS QBF; SCO QB5 1e-3" + tail), "SCO is \"QB5\", expected NRADIUS, QB4"));
    EXPECT_TRUE(says(complaint(head + "SPS QBF 2.0" + tail), "SCO NRADIUS says its radius"));
    EXPECT_TRUE(says(complaint(head + "SPS QBF; SCO K -1" + tail), "SCO is \"K\", expected NRADIUS"));
    EXPECT_TRUE(
        has_finding(parse(head + "SPS QBF; SCO NRADIUS 1; SCO QB22 1e-9" + tail), "surface-type", "C12 = 1e-09"));
}

TEST(Seq, ReadsEveryWayToStateAGlass) {
    const optics::Prescription lens = parse(
        "RDM;LEN\nPRV\n PWL 650.0 587.6 &\n 486.1\n 'E48' 1.5286 1.53116&\n  1.5378\nEND\nSO 0 1e13\n"
        "S 10 1 'E48'\n STO\nS 10 1 517642\nS 10 1 620410.3637\nS 10 1 1.5168:64.17\nS 10 1 1.6\nS 10 1 SLAH66_OHARA\n"
        "S 10 1 AIR\nS 10 1\nGLA S8 SF7_HIKARI\nS 10 1 003283\nS 10 1 620410.364\nSI 0 0\n");
    const auto& rows = lens.surfaces;
    ASSERT_EQ(rows.size(), 10U);
    ASSERT_EQ(rows[0].medium.indices.size(), 3U);
    EXPECT_EQ(rows[0].medium.indices[0].wavelength_nm, 486.1);
    EXPECT_EQ(rows[0].medium.indices[0].value, 1.5378);
    EXPECT_EQ(rows[1].medium.n_d, 1.517);
    EXPECT_EQ(rows[1].medium.V_d, 64.2);
    EXPECT_EQ(rows[2].medium.n_d, 1.620410);
    EXPECT_EQ(rows[2].medium.V_d, 36.37);
    EXPECT_EQ(rows[3].medium.n_d, 1.5168);
    EXPECT_EQ(rows[3].medium.V_d, 64.17);
    EXPECT_EQ(rows[4].medium.n_d, 1.6);
    EXPECT_FALSE(rows[4].medium.V_d);
    EXPECT_EQ(rows[5].medium.glass, "OHARA S-LAH66");
    EXPECT_TRUE(rows[6].medium.is_air());
    EXPECT_EQ(rows[7].medium.glass, "HIKARI SF7");
    EXPECT_EQ(rows[8].medium.n_d, 2.003) << "the index has lost its 2";
    EXPECT_EQ(rows[8].medium.V_d, 28.3);
    EXPECT_EQ(rows[9].medium.n_d, 1.620410);
    EXPECT_EQ(rows[9].medium.V_d, 36.4) << "no density";
    EXPECT_TRUE(lens.remarks.empty());
}

// EPD, FNO, NA and NAO; the last three mean the image and the object as they are used.
TEST(Seq, ApertureAndFieldsGovern) {
    using optics::ApertureKind;
    using optics::FieldKind;
    const auto head = [](const std::string& settings, const std::string& object) {
        return parse("RDM;LEN\n" + settings + "SO 0 " + object + "\nS 50 2 517642\nS -50 48\nSI 0 0\n");
    };
    EXPECT_EQ(head("FNO 4\n", "200").aperture, (optics::SystemAperture{ApertureKind::working_f_number, 4.0}));
    EXPECT_EQ(head("NA 0.1\n", "1e13").aperture, (optics::SystemAperture{ApertureKind::f_number, 5.0}));
    EXPECT_EQ(head("NAO 0.1\n", "200").aperture,
              (optics::SystemAperture{ApertureKind::object_numerical_aperture, 0.1}));
    const optics::Prescription inches = head("DIM I\nEPD 0.5\nXIM 0 0\nYIM 0 0.5\nVUY 0 0.3\nVLY 0 0.1\n", "1e13");
    EXPECT_EQ(inches.aperture, (optics::SystemAperture{ApertureKind::entrance_pupil_diameter, 12.7}));
    EXPECT_EQ(inches.fields.kind, FieldKind::paraxial_image_height);
    EXPECT_EQ(inches.fields.points, (std::vector<Vec2d>{{0.0, 0.0}, {0.0, 12.7}}));
    ASSERT_EQ(inches.fields.vignetting.size(), 2U);
    EXPECT_DOUBLE_EQ(inches.fields.vignetting[1].compression.y, 0.2);
    EXPECT_DOUBLE_EQ(inches.fields.vignetting[1].decentre.y, -0.1);
    EXPECT_EQ(head("YOB 0 -7\n", "200").fields.kind, FieldKind::object_height);
    EXPECT_EQ(head("YRI 0 7\n", "200").fields.kind, FieldKind::image_height);
}

TEST(Seq, WithoutAStopTheFirstSurfaceIsIt) {
    const optics::Prescription lens = parse("RDM;LEN\nEPD 10\nSO 0 1e13\nS 50 2 517642\nS -50 48\nSI 0 0\n");
    EXPECT_TRUE(lens.surfaces[0].is_stop);
    EXPECT_FALSE(lens.surfaces[1].is_stop);
    EXPECT_TRUE(has_finding(lens, "stop", "first"));
    EXPECT_NEAR(optics::make_lens(lens, {}).surfaces[0].semi_diameter, 5.0, 1e-12);
}

TEST(Seq, ReadsZoomPositions) {
    const optics::Prescription lens = parse(
        "RDM;LEN\nEPD 2\nSO 0 1e13\nS 10 1 517642\n STO\nS 20 5\nSI 0 0\n"
        "ZOO 3\nZOO THI S2 5 6 7\nZOO TIT 'wide' 'middle' 'tele'\nZOO EPD 2 3 4\nZOO YAN F2 1 2 3\nTHI S1 Z3 "
        "1.5\nGO\n");
    ASSERT_EQ(lens.zoom.size(), 3U);
    EXPECT_EQ(lens.zoom[2].name, "tele");
    EXPECT_EQ(lens.zoom[1].gaps_mm, (std::map<int, double>{{1, 1.0}, {2, 6.0}}));
    EXPECT_EQ(lens.zoom[2].gaps_mm, (std::map<int, double>{{1, 1.5}, {2, 7.0}}));
    EXPECT_EQ(lens.zoom[1].aperture, (optics::SystemAperture{optics::ApertureKind::entrance_pupil_diameter, 3.0}));
    EXPECT_TRUE(has_finding(lens, "multi-configuration", "YAN"));
}

TEST(Seq, WhatHoldsForOnePositionAloneIsNamedAndLeftOut) {
    const optics::Prescription lens = parse(
        "RDM;LEN\nEPD 2\nSO 0 1e13\nS 10 1 517642\n STO\n CIR 4\nS 20 5\nSI 0 0\nZOO 2\nCIR S1 Z2 3\nRDY S1 Z2 77\n"
        "GLA S1 Z2 620364\nEPD Z2 5\nYAN F2 Z1 3\nCCY S1 Z2 0\nGO\n");
    ASSERT_EQ(lens.surfaces.size(), 2U);
    EXPECT_EQ(lens.surfaces[0].radius_mm, 10.0);
    EXPECT_FALSE(lens.surfaces[0].semi_diameter_mm) << "the stop opens as EPD says";
    EXPECT_EQ(lens.surfaces[0].medium.n_d, 1.517);
    EXPECT_EQ(lens.aperture, (optics::SystemAperture{optics::ApertureKind::entrance_pupil_diameter, 2.0}));
    for (const char* command : {"line 10: CIR", "line 11: RDY", "line 12: GLA", "line 13: EPD", "line 14: YAN"}) {
        EXPECT_TRUE(has_finding(lens, "multi-configuration", command)) << command;
    }
    EXPECT_EQ(lens.remarks.size(), 5U);
    EXPECT_EQ(lens.remarks[0].surface, 1);
    EXPECT_EQ(lens.remarks[0].severity, optics::Severity::warning);
}

TEST(Seq, DeletedSurfacesMakeAnotherLens) {
    const std::string lens = "RDM;LEN\nSO 0 1e13\nS 10 1 517642\n STO\nS 20 5\nS 20 5\nSI 0 0\n";
    const optics::Prescription cut = parse(lens + "DEL S2..3\nDEL PIK THI S1\nDEL SOL S1\nDEL APE S1\n");
    ASSERT_EQ(cut.remarks.size(), 2U);
    EXPECT_TRUE(has_finding(cut, "deleted-surfaces", "line 8: DEL"));
    EXPECT_EQ(cut.remarks[0].severity, optics::Severity::error);
    EXPECT_TRUE(has_finding(cut, "not-understood", "DEL"));
    EXPECT_THROW(optics::make_lens(cut, {}), InputError);
}

// opticspy's singlet.seq has CUY UMY on its last surface; what the solve gave stands on the S line.
TEST(Seq, ASolvedCurvatureIsTheSurfaceLines) {
    const std::string head = "RDM;LEN\nEPD 4\nWL 500\nYAN 0\nSO 0 1e13\nS 50 5 500.600\n STO\nS 1175.7 96.57\n";
    const optics::Prescription lens = parse(head + " CUY UMY -0.1\n PIM\nSI 0 0\n");
    expect_same_rays(parse(head + "SI 0 0\n"), lens);
    EXPECT_TRUE(has_finding(lens, "solve", "CUY"));
    EXPECT_EQ(complaint(head + " CUY PINK\nSI 0 0\n"), "test.seq:9: CUY is \"PINK\", expected a radius or a curvature");
}

// rayoptics' asp46.seq: EPD 2, and an edge of 0.55 on the stop, which it and Optiland open to 2.
TEST(Seq, TheApertureOpensTheStopPastItsEdge) {
    const optics::Prescription lens = parse(
        "RDM;LEN\nEPD 2\nWL 587.6\nYAN 0\nSO 0 1e13\nS 50 1 500.700\n STO; CIR EDG 0.55\nS 0 2\n CIR EDG 0.55\nSI 0 "
        "0\n");
    EXPECT_NEAR(optics::make_lens(lens, {}).surfaces[0].semi_diameter, 1.0, 1e-12);
    EXPECT_EQ(lens.surfaces[1].rim_mm, 0.55);
}

TEST(Seq, EveryLineEndIsOne) {
    std::string old = kTessar;
    std::ranges::replace(old, '\n', '\r');
    expect_same_rays(parse(kTessar), parse(old));
}

TEST(Seq, NamesWhatItDoesNotUnderstand) {
    const optics::Prescription lens = parse(
        "LEN\nQQQ 1\nVUY 0 0.2\nNAO 0.1\nSO 0.1 100\nS 50 2 517642\n STO; ZZZ 1; REX 3; CCY 0\n DIF GRT; GRO 1\n"
        "S -0.01 3 REFL\n PIM; RET S1\nSI -0.01 0\n");
    EXPECT_TRUE(has_finding(lens, "not-understood", "line 2: QQQ"));
    EXPECT_TRUE(has_finding(lens, "not-understood", "line 7, surface 1 of the file: ZZZ"));
    EXPECT_TRUE(has_finding(lens, "not-understood", "RET"));
    EXPECT_TRUE(has_finding(lens, "aperture-shape", "REX"));
    EXPECT_TRUE(has_finding(lens, "surface-type", "DIF"));
    EXPECT_TRUE(lens.surfaces.at(1).is_mirror);
    EXPECT_TRUE(has_finding(lens, "solve", "PIM"));
    EXPECT_TRUE(has_finding(lens, "object-shape", ""));
    EXPECT_TRUE(has_finding(lens, "image-shape", ""));
    EXPECT_TRUE(has_finding(lens, "radius-mode", "taken as radii"));
    EXPECT_TRUE(has_finding(lens, "surface-type", "GRO"));
    EXPECT_EQ(lens.remarks.size(), 10U) << "each once";
    EXPECT_EQ(lens.surfaces[0].radius_mm, 50.0);
}

TEST(Seq, HostileFilesAreRefusedByLine) {
    const std::string head = "RDM;LEN\nSO 0 1e13\n";
    EXPECT_TRUE(says(complaint(""), "test.seq"));
    EXPECT_NE(complaint(std::string(1000, '\0')), "");
    EXPECT_NE(complaint("SO 0 1e13\nSI 0 0\n"), "") << "no lens";
    EXPECT_TRUE(says(complaint("S 1 2\n"), "test.seq:1: S, expected SO"));
    EXPECT_TRUE(says(complaint(head + "S x 2\n"), "test.seq:3: S is \"X\", expected a radius"));
    EXPECT_TRUE(says(complaint(head + "S 1\n"), "expected a thickness"));
    EXPECT_TRUE(says(complaint(head + "S10000000000 1 1\n"), "test.seq:3"));
    EXPECT_TRUE(says(complaint(head + "S 1 1\nTHI S99 1\n"), "expected a surface up to S1"));
    EXPECT_TRUE(says(complaint(head + "S 1 1\nZOO 10000000000\n"), "ZOO"));
    EXPECT_TRUE(says(complaint(head + "S 1 1\nZOO 3\nZOO THI S1 1 2\n"), "2 values"));
    EXPECT_TRUE(says(complaint(head + "PRV\nPWL 500 600\n'A' 1.5\nEND\n"), "1 indices"));
    EXPECT_TRUE(says(complaint(head + "PRV\nPWL 500 600 500\n"), ":4: PWL is \"500\", expected wavelengths"));
    EXPECT_TRUE(says(complaint(head + "PRV\nPWL 500 nan\n"), "PWL is \"NAN\""));
    EXPECT_TRUE(
        says(complaint(head + "PRV\nPWL 500 600\n'A' 1.5 15\n"), ":5: A is \"15\", expected a refractive index"));
    EXPECT_TRUE(says(complaint(head + "S 1 1 1.5:6O\nSI 0 0\n"), ":3: S1: its glass is \"1.5:6O\", expected n_d:V_d"));
    EXPECT_TRUE(says(complaint("DIM FURLONG\n"), "expected M, C or I"));
    EXPECT_NE(complaint(head + "S 1 inf\n ADE 1\nS 1 1\nSI 0 0\n"), "");
    EXPECT_EQ(complaint(head + "S nan -inf\nSI 0 0\n"), "") << "for the checker to say";
    EXPECT_EQ(complaint(head + "S 1 1\nTHI Z1 2\nZOO 5\nEPD &"),
              "test.seq:6: EPD is \"\", expected the aperture's value");
    EXPECT_EQ(complaint(head + "S 1 1\nTHI Z1 2\nZOO 5\n'unclosed"), "");
    std::string many = head;
    for (int i = 0; i < 2000; ++i) {
        many += "S 1 1;";
    }
    EXPECT_TRUE(says(complaint(many), "S1000"));
}

}  // namespace lensproof::formats::prescription_seq_test
