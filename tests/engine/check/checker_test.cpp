// Each finding is provoked by one defect planted in a lens that does not have it, and values are computed by hand.
#include "engine/check/checker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "engine/base/infinity.h"
#include "engine/check/digits.h"
#include "engine/check/sag.h"
#include "engine/formats/prescription/prescription_file.h"
#include "tests/complaint.h"
#include "tests/engine/check/checker_case.h"
#include "tests/places.h"

namespace lensproof::check::checker_test {

optics::Prescription tessar() {
    return formats::read_prescription(formats::find_lens_file("tessar"));
}

/// One defect and what must be said of it.
struct Defect {
    const char* name;
    std::function<void(optics::Prescription&)> plant;
    const char* code;
    optics::Severity severity;
    int surface;  // 0: the lens
};

std::vector<Defect> defects_of_the_tessar() {
    using P = optics::Prescription;
    using enum optics::Severity;
    return {
        {"radius NaN", [](P& p) { p.surfaces[0].radius_mm = kNaN; }, "not-finite", error, 1},
        {"thickness infinite", [](P& p) { p.surfaces[1].thickness_mm = INFINITY; }, "not-finite", error, 2},
        {"index NaN", [](P& p) { p.surfaces[0].medium = {.n_d = kNaN}; }, "not-finite", error, 1},
        {"flat spelt 1e8", [](P& p) { p.surfaces[2].radius_mm = 1e8; }, "flat-radius", info, 3},
        {"flat spelt 0", [](P& p) { p.surfaces[2].radius_mm = 0; }, "flat-radius", info, 3},
        {"no stop", [](P& p) { p.surfaces[3].is_stop = false; }, "stop-missing", error, 0},
        {"two stops", [](P& p) { p.surfaces[5].is_stop = true; }, "stop-doubled", error, 6},
        {"stop last",
         [](P& p) {
             p.surfaces[3].is_stop = false;
             p.surfaces[7].is_stop = true;
         },
         "stop-position", warning, 8},
        {"thickness negative", [](P& p) { p.surfaces[5].thickness_mm = -1; }, "negative-thickness", error, 6},
        {"sensor in front", [](P& p) { p.surfaces[7].thickness_mm = -1; }, "negative-thickness", error, 8},
        {"glass without thickness", [](P& p) { p.surfaces[4].thickness_mm = 0; }, "zero-thickness", error, 5},
        {"air without thickness", [](P& p) { p.surfaces[5].thickness_mm = 0; }, "zero-thickness", warning, 6},
        {"no sensor", [](P& p) { p.surfaces[7].thickness_mm = 0; }, "no-image-distance", info, 8},
        {"no semi-diameter", [](P& p) { p.surfaces[7].semi_diameter_mm.reset(); }, "semi-diameter-missing", info, 8},
        {"semi-diameter negative", [](P& p) { p.surfaces[7].semi_diameter_mm = -3; }, "semi-diameter-not-positive",
         error, 8},
        {"semi-diameter beyond the sphere", [](P& p) { p.surfaces[5].semi_diameter_mm = 41; },
         "semi-diameter-beyond-sphere", error, 6},
        {"radius of a nanometre", [](P& p) { p.surfaces[5].radius_mm = 1e-6; }, "extreme-value", error, 6},
        {"thickness of 20 m", [](P& p) { p.surfaces[5].thickness_mm = 2e4; }, "extreme-value", warning, 6},
        {"row repeated", [](P& p) { p.surfaces.insert(p.surfaces.begin() + 6, p.surfaces[6]); }, "duplicate-surface",
         warning, 8},
        {"edge negative", [](P& p) { p.surfaces[6].thickness_mm = 2.5; }, "edge-thickness", error, 7},
        {"surfaces crossed", [](P& p) { p.surfaces[5].thickness_mm = 2.0; }, "surfaces-cross", error, 6},
        {"same glass twice", [](P& p) { p.surfaces[1].medium = p.surfaces[0].medium; }, "no-index-step", warning, 2},
        {"index below 1", [](P& p) { p.surfaces[0].medium = {.n_d = 0.9, .V_d = 50.0}; }, "index-range", error, 1},
        {"index of diamond", [](P& p) { p.surfaces[0].medium = {.n_d = 2.4, .V_d = 50.0}; }, "index-range", warning, 1},
        {"V_d of 5", [](P& p) { p.surfaces[0].medium = {.n_d = 1.691, .V_d = 5.0}; }, "abbe-range", warning, 1},
        {"V_d negative", [](P& p) { p.surfaces[0].medium = {.n_d = 1.691, .V_d = -5.0}; }, "abbe-range", error, 1},
        {"glass unknown", [](P& p) { p.surfaces[0].medium.glass = "LAK999"; }, "glass-unknown", error, 1},
        {"glass unknown beside n_d",
         [](P& p) { p.surfaces[0].medium = {.glass = "LAK999", .n_d = 1.691, .V_d = 54.7}; }, "glass-unknown", warning,
         1},
        {"n_d at odds", [](P& p) { p.surfaces[0].medium.n_d = 1.961; }, "glass-index", error, 1},
        {"n_d rounded", [](P& p) { p.surfaces[4].medium.n_d = 1.640; }, "glass-index", info, 5},
        {"V_d at odds", [](P& p) { p.surfaces[0].medium.V_d = 45.7; }, "glass-abbe", error, 1},
        {"V_d a little off", [](P& p) { p.surfaces[0].medium.V_d = 53.5; }, "glass-abbe", warning, 1},
        {"no V_d", [](P& p) { p.surfaces[0].medium = {.n_d = 1.691}; }, "no-dispersion", warning, 1},
        {"n_d and V_d alone", [](P& p) { p.surfaces[0].medium = {.n_d = 1.691, .V_d = 54.7}; }, "normal-line", info, 1},
        {"dispersion upside down",
         [](P& p) {
             p.surfaces[0].medium = {.indices = {{400, 1.68}, {587.5618, 1.691}, {700, 1.70}}};
         },
         "dispersion-order", warning, 1},
        {"range too short",
         [](P& p) {
             p.surfaces[0].medium = {.indices = {{450, 1.70}, {587.5618, 1.691}, {700, 1.68}}};
         },
         "wavelength-range", warning, 1},
        {"no air at the end", [](P& p) { p.surfaces[7].medium.glass = "BK7"; }, "last-medium", warning, 8},
        {"not traceable",
         [](P& p) {
             p.stated = {};
             p.surfaces[7].thickness_mm = 0;
             p.surfaces[7].coating = "none such";
         },
         "not-traceable", error, 0},
        {"focal length off", [](P& p) { p.stated.efl_mm = 98.0; }, "focal-length", error, 0},
        {"focal length a little off", [](P& p) { p.stated.efl_mm = 99.5; }, "focal-length", warning, 0},
        {"back focus off", [](P& p) { p.stated.bfl_mm = 75.0; }, "back-focus", error, 0},
        {"sensor off", [](P& p) { p.surfaces[7].thickness_mm = 77.0; }, "back-focus", error, 8},
        {"f-number off", [](P& p) { p.stated.f_number = 3.5; }, "f-number", error, 4},
        {"pupil off", [](P& p) { p.stated.entrance_pupil_diameter_mm = 30; }, "entrance-pupil", error, 4},
        {"track off", [](P& p) { p.stated.total_track_mm = 121; }, "total-track", warning, 0},
        {"diverging",
         [](P& p) {
             p.surfaces[0].radius_mm *= -1;
             p.surfaces[7].radius_mm *= -1;
         },
         "negative-power", error, 0},
        {"no power",
         [](P& p) {
             for (optics::PrescribedSurface& surface : p.surfaces) {
                 surface.radius_mm = INFINITY;
             }
         },
         "no-power", error, 0},
        {"image in front",
         [](P& p) {
             // The first surface focuses 150 mm behind itself, inside 200 mm of glass; the whole is still positive.
             p.stated = {};
             p.surfaces.erase(p.surfaces.begin() + 4, p.surfaces.end());
             p.surfaces[0] = {.radius_mm = 50, .thickness_mm = 200, .semi_diameter_mm = 5, .medium = {.n_d = 1.5}};
             p.surfaces[1] = {.radius_mm = -500, .thickness_mm = 1, .semi_diameter_mm = 5};
             p.surfaces[2] = {.thickness_mm = 0, .semi_diameter_mm = 3, .is_stop = true};
             p.surfaces.resize(3);
         },
         "image-in-front", warning, 3},
        {"sensor in the last element",
         [](P& p) {
             p.surfaces[7].radius_mm = 20;
             p.surfaces[7].thickness_mm = 3;
         },
         "sensor-inside-lens", error, 8},
        {"diameters",
         [](P& p) {
             for (optics::PrescribedSurface& surface : p.surfaces) {
                 *surface.semi_diameter_mm *= 2;
             }
         },
         "diameters", warning, 0},
        {"one diameter", [](P& p) { p.surfaces[1].semi_diameter_mm = 38.4; }, "diameters", warning, 2},
        {"faster than f/0.5",
         [](P& p) {
             p.stated = {};
             p.surfaces[3].semi_diameter_mm = 90;
         },
         "f-number", warning, 4},
        {"slower than f/16",
         [](P& p) {
             p.stated = {};
             p.surfaces[3].semi_diameter_mm = 2;
         },
         "f-number", warning, 4},
        {"a radius in inches", [](P& p) { p.surfaces[0].radius_mm /= 25.4; }, "units", warning, 1},
        {"a gap in cm", [](P& p) { p.surfaces[5].thickness_mm /= 10; }, "units", warning, 6},
        {"f = 1",
         [](P& p) {
             p.stated = {};
             for (optics::PrescribedSurface& surface : p.surfaces) {
                 surface.radius_mm /= 100;
                 surface.thickness_mm /= 100;
                 *surface.semi_diameter_mm /= 100;
             }
         },
         "units", warning, 0},
        {"signs turned",
         [](P& p) {
             for (optics::PrescribedSurface& surface : p.surfaces) {
                 surface.radius_mm *= -1;
             }
         },
         "reversed", warning, 0},
        {"rim before the stop", [](P& p) { p.surfaces[4].semi_diameter_mm = 10; }, "stop-not-limiting", warning, 5},
        {"total reflection",
         [](P& p) {
             p.surfaces[3].semi_diameter_mm = 19;
             p.surfaces[2].radius_mm = -21;
         },
         "marginal-ray", error, -1},
        {"no focus", [](P& p) { p.surfaces[4].radius_mm = -40.0; }, "blur", warning, 0},
        {"colour", [](P& p) { p.surfaces[4].medium = {.n_d = 1.6398, .V_d = 64.6}; }, "axial-colour", warning, 0},
        {"field clipped", [](P& p) { p.surfaces[7].semi_diameter_mm = 10; }, "chief-ray", warning, 8},
        {"field never reached", [](P& p) { p.stated.half_field_deg = 40; }, "chief-ray", error, 8},
        {"no light at the field",
         [](P& p) {
             p.surfaces[3].semi_diameter_mm = 1;
             p.surfaces[0].semi_diameter_mm = 3;
         },
         "vignetting", error, 0},
        {"little light at the field",
         [](P& p) {
             p.surfaces[3].semi_diameter_mm = 3;
             p.surfaces[0].semi_diameter_mm = 4;
         },
         "vignetting", warning, 0},
        {"full field for half", [](P& p) { p.stated.half_field_deg = 88; }, "chief-ray", error, -1},
        {"image circle", [](P& p) { p.stated.image_circle_mm = 60; }, "image-circle", warning, 0},
        {"conic that ends", [](P& p) { p.surfaces[0].conic = 6; }, "semi-diameter-beyond-sphere", error, 1},
        {"asphere that turns over", [](P& p) { p.surfaces[0].asphere[2] = -1e-6; }, "asphere-turns-over", warning, 1},
    };
}

std::vector<Defect> customs_that_the_tessar_keeps() {
    using P = optics::Prescription;
    using enum optics::Severity;
    return {
        {"steep", [](P& p) { p.surfaces[5].semi_diameter_mm = 30; }, "steep-surface", info, 6},
        {"centre thin", [](P& p) { p.surfaces[4].thickness_mm = 0.5; }, "centre-thickness", info, 5},
        {"edge thin", [](P& p) { p.surfaces[6].thickness_mm = 4.5; }, "edge-thickness", info, 7},
        {"gap narrow", [](P& p) { p.surfaces[5].thickness_mm = 2.76; }, "air-gap", info, 6},
        {"centring", [](P& p) { p.surfaces[6].radius_mm = -500; }, "centring", info, 7},
        {"nearly flat", [](P& p) { p.surfaces[6].radius_mm = 3000; }, "nearly-flat", info, 7},
    };
}

void expect_named(const std::vector<Defect>& defects, const CheckSettings& settings) {
    const CheckReport good = checked(tessar(), {}, settings);
    EXPECT_TRUE(good.ok());
    for (const Defect& defect : defects) {
        SCOPED_TRACE(defect.name);
        optics::Prescription bad = tessar();
        defect.plant(bad);
        const CheckReport report = checked(bad, {}, settings);
        const optics::Finding* finding = find(report, defect.code, defect.surface);
        EXPECT_NE(finding, nullptr) << said(report);
        if (finding == nullptr) {
            continue;
        }
        EXPECT_EQ(finding->severity, defect.severity) << finding->message;
        EXPECT_FALSE(finding->message.empty());
        const optics::Finding* before = find(good, defect.code, finding->surface);
        EXPECT_TRUE(before == nullptr || before->message != finding->message) << "the good lens has it too";
        EXPECT_EQ(report.ok(), std::ranges::none_of(report.findings, [](const optics::Finding& other) {
                      return other.severity == optics::Severity::error;
                  }));
    }
}

TEST(Checker, EachDefectIsNamed) {
    expect_named(defects_of_the_tessar(), {});
}

TEST(Checker, CustomsOfManufactureAreNamedWhenAskedFor) {
    expect_named(customs_that_the_tessar_keeps(), {.indices = {}, .zoom_position = {}, .manufacture = true});
    for (const Defect& custom : customs_that_the_tessar_keeps()) {
        optics::Prescription unusual = tessar();
        custom.plant(unusual);
        EXPECT_EQ(find(checked(unusual), custom.code), nullptr) << custom.name;
    }
}

// A biconvex lens of R = ±50, 4 mm thick, semi-diameter 20: each sag is 50 − √(2500 − 400) = 4.1742431 mm, so its edge
// is 4 − 2 · 4.1742431 = −4.3484861 mm.
TEST(Checker, EdgeThicknessIsThicknessLessSags) {
    optics::Prescription lens = tessar();
    lens.stated = {};
    lens.surfaces.resize(3);
    lens.surfaces[0] = {.radius_mm = 50.0, .thickness_mm = 4.0, .semi_diameter_mm = 20.0, .medium = {.n_d = 1.5}};
    lens.surfaces[1] = {.radius_mm = -50.0, .thickness_mm = 10.0, .semi_diameter_mm = 20.0};
    lens.surfaces[2] = {.thickness_mm = 30.0, .semi_diameter_mm = 5.0, .is_stop = true};
    const CheckReport report = checked(lens);
    const optics::Finding* edge = find(report, "edge-thickness", 1);
    ASSERT_NE(edge, nullptr);
    EXPECT_NEAR(edge->value, -4.348486100883, 1e-9);
    EXPECT_EQ(edge->limit, 0.0);
    EXPECT_EQ(edge->unit, "mm");
}

// 1/f = (n − 1)(1/R1 − 1/R2 + (n − 1) t / (n R1 R2)) (the lensmaker's equation), n = 1.5, R = ±50, t = 6: f = 51.0204.
TEST(Checker, ComputedDataFollowTheLensmakersEquation) {
    optics::Prescription lens = tessar();
    lens.stated = {};
    lens.surfaces.resize(3);
    lens.surfaces[0] = {.radius_mm = 50.0, .thickness_mm = 6.0, .semi_diameter_mm = 10.0, .medium = {.n_d = 1.5}};
    lens.surfaces[1] = {.radius_mm = -50.0, .thickness_mm = 5.0, .semi_diameter_mm = 10.0};
    lens.surfaces[2] = {.thickness_mm = 44.0, .semi_diameter_mm = 5.0, .is_stop = true};
    const CheckReport report = checked(lens);
    ASSERT_EQ(report.computed.size(), 1U);
    const double power = 0.5 * (2.0 / 50.0 - 0.5 * 6.0 / (1.5 * 2500.0));
    EXPECT_NEAR(report.computed[0].paraxial.efl, 1.0 / power, 1e-12 / power);
}

TEST(Checker, JudgesGeometryWhereNoRayCanBeTraced) {
    optics::Prescription lens = tessar();
    lens.surfaces[3].is_stop = false;
    lens.surfaces[5].thickness_mm = 2.0;
    lens.surfaces[7].radius_mm = kNaN;
    const CheckReport report = checked(lens);
    EXPECT_NE(find(report, "stop-missing"), nullptr);
    EXPECT_NE(find(report, "surfaces-cross", 6), nullptr);
    EXPECT_NE(find(report, "not-finite", 8), nullptr);
    const optics::Finding* untold = find(report, "not-judged");
    ASSERT_NE(untold, nullptr);
    EXPECT_EQ(untold->severity, optics::Severity::info);
    EXPECT_TRUE(report.computed.empty());
}

TEST(Checker, AMissingStopHidesNoFocalLength) {
    optics::Prescription lens = tessar();
    lens.surfaces[3].is_stop = false;
    const CheckReport report = checked(lens);
    ASSERT_EQ(report.computed.size(), 1U);
    EXPECT_NEAR(report.computed[0].paraxial.efl, 100.0145, 1e-3);
    EXPECT_TRUE(std::isnan(report.computed[0].paraxial.f_number));
}

TEST(Checker, ClaimsFromOutsideGoBeforeTheFilesOwn) {
    EXPECT_EQ(find(checked(tessar()), "focal-length"), nullptr);
    EXPECT_NE(find(checked(tessar(), {.efl_mm = 50.0}), "focal-length"), nullptr);
}

TEST(Checker, TheReadersRemarksComeFirst) {
    optics::Prescription lens = tessar();
    lens.remarks.push_back({.code = "not-understood", .message = "GCAT"});
    EXPECT_EQ(checked(lens).findings.front().code, "not-understood");
}

TEST(Checker, AReadersWarningSoftensNoError) {
    optics::Prescription lens = tessar();
    lens.remarks.push_back({.code = "not-understood", .surface = 6, .message = "a column"});
    lens.surfaces[5].thickness_mm = 2.0;
    const CheckReport report = checked(lens);
    ASSERT_NE(find(report, "surfaces-cross", 6), nullptr);
    EXPECT_EQ(find(report, "surfaces-cross", 6)->severity, optics::Severity::error);
}

TEST(Checker, AZoomIsJudgedAtEachPosition) {
    optics::Prescription lens = tessar();
    lens.zoom = {{.name = "near", .gaps_mm = {{6, 10.64}}, .stop_semi_diameter_mm = {}, .stated = {}},
                 {.name = "far", .gaps_mm = {{6, 2.0}}, .stop_semi_diameter_mm = {}, .stated = {}}};
    const CheckReport report = checked(lens);
    EXPECT_EQ(report.computed.size(), 2U);
    const optics::Finding* crossing = find(report, "surfaces-cross", 6);
    ASSERT_NE(crossing, nullptr);
    EXPECT_TRUE(crossing->message.starts_with("at far: ")) << crossing->message;
}

TEST(Suggestions, SwappedDigitsAndLostSignsAreFoundFirst) {
    optics::Prescription swapped = tessar();
    swapped.surfaces[5].radius_mm = 49.30;  // of 40.93: no neighbours swapped, two are across the point
    swapped.surfaces[5].radius_mm = 49.03;
    CheckReport report = checked(swapped);
    const optics::Finding* first = find(report, "suggestion");
    ASSERT_NE(first, nullptr);
    EXPECT_EQ(first->surface, 6);
    EXPECT_TRUE(says(first->message, "radius 40.93 in place of 49.03 (two digits swapped)"));
    EXPECT_LT(first->value, 0.05) << "percent of the focal length: the catalogue glasses meet the table";

    optics::Prescription unsigned_radius = tessar();
    unsigned_radius.surfaces[4].radius_mm = 59.06;
    report = checked(unsigned_radius);
    first = find(report, "suggestion");
    ASSERT_NE(first, nullptr);
    EXPECT_TRUE(says(first->message, "radius -59.06 in place of 59.06 (the sign lost)"));
    EXPECT_EQ(first->severity, optics::Severity::info) << "never a silent fix";
}

// The last thickness is a claim of its own: the lens itself is as stated, so nothing else is blamed.
TEST(Suggestions, SlipInTheLastThicknessIsNamed) {
    optics::Prescription moved = tessar();
    moved.surfaces.back().thickness_mm = 97.831;
    const CheckReport report = checked(moved);
    const optics::Finding* first = find(report, "suggestion");
    ASSERT_NE(first, nullptr) << said(report);
    EXPECT_EQ(first->surface, 8);
    EXPECT_TRUE(says(first->message, "thickness 79.831 in place of 97.831"));
    EXPECT_EQ(std::ranges::count(report.findings, "suggestion", &optics::Finding::code), 1);
}

// Tronnier's Heliar is off by 0.76 % for the rounding of its indices: its 1.85 mm of glass are not meant to be 0.07 mm.
TEST(Suggestions, NoGlassIsThoughtToBeAFoil) {
    const CheckReport report = checked(formats::read_prescription(formats::find_lens_file("heliar-tronnier")));
    EXPECT_NE(find(report, "focal-length"), nullptr);
    EXPECT_EQ(find(report, "suggestion"), nullptr) << said(report);
}

TEST(Digits, ChangesAreThoseOfTheShortestDecimalForm) {
    const auto has = [](double value, double wanted) {
        return std::ranges::any_of(plausible_changes(value),
                                   [&](const NumberChange& change) { return change.value == wanted; });
    };
    EXPECT_TRUE(has(42.97, -42.97));
    EXPECT_TRUE(has(42.97, 24.97));
    EXPECT_TRUE(has(42.97, 49.27)) << "across the point";
    EXPECT_TRUE(has(42.97, 429.7));
    EXPECT_TRUE(has(-4297.0, -42.97));
    EXPECT_TRUE(has(42.97, 42.91)) << "7 read as 1";
    EXPECT_TRUE(has(42.97, 2.97));
    EXPECT_TRUE(has(42.97, 142.97));
    EXPECT_FALSE(has(42.97, 42.97));
    EXPECT_TRUE(plausible_changes(kNaN).empty());
    EXPECT_TRUE(plausible_changes(INFINITY).empty());
}

// Found by other tracers before this one was written: the front rim of the Müller fisheye clips the chief ray
// from 74.8° on and all light from 76.9°, although 77.95° is claimed.
TEST(Checker, TheMullerFisheyesClaimedFieldIsClipped) {
    optics::Prescription lens = formats::read_prescription(formats::find_lens_file("muller-fisheye"));
    const CheckReport report = checked(lens, {.half_field_deg = 77.95});
    const optics::Finding* chief = find(report, "chief-ray");
    ASSERT_NE(chief, nullptr);
    EXPECT_EQ(chief->surface, 1);
    EXPECT_EQ(chief->severity, optics::Severity::warning);
    EXPECT_NEAR(chief->value, 74.8, 0.05);
    ASSERT_NE(find(report, "vignetting"), nullptr);
    EXPECT_EQ(find(report, "vignetting")->value, 0.0);
    EXPECT_GT(find(checked(lens, {.half_field_deg = 76.5}), "vignetting")->value, 0.0);
}

// Likewise: in Tronnier's double Gauss, as pbrt carries it, surface 3 clips the axial beam before the stop does.
TEST(Checker, SurfaceThreeLimitsTronniersAxialBeam) {
    const CheckReport report = checked(formats::read_prescription(formats::find_lens_file("double-gauss-tronnier")));
    EXPECT_NE(find(report, "stop-not-limiting", 3), nullptr);
}

// The reference's own numbers, from a 50-digit tracer. They stand beside the project, and may be missing.
TEST(Checker, TheTessarsEdgesAreThoseOfTheReference) {
    std::ifstream file(shared_data() / "optics_reference" / "tessar_brendel_100__catalog.json");
    if (!file) {
        GTEST_SKIP() << "no reference data here";
    }
    const nlohmann::json gaps = nlohmann::json::parse(file)["geometry"]["gaps"];
    const optics::Prescription lens = tessar();
    for (std::size_t i = 0; i < gaps.size(); ++i) {
        const optics::PrescribedSurface& front = lens.surfaces[i];
        const optics::PrescribedSurface& rear = lens.surfaces[i + 1];
        const double edge =
            front.thickness_mm + sag_at(rear, *rear.semi_diameter_mm) - sag_at(front, *front.semi_diameter_mm);
        EXPECT_NEAR(edge, gaps[i]["edge_thickness_own_semidiameters"].get<double>(), 1e-12);
    }
}

// Every lens that ships is free of errors.
TEST(Checker, TheLibraryHasNoErrors) {
    for (const std::string& name : formats::shipped_lens_names()) {
        for (const optics::Finding& finding :
             checked(formats::read_prescription(formats::find_lens_file(name))).findings) {
            EXPECT_NE(finding.severity, optics::Severity::error)
                << name << " surface " << finding.surface << " " << finding.code << ": " << finding.message;
        }
    }
}

// Cassegrain's telescope (Schroeder, Astronomical Optics, §2.5): its lengths run backwards between the mirrors, and
// back again behind the second. What is wrong there is what would be wrong in a lens seen from its other side.
TEST(Checker, KnowsWhereLightRunsBehindMirrors) {
    optics::Prescription lens{.name = "Cassegrain", .surfaces = {}};
    lens.surfaces = {{.radius_mm = -1000.0,
                      .conic = -1.0,
                      .thickness_mm = -350.0,
                      .semi_diameter_mm = 50.0,
                      .medium = {},
                      .is_mirror = true,
                      .is_stop = true},
                     {.radius_mm = -400.0,
                      .conic = -25.0 / 9.0,
                      .thickness_mm = 600.0,
                      .semi_diameter_mm = 20.0,
                      .medium = {},
                      .is_mirror = true}};
    lens.stated.efl_mm = 2000.0;
    lens.stated.bfl_mm = 600.0;
    lens.stated.f_number = 20.0;
    const CheckReport good = checked(lens);
    EXPECT_TRUE(good.ok()) << said(good);
    ASSERT_EQ(good.computed.size(), 1U);
    EXPECT_NEAR(good.computed[0].paraxial.efl, 2000.0, 1e-9);
    optics::Prescription forwards = lens;
    forwards.surfaces[0].thickness_mm = 350.0;
    EXPECT_NE(find(checked(forwards), "negative-thickness", 1), nullptr);
    optics::Prescription touching = lens;
    touching.surfaces[0].thickness_mm = -1e-8;
    EXPECT_EQ(find(checked(touching), "negative-thickness", 1), nullptr);
    optics::Prescription crossing = lens;
    crossing.surfaces[0].thickness_mm = -0.5;  // at 20 mm the primary stands at z = -0.2, such a secondary at 0
    crossing.surfaces[1].radius_mm = 400.0;
    EXPECT_NE(find(checked(crossing), "surfaces-cross", 1), nullptr) << said(checked(crossing));
}

}  // namespace lensproof::check::checker_test
