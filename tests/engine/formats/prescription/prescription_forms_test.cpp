// What each reader takes from a file, what it says it did not understand, and how it bears files that are none.
#include "engine/formats/prescription/prescription_forms.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "tests/complaint.h"

namespace lensproof::formats::prescription_forms_test {

using Parse = optics::Prescription (*)(const std::string&, const std::filesystem::path&);

/// The complaint about a text, or "" when there is none.
std::string complaint(Parse parse, const std::string& text) {
    return complaint_about([&] { parse(text, "folder/lens.x"); });
}

const optics::Finding* find_remark(const optics::Prescription& lens, const std::string& code, int surface = 0) {
    const auto found = std::ranges::find_if(
        lens.remarks, [&](const optics::Finding& remark) { return remark.code == code && remark.surface == surface; });
    return found == lens.remarks.end() ? nullptr : &*found;
}

void expect_remark(const optics::Prescription& lens, const std::string& code, int surface, const std::string& word) {
    const optics::Finding* remark = find_remark(lens, code, surface);
    ASSERT_NE(remark, nullptr) << code << " at surface " << surface;
    EXPECT_TRUE(says(remark->message, word));
}

const std::string kHeader = "surface,radius_mm,thickness_mm,n_d,V_d,semi_aperture_mm,kind";

TEST(CsvTable, TakesNumbersAsTheyAre) {
    const optics::Prescription lens =
        parse_csv_prescription("# A lens\n# source: a book\n# of 1950\n" + kHeader +
                                   "\n1,nan,-3,1.5,,0,glass\n2,0,inf,,,,air\n3,,1,1,,-4,stop\n"
                                   "4,Infinity,1,1,,1,stop\n",
                               "a.csv");
    EXPECT_EQ(lens.name, "A lens");
    EXPECT_EQ(lens.source, "a book");
    EXPECT_EQ(lens.notes, "of 1950");
    ASSERT_EQ(lens.surfaces.size(), 4U);
    EXPECT_TRUE(std::isnan(lens.surfaces[0].radius_mm));
    EXPECT_EQ(lens.surfaces[0].thickness_mm, -3.0);
    EXPECT_EQ(lens.surfaces[0].medium.n_d, 1.5);
    EXPECT_FALSE(lens.surfaces[0].medium.V_d);
    EXPECT_EQ(lens.surfaces[0].semi_diameter_mm, 0.0);
    EXPECT_TRUE(lens.surfaces[1].is_flat());
    EXPECT_EQ(lens.surfaces[1].thickness_mm, kInfinity);
    EXPECT_FALSE(lens.surfaces[1].semi_diameter_mm);
    EXPECT_TRUE(lens.surfaces[1].medium.is_air());
    EXPECT_TRUE(lens.surfaces[2].is_flat());
    EXPECT_EQ(lens.surfaces[2].semi_diameter_mm, -4.0);
    EXPECT_TRUE(lens.surfaces[3].is_flat());
    EXPECT_TRUE(lens.surfaces[2].is_stop && lens.surfaces[3].is_stop);
    EXPECT_TRUE(lens.remarks.empty());
}

TEST(CsvTable, ReadsGlassConicAndTermsAndNamesWhatItDoesNotCarry) {
    const optics::Prescription lens =
        parse_csv_prescription(kHeader +
                                   ",glass,conic,A2,A4,A5,A20,A22,mood\n"
                                   "1,50,4,,,10,glass,SCHOTT LAK9,-0.5,1e-3,1e-5,2e-6,1e-22,3,good\n"
                                   "2,-50,4,1.5,,10,air,,,,,,,,\n3,0,1,1.4,60,5,stop,,,,,0,,0,\n",
                               "a.csv");
    const optics::PrescribedSurface& first = lens.surfaces[0];
    EXPECT_EQ(first.medium.glass, "SCHOTT LAK9");
    EXPECT_FALSE(first.medium.n_d);
    EXPECT_EQ(first.conic, -0.5);
    EXPECT_EQ(first.asphere[0], 1e-3);
    EXPECT_EQ(first.asphere[1], 1e-5);
    EXPECT_EQ(first.asphere[9], 1e-22);
    EXPECT_EQ(first.odd_asphere, (optics::AsphereTerms{0.0, 0.0, 2e-6}));
    EXPECT_EQ(lens.surfaces[2].medium.n_d, 1.4) << "a stop keeps the medium that it states";
    expect_remark(lens, "asphere-term-not-read", 1, "A22 = 3");
    EXPECT_EQ(find_remark(lens, "asphere-term-not-read", 1)->severity, optics::Severity::error) << "another surface";
    EXPECT_EQ(find_remark(lens, "asphere-term-not-read", 3), nullptr) << "0 is no term";
    expect_remark(lens, "column-not-read", 0, "mood");
    expect_remark(lens, "kind-contradicts-index", 2, "air");
    EXPECT_EQ(lens.remarks.size(), 3U);
}

TEST(CsvTable, KnowsTheNamesThatOthersGiveItsColumns) {
    const optics::Prescription lens = parse_csv_prescription(
        "# product: A product\n# patent/source of numbers: US 1\n"
        "surface,R,d,nd,vd,nC,nF,ng,semi_diameter,K,A4\n"
        "1,39.03,2,1.62299,58.2,1.619739,1.63045,1.636296,25.6,,\n2A,9.1,1.5,1,,,,,5.1,-1,-0.00013\nSTO,inf,4,1,,,,,3,,"
        "\n",
        "a.csv");
    EXPECT_EQ(lens.name, "A product");
    EXPECT_EQ(lens.source, "US 1");
    const optics::StatedMedium& medium = lens.surfaces[0].medium;
    EXPECT_EQ(medium.n_d, 1.62299);
    EXPECT_EQ(medium.V_d, 58.2);
    ASSERT_EQ(medium.indices.size(), 4U);
    EXPECT_EQ(medium.indices[0].value, 1.636296);  // g, the shortest wavelength, first
    EXPECT_EQ(medium.indices[2].value, 1.62299);
    EXPECT_EQ(lens.surfaces[1].conic, -1.0);
    EXPECT_EQ(lens.surfaces[1].asphere[1], -0.00013);
    EXPECT_TRUE(lens.surfaces[2].is_stop);
    EXPECT_TRUE(lens.remarks.empty());
}

TEST(CsvTable, SaysWhereIndicesAtLinesAreNotUsed) {
    const optics::Prescription lens = parse_csv_prescription(
        kHeader +
            ",glass,n_C,n_F,n_g\n1,50,4,1.5,60,10,glass,BK7,1.49,1.51,1.52\n2,50,4,1.5,60,10,glass,,1.49,,\n"
            "3,50,4,1.5,60,10,glass,,1.49,15.1,1.52\n4,50,4,,,10,,,1.49,1.51,\n5,50,4,1,,10,air,,1,1,1\n"
            "6,50,4,1.5,60,10,glass,,1.49,1.51,\n7,50,4,,,10,,BK7,1.49,1.51,\n",
        "a.csv");
    ASSERT_EQ(lens.surfaces.size(), 7U);
    EXPECT_EQ(lens.surfaces[0].medium.n_d, 1.5);
    EXPECT_EQ(lens.surfaces[0].medium.V_d, 60.0);
    expect_remark(lens, "lines-not-used", 1, "BK7");
    EXPECT_EQ(find_remark(lens, "lines-not-used", 1)->severity, optics::Severity::info);
    expect_remark(lens, "lines-not-used", 2, "two or more");
    expect_remark(lens, "lines-not-used", 3, "from 1 to 5");
    expect_remark(lens, "lines-not-used", 4, "air");
    expect_remark(lens, "lines-not-used", 7, "BK7");
    EXPECT_EQ(lens.remarks.size(), 5U);
    EXPECT_EQ(lens.surfaces[5].medium.indices.size(), 3U);
    for (const int row : {0, 1, 2, 3, 4, 6}) {
        EXPECT_TRUE(lens.surfaces[row].medium.indices.empty()) << row;
    }
}

TEST(CsvTable, SaysWhatIsNoPrescription) {
    const std::string german = complaint(parse_csv_prescription, "radius_mm;thickness_mm;n_d\n50,5;4;1,5\n");
    EXPECT_TRUE(says(german, "lens.x:1: the header is"));
    EXPECT_TRUE(says(german, "separator is ';', expected ','"));
    EXPECT_TRUE(says(complaint(parse_csv_prescription, kHeader + "\n1,5O,4,1.5,60,10,glass\n"),
                     "lens.x:2: radius_mm is \"5O\", expected"));
    EXPECT_TRUE(says(complaint(parse_csv_prescription, kHeader + "\n1,5,4,1.5,60,10,prism\n"), "stop, glass or air"));
    EXPECT_TRUE(says(complaint(parse_csv_prescription, "x,y\n1,2\n"), "lens.x:1"));
    for (const std::string& text : {std::string(), kHeader, kHeader + "\n1,2\n", kHeader + "\n1,5,,1.5,60,10,glass\n",
                                    kHeader + "\n1,5,1,1e999,60,10,glass\n"}) {
        EXPECT_TRUE(says(complaint(parse_csv_prescription, text), "lens.x")) << text;
    }
}

TEST(PbrtLens, ReadsDiametersAndZeroForAirAndStop) {
    const optics::Prescription lens = parse_pbrt_lens(
        "# D-GAUSS F/2\n# from a book\n# radius\taxpos\tN\taperture\n29.475\t3.76\t1.67\t25.2\n84.83\t0.12\t1\t25.2\n"
        "0\t4.5\t0\t17.1  # the stop\n-39.73 35.5 0 20",
        "a.dat");
    EXPECT_EQ(lens.name, "D-GAUSS F/2");
    ASSERT_EQ(lens.surfaces.size(), 4U);
    EXPECT_EQ(lens.surfaces[0].medium.n_d, 1.67);
    EXPECT_FALSE(lens.surfaces[0].medium.V_d);
    EXPECT_EQ(lens.surfaces[0].semi_diameter_mm, 12.6);
    EXPECT_TRUE(lens.surfaces[1].medium.is_air());
    EXPECT_TRUE(lens.surfaces[2].is_stop);
    EXPECT_TRUE(lens.surfaces[2].is_flat());
    EXPECT_EQ(lens.surfaces[3].thickness_mm, 35.5);
    EXPECT_TRUE(lens.remarks.empty());
}

TEST(PbrtLens, SaysWhatItTookUponItself) {
    // A thin lens of two equal radii: 1/f = 2 (n − 1) / R = 1/100, and nothing is between it and its focus.
    const optics::Prescription lens = parse_pbrt_lens("100 0 1.5 20 60\n-100 0 1 20\n", "a.dat");
    EXPECT_NEAR(lens.surfaces[1].thickness_mm, 100.0, 1e-12);
    expect_remark(lens, "sensor-placed", 2, "100 mm");
    expect_remark(lens, "thickness-shifted", 1, "before");
    expect_remark(lens, "column-beyond-pbrt", 1, "60");
    EXPECT_EQ(lens.surfaces[0].medium.V_d, 60.0);
    const optics::Prescription flat = parse_pbrt_lens("100 5 1.5 20\n0 10 0 20\n", "a.dat");
    EXPECT_FALSE(flat.surfaces[1].is_stop);
    expect_remark(flat, "flat-or-stop", 2, "flat");
}

TEST(PbrtLens, SaysWhatIsNoPrescription) {
    EXPECT_TRUE(says(complaint(parse_pbrt_lens, "29,475 3.76 1.67 25.2\n"), "found \"29,475\""));
    EXPECT_TRUE(says(complaint(parse_pbrt_lens, "# x\n1 2 3\n"), "lens.x:2: 3 numbers"));
    EXPECT_TRUE(says(complaint(parse_pbrt_lens, "1 2 three 4\n"), "lens.x:1: found \"three\""));
    EXPECT_NE(complaint(parse_pbrt_lens, "1 2 3 4 5 6\n"), "");
    EXPECT_TRUE(says(complaint(parse_pbrt_lens, "# only words\n"), "no row"));
    std::string endless;
    for (int row = 0; row < 2000; ++row) {
        endless += "1 2 1.5 4\n";
    }
    EXPECT_TRUE(says(complaint(parse_pbrt_lens, endless), "more than"));
    EXPECT_EQ(complaint(parse_pbrt_lens, "nan inf -1 nan\n"), "") << "numbers, whether they make sense or not";
}

TEST(FxTable, ReadsGlassIrisZoomCylindersAspheresAndScale) {
    const optics::Prescription lens = parse_fx(
        "// CANON; US PAT 5,537,259\n#EFL\t70\t135\t200\t// effective focal length\n#!scale 0.5\n\n"
        "311.919\t2.80\t\tLAFN7\t1.7495\t35\t38\n"
        "-263.46 8.78/26.15 /32.85\tair\t38\t// variable\n"
        "10000 0.24 IRIS 21\n"
        "20 4 abbe 1.5 80 9 #!aspheric=-1,8e-5,9e-8\n"
        "-128 30 cx_abbe 1.7 44 40\n100000 5 air 9",
        "a.fx");
    ASSERT_EQ(lens.surfaces.size(), 6U);
    EXPECT_EQ(lens.name, "CANON; US PAT 5,537,259");
    EXPECT_DOUBLE_EQ(lens.surfaces[0].radius_mm, 155.9595);
    EXPECT_EQ(lens.surfaces[0].medium.glass, "LAFN7");
    EXPECT_EQ(lens.surfaces[0].medium.n_d, 1.7495);
    EXPECT_DOUBLE_EQ(*lens.surfaces[0].semi_diameter_mm, 19.0);
    EXPECT_TRUE(lens.surfaces[2].is_stop && lens.surfaces[2].is_flat() && lens.surfaces[2].medium.is_air());
    // A lens half the size has the same shape: z(r) = A r⁴ becomes z/2 = A' (r/2)⁴, so A' = 8 A.
    EXPECT_DOUBLE_EQ(lens.surfaces[3].asphere[1], 8 * 8e-5);
    EXPECT_DOUBLE_EQ(lens.surfaces[3].asphere[2], 32 * 9e-8);
    EXPECT_EQ(lens.surfaces[3].conic, -1.0);
    EXPECT_EQ(lens.surfaces[3].medium.glass, "");
    EXPECT_EQ(lens.surfaces[4].radius_x_mm, -64.0);
    EXPECT_TRUE(lens.surfaces[4].is_flat());
    ASSERT_EQ(lens.zoom.size(), 3U);
    EXPECT_EQ(lens.zoom[1].name, "mid");
    EXPECT_DOUBLE_EQ(lens.zoom[1].gaps_mm.at(2), 13.075);
    EXPECT_DOUBLE_EQ(*lens.zoom[2].stated.efl_mm, 100.0);
    expect_remark(lens, "scaled", 0, "0.5");
    EXPECT_NE(find_remark(lens, "radius-for-flat"), nullptr);
    EXPECT_EQ(lens.remarks.size(), 2U);
}

TEST(FxTable, ScaleIsOfEveryRowWhereverItStands) {
    const std::string rows = "10 3 abbe 1.5 60 5\n-20 4 air 5\n";
    const optics::Prescription lens = parse_fx(rows + "#!scale 2\n", "a.fx");
    EXPECT_EQ(lens.surfaces[0].radius_mm, 20.0);
    EXPECT_EQ(lens.surfaces[0].thickness_mm, 6.0);
    EXPECT_EQ(lens.surfaces[1].semi_diameter_mm, 10.0);
    EXPECT_TRUE(says(complaint(parse_fx, "#!scale 2\n" + rows + "#!scale 3\n"), "lens.x:4: found \"#!scale 3\""));
}

TEST(FxTable, AnIrisInsideGlassKeepsIt) {
    const optics::Prescription lens = parse_fx("6.5 3 abbe 1.3374 70 5\n100000 0.01 iris 3\n10.2 4 air 5\n", "a.fx");
    EXPECT_EQ(lens.surfaces[1].medium.n_d, 1.3374);
}

TEST(FxTable, NamesWhatItDoesNotUnderstand) {
    const optics::Prescription lens =
        parse_fx("#!curved_sensor 12\n#EFL 1 2\n10 3/4/5 air 5 7\n20 1/2 air 5\n", "a.fx");
    expect_remark(lens, "line-not-read", 0, "curved_sensor");
    expect_remark(lens, "column-not-read", 1, "7");
    expect_remark(lens, "zoom-gap-missing", 2, "repeated");
}

TEST(FxTable, SaysWhatIsNoPrescription) {
    for (const auto& [text, word] : std::vector<std::pair<std::string, std::string>>{
             {"", "no row"},
             {"# words", "no row"},
             {"10 3 air", ":1: found \"10 3 air\""},
             {"10 x air 5", "thickness"},
             {"10 3 1.5 60 5", "material"},
             {"10 3 abbe 1.5", "n_d and V_d"},
             {"10 3 abbe 1.5 60", "semi-diameter"},
             {"10 1/2/3/4 air 5", "three"},
             {"10 / air 5", "thickness"},
             {"#!scale nan\n10 1 air 5", "positive"},
             {"10 1 air 5 #!aspheric=x", "#!aspheric"},
             {"10 1 air 5 #!aspheric=1,2,3,4,5,6,7,8,9,10,11,12", "#!aspheric"}}) {
        const std::string said = complaint(parse_fx, text);
        EXPECT_TRUE(says(said, "lens.x")) << text;
        EXPECT_TRUE(says(said, word)) << text;
    }
}

/// A lens as Optiland 0.6.3 saves it, cut to what matters; its image points are those of Optiland's own tracer.
constexpr const char* kOptiland = R"({
 "version": 1.0, "name": "Tilted", "aperture": {"type": "EPD", "value": 10.0},
 "fields": {"fields": [{"x": 0.0, "y": 12, "vx": 0.0, "vy": 0.1, "weight": 1.0}], "telecentric": false,
            "field_definition": {"field_type": "AngleField"}},
 "wavelengths": {"wavelengths": [{"value": 0.4861327, "is_primary": false, "unit": "um", "weight": 1.0},
                                 {"value": 0.5875618, "is_primary": true, "unit": "um", "weight": 1.0}],
                 "polarization": "ignore"},
 "apodization": null, "pickups": [], "solves": {"solves": []}, "mood": "good",
 "surface_group": {"surfaces": [
  {"type": "ObjectSurface", "geometry": {"type": "Plane", "cs": {"x": 0.0, "y": 0.0, "z": -Infinity, "rx": 0.0,
   "ry": 0.0, "rz": 0.0, "reference_cs": null}, "radius": Infinity}, "material_post": {"type": "IdealMaterial",
   "index": 1.0, "absorp": 0.0}},
  {"type": "Surface", "thickness": 5, "geometry": {"type": "StandardGeometry", "cs": {"x": 0.0, "y": 0.0, "z": 0.0,
   "rx": 0.0, "ry": 0.0, "rz": 0.0, "reference_cs": null}, "radius": 50.0, "conic": -0.5},
   "material_post": {"type": "IdealMaterial", "index": 1.6, "absorp": 0.0}, "is_stop": false,
   "aperture": {"type": "RadialAperture", "r_max": 10.0, "r_min": 0}, "interaction_model":
   {"type": "RefractiveReflectiveModel", "is_reflective": false, "coating": {"type": "SimpleCoating"}, "bsdf": null}},
  {"type": "Surface", "thickness": 8, "geometry": {"type": "EvenAsphere", "cs": {"x": 0.0, "y": 0.0, "z": [5.0],
   "rx": 0.0, "ry": 0.0, "rz": 0.0, "reference_cs": null}, "radius": -80.0, "conic": 0.1,
   "coefficients": [1e-05, 1e-06, 2e-09]}, "material_post": {"type": "IdealMaterial", "index": 1.0, "absorp": 0.0}},
  {"type": "Surface", "thickness": 6, "geometry": {"type": "Plane", "cs": {"x": 0.0, "y": 0.0, "z": 13.0, "rx": 0.0,
   "ry": 0.0, "rz": 0.0, "reference_cs": null}, "radius": Infinity}, "is_stop": true,
   "material_post": {"type": "IdealMaterial", "index": 1.0, "absorp": 0.0}},
  {"type": "Surface", "thickness": 4, "geometry": {"type": "StandardGeometry", "cs": {"x": -0.2, "y": 0.3, "z": 19.0,
   "rx": 0.05, "ry": -0.08, "rz": 0.3, "reference_cs": null}, "radius": 40.0, "conic": 0.0},
   "material_post": {"type": "AbbeMaterial", "index": 1.5, "abbe": 60.0, "model": "polynomial"}},
  {"type": "Surface", "thickness": 30, "geometry": {"type": "ToroidalGeometry", "cs": {"x": 0.0, "y": 0.0, "z": 23.0,
   "rx": 0.0, "ry": 0.0, "rz": 0.0, "reference_cs": null}, "radius": -40.0, "radius_x": -55.0, "radius_y": -40.0,
   "conic_yz": 0.2, "coeffs_poly_y": [1e-05, -1e-07]}, "material_post": {"type": "Material", "name": "F2",
   "filename": "/x/data-nk/glass/schott/F2.yml"}},
  {"type": "Surface", "thickness": 0.0, "geometry": {"type": "Plane", "cs": {"x": 0.0, "y": 0.0, "z": 53.0, "rx": 0.0,
   "ry": 0.0, "rz": 0.0, "reference_cs": null}, "radius": Infinity}, "material_post": {"type": "IdealMaterial",
   "index": 1.0, "absorp": 0.0}}]}})";

TEST(Optiland, ReadsWhatItSaves) {
    const optics::Prescription lens = parse_optiland(kOptiland, "a.json");
    EXPECT_EQ(lens.name, "Tilted");
    ASSERT_EQ(lens.surfaces.size(), 5U);
    EXPECT_EQ(lens.surfaces[0].radius_mm, 50.0);
    EXPECT_EQ(lens.surfaces[0].conic, -0.5);
    EXPECT_EQ(lens.surfaces[0].semi_diameter_mm, 10.0);
    EXPECT_EQ(lens.surfaces[0].medium.n_d, 1.6);
    EXPECT_EQ(lens.surfaces[1].thickness_mm, 8.0);
    EXPECT_EQ(lens.surfaces[1].asphere[1], 1e-6);
    EXPECT_TRUE(lens.surfaces[1].medium.is_air());
    EXPECT_TRUE(lens.surfaces[2].is_stop);
    EXPECT_EQ(lens.surfaces[3].medium.V_d, 60.0);
    EXPECT_EQ(lens.surfaces[4].radius_x_mm, -55.0);
    EXPECT_EQ(lens.surfaces[4].medium.glass, "SCHOTT F2");
    EXPECT_EQ(lens.surfaces[4].thickness_mm, 30.0);
    EXPECT_EQ(lens.aperture, (optics::SystemAperture{optics::ApertureKind::entrance_pupil_diameter, 10.0}));
    EXPECT_EQ(lens.fields.vignetting.size(), lens.fields.points.size()) << "one of them is vignetted";
    EXPECT_EQ(lens.stated.half_field_deg, 12.0);
    EXPECT_EQ(lens.wavelengths_nm, (std::vector<double>{587.5618, 486.1327}));
    EXPECT_EQ(lens.object_distance_mm, kInfinity);
    expect_remark(lens, "coating-not-read", 1, "coating");
    expect_remark(lens, "dispersion-model", 4, "normal line");
    ASSERT_EQ(lens.remarks.size(), 3U);  // and "mood"
    EXPECT_TRUE(says(lens.remarks.back().message, "mood"));
}

/// `text` with its first `from` replaced.
std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// Optiland's odd asphere has a coefficient for every power, from r (optiland/geometries/odd_asphere.py).
TEST(Optiland, ReadsOddAspheres) {
    const optics::Prescription lens = parse_optiland(replaced(kOptiland, "EvenAsphere", "OddAsphere"), "a.json");
    const optics::PrescribedSurface& surface = lens.surfaces[1];
    EXPECT_EQ(surface.term(1), 1e-5);
    EXPECT_EQ(surface.term(2), 1e-6);
    EXPECT_EQ(surface.term(3), 2e-9);
    EXPECT_EQ(find_remark(lens, "shape-not-read", 2), nullptr);
}

TEST(Optiland, AnApertureWithoutEndIsNone) {
    const optics::Prescription lens =
        parse_optiland(replaced(kOptiland, "\"r_max\": 10.0", "\"r_max\": Infinity"), "a.json");
    EXPECT_FALSE(lens.surfaces[0].semi_diameter_mm);
}

TEST(Optiland, NamesWhatItDoesNotUnderstand) {
    const optics::Prescription mirror =
        parse_optiland(replaced(kOptiland, "\"is_reflective\": false", "\"is_reflective\": true"), "a.json");
    EXPECT_TRUE(mirror.surfaces[0].is_mirror);
    const optics::Prescription odd = parse_optiland(replaced(kOptiland, "EvenAsphere", "ZernikePolynomial"), "a.json");
    expect_remark(odd, "shape-not-read", 2, "ZernikePolynomial");
    EXPECT_EQ(find_remark(odd, "shape-not-read", 2)->severity, optics::Severity::error);
    const optics::Prescription terms =
        parse_optiland(replaced(kOptiland, "2e-09]", "2e-09, 0, 0, 0, 0, 0, 0, 0, 1e-30, 0]"), "a.json");
    expect_remark(terms, "asphere-term-not-read", 2, "r^22");
    EXPECT_EQ(find_remark(terms, "asphere-term-not-read", 2)->severity, optics::Severity::error);
    EXPECT_EQ(terms.remarks.size(), 4U) << "and the three of the lens as it is; 0 is no term";
    const optics::Prescription stuff =
        parse_optiland(replaced(kOptiland, "AbbeMaterial", "GradientMaterial"), "a.json");
    expect_remark(stuff, "material-not-read", 4, "GradientMaterial");
    const optics::Prescription rim = parse_optiland(replaced(kOptiland, "RadialAperture", "PolygonAperture"), "a.json");
    expect_remark(rim, "aperture-not-read", 1, "PolygonAperture");
}

TEST(Optiland, SaysWhatIsNoPrescription) {
    for (const auto& [text, word] : std::vector<std::pair<std::string, std::string>>{
             {"", "not JSON"},
             {"{", "not JSON"},
             {"[1, 2]", "surface_group"},
             {R"({"surface_group": {"surfaces": 3}})", "surfaces is 3: expected a list"},
             {R"({"surface_group": {"surfaces": []}})", "0 surfaces"},
             {replaced(kOptiland, "\"radius\": 50.0", "\"radius\": \"5O\""), "surfaces[1].geometry.radius is"},
             {replaced(kOptiland, "\"radius\": 50.0", "\"radius\": [1, 2]"), "expected a number"},
             {replaced(kOptiland, "\"radius\": 50.0", "\"radius\": 1e999"), "cannot be read"},
             {replaced(kOptiland, "\"cs\"", "\"sc\""), "surfaces[0].geometry.cs is missing"},
             {std::string(100000, '['), "brackets"},
             {replaced(kOptiland, "Tilted", "Til\xffted"), "lens.x"}}) {
        const std::string said = complaint(parse_optiland, text);
        EXPECT_TRUE(says(said, "lens.x")) << text.substr(0, 100);
        EXPECT_TRUE(says(said, word)) << text.substr(0, 100);
    }
}

TEST(EveryReader, KnowsEveryLineEnd) {
    const std::vector<std::pair<Parse, std::string>> files = {
        {parse_csv_prescription, "# x\n# a note\n" + kHeader + "\n1,50,4,1.5,60,10,glass\n2,-50,4,1,,10,air\n"},
        {parse_pbrt_lens, "# x\n# a note\n100 5 1.5 20\n-100 10 0 20\n"},
        {parse_fx, "# x\n# a note\n10 3 abbe 1.5 60 5\n10 1 air 5\n"}};
    for (const auto& [parse, text] : files) {
        for (const std::string end : {"\n", "\r", "\r\n"}) {
            std::string ended;
            for (const char letter : text) {
                ended += letter == '\n' ? end : std::string(1, letter);
            }
            const optics::Prescription lens = parse(ended, "a.x");
            ASSERT_EQ(lens.surfaces.size(), 2U) << text;
            EXPECT_EQ(lens.name, "x");
            EXPECT_EQ(lens.notes, "a note");
            EXPECT_EQ(lens.surfaces[1].where, parse(text, "a.x").surfaces[1].where);
        }
    }
}

// Every reader, on what none of them should fall over: bytes of any kind, and good files cut anywhere.
TEST(EveryReader, BearsNoiseAndCutFiles) {
    std::string noise;
    std::uint32_t state = 1;
    for (int i = 0; i < 3000; ++i) {
        noise += static_cast<char>((state = 1664525U * state + 1013904223U) >> 24U);
    }
    const std::vector<std::pair<Parse, std::string>> good = {
        {parse_csv_prescription, "# x\n" + kHeader + ",glass,A4\n1,50,4,1.5,60,10,glass,\"BK7\",1e-5\n"},
        {parse_pbrt_lens, "# x\n100 5 1.5 20\n0 10 0 20\n"},
        {parse_fx, "#!scale .5\n10 3/4 abbe 1.5 60 5 #!aspheric=0,1e-5\n10 1 air 5\n"},
        {parse_optiland, kOptiland},
        {parse_toml_prescription, "name = \"x\"\nsource = \"y\"\nsurfaces = [{ stop = true, thickness_mm = 1 }]\n"}};
    for (const auto& [parse, text] : good) {
        EXPECT_EQ(complaint(parse, text), "");
        EXPECT_NE(complaint(parse, noise), "");
        EXPECT_NE(complaint(parse, std::string(1000, '\0')), "");
        const std::size_t step = std::max<std::size_t>(1, text.size() / 300);
        for (std::size_t size = 0; size < text.size(); size += step) {
            complaint(parse, text.substr(0, size));  // an InputError or a lens, nothing else
        }
    }
}

}  // namespace lensproof::formats::prescription_forms_test
