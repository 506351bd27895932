// Lenses as rayoptics saves them: what its objects become.
#include <gtest/gtest.h>

#include "engine/base/infinity.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/optics/thin_element.h"
#include "tests/complaint.h"
#include "tests/engine/formats/prescription/has_finding.h"

namespace lensproof::formats::rayoptics_test {

std::string object(const std::string& type, const std::string& attributes) {
    return R"({"__instance_type__": ["module", ")" + type + R"("], "attributes": {)" + attributes + "}}";
}

const std::string kAir = object("Air", "");

std::string gap(const std::string& thickness, const std::string& medium = kAir) {
    return object("Gap", "\"thi\": " + thickness + ", \"medium\": " + medium);
}

/// With its profile inside, as older files have it.
std::string surface(const std::string& profile, const std::string& mode = "transmit", const std::string& more = "") {
    return object("Surface", R"("interact_mode": ")" + mode +
                                 R"(", "decenter": null, "max_aperture": 1.0, "profile": )" + profile + more);
}

std::string sphere(const std::string& curvature) {
    return object("Spherical", "\"cv\": " + curvature);
}

const std::string kPlane = surface(sphere("0.0"), "dummy");

struct Model {
    std::string unit = "mm";
    std::string interfaces;  // between the object's and the image's
    std::string gaps;
    std::string stop = "1";
    std::string pupil = R"("_key": ["aperture", "object", "epd"], "value": 4.0)";
    std::string view = R"("key": ["field", "object", "angle"], "value": 10.0, "is_relative": false, "fields": [])";
    std::string profiles;

    [[nodiscard]] std::string text() const {
        const auto of = [](const std::string& attributes) { return object("X", attributes); };
        return "{\"optical_model\": " +
               of(R"("system_spec": )" + of(R"("title": "A lens", "_dimensions": ")" + unit + '"') +
                  ", \"profile_dict\": {" + profiles + "}, \"seq_model\": " +
                  of("\"ifcs\": [" + kPlane + ", " + interfaces + ", " + kPlane + "], \"gaps\": [" + gaps +
                     "], \"stop_surface\": " + stop) +
                  ", \"optical_spec\": " +
                  of("\"pupil\": " + of(pupil) + ", \"field_of_view\": " + of(view) +
                     ", \"spectral_region\": " + of(R"("wavelengths": [486.1327, 587.5618], "reference_wvl": 1)"))) +
               "}";
    }
    [[nodiscard]] optics::Prescription read() const { return parse_rayoptics(text(), "lens.roa"); }
};

TEST(Rayoptics, ALensIsWhatItsObjectsSay) {
    Model model;
    model.profiles = R"("17": )" + object("EvenPolynomial", R"("cv": -0.02, "cc": -1.0, "coef4": 1e-5, "coef6": 2e-8)");
    model.interfaces = surface(object("Conic", R"("cv": 0.05, "cc": -0.5)"), "transmit",
                               R"(, "clear_apertures": [)" +
                                   object("Circular", R"("radius": 6.5, "x_offset": 0.0, "y_offset": 0.0)") + "]") +
                       ", " +
                       object("Surface", R"("interact_mode": "transmit", "max_aperture": 5.25, "profile_id": "17")");
    model.gaps = gap("10000000000.0") + ", " + gap("3.0", object("SchottGlass", R"("gname": "N-BK7", "coefs": [])")) +
                 ", " + gap("47.5");
    model.view = R"("key": ["field", "image", "height"], "value": 20.0, "is_relative": true, "fields": [)" +
                 object("Field", R"("x": 0.0, "y": 0.5, "vux": 0.1, "vuy": 0.2, "vlx": 0.3, "vly": 0.6)") + "]";
    const optics::Prescription lens = model.read();
    EXPECT_EQ(lens.name, "A lens");
    EXPECT_TRUE(lens.remarks.empty());
    ASSERT_EQ(lens.surfaces.size(), 2u);
    const optics::PrescribedSurface& front = lens.surfaces[0];
    EXPECT_TRUE(front.is_stop);
    EXPECT_DOUBLE_EQ(front.radius_mm, 20.0);
    EXPECT_EQ(front.conic, -0.5);
    EXPECT_EQ(front.semi_diameter_mm, 6.5);
    EXPECT_EQ(front.medium.glass, "SCHOTT N-BK7");
    const optics::PrescribedSurface& rear = lens.surfaces[1];
    EXPECT_DOUBLE_EQ(rear.radius_mm, -50.0);
    EXPECT_EQ(rear.conic, -1.0);
    EXPECT_EQ(rear.term(4), 1e-5);
    EXPECT_EQ(rear.term(6), 2e-8);
    EXPECT_EQ(rear.semi_diameter_mm, 5.25);
    EXPECT_TRUE(rear.medium.is_air());
    EXPECT_EQ(rear.thickness_mm, 47.5);
    EXPECT_EQ(lens.object_distance_mm, kInfinity);
    EXPECT_EQ(lens.aperture, (optics::SystemAperture{optics::ApertureKind::entrance_pupil_diameter, 4.0}));
    EXPECT_EQ(lens.wavelengths_nm, (std::vector{587.5618, 486.1327}));
    EXPECT_EQ(lens.fields.kind, optics::FieldKind::paraxial_image_height);
    EXPECT_EQ(lens.fields.points, (std::vector{Vec2d{0.0, 10.0}}));
    ASSERT_EQ(lens.fields.vignetting.size(), 1u);
    EXPECT_NEAR(lens.fields.vignetting[0].decentre.x, 0.1, 1e-15);
    EXPECT_NEAR(lens.fields.vignetting[0].compression.y, 0.4, 1e-15);
}

// Newer versions have a list, with the names of old beside it, all 0; some counted powers from 0 on.
TEST(Rayoptics, AspheresTermsStandInAList) {
    Model model;
    const auto term = [&](const std::string& profile, int power) {
        model.interfaces = surface(profile);
        model.gaps = gap("1e10") + ", " + gap("2.0");
        return model.read().surfaces.at(0).term(power);
    };
    const std::string named = R"(, "coef1": 0.0, "coef2": 0.0, "coef4": 0.0)";
    EXPECT_EQ(term(object("EvenPolynomial", R"("cv": 0.1, "cc": 0.0, "coefs": [0.0, 0.25])" + named), 4), 0.25);
    EXPECT_EQ(term(object("RadialPolynomial", R"("cv": 0.1, "ec": 1.0, "coefs": [0.0, 0.0, 0.5])" + named), 3), 0.5);
    const std::string eleven = "[0, 0, 0, 0.5, 0, 0, 0, 0, 0, 0, 0]";
    EXPECT_EQ(term(object("RadialPolynomial", R"("cv": 0.1, "ec": 1.0, "coefs": )" + eleven), 3), 0.5);
    EXPECT_EQ(term(object("EvenPolynomial", R"("cv": 0.1, "cc": 0.0, "coefs": [0, 0], "coef4": 0.75)"), 4), 0.75);
}

// Radial polynomials count powers from 1, and their conic is 1 + k; a lens in inches has all of its lengths in them.
TEST(Rayoptics, LengthsAreInItsUnit) {
    constexpr double kInch = 25.4;
    Model model;
    model.unit = "inches";
    model.interfaces = surface(object("RadialPolynomial", R"("cv": 0.5, "ec": 0.25, "coef3": 0.01, "coef4": 0.02)"));
    model.gaps = gap("10.0") + ", " + gap("2.0", object("ModelGlass", R"("n": 1.6, "v": 50.0)"));
    const optics::Prescription lens = model.read();
    ASSERT_EQ(lens.surfaces.size(), 1u);
    const optics::PrescribedSurface& only = lens.surfaces[0];
    EXPECT_DOUBLE_EQ(only.radius_mm, 2.0 * kInch);
    EXPECT_EQ(only.conic, -0.75);
    EXPECT_DOUBLE_EQ(only.term(3), 0.01 / (kInch * kInch));
    EXPECT_DOUBLE_EQ(only.term(4), 0.02 / (kInch * kInch * kInch));
    EXPECT_DOUBLE_EQ(only.thickness_mm, 2.0 * kInch);
    EXPECT_DOUBLE_EQ(lens.object_distance_mm, 10.0 * kInch);
    EXPECT_DOUBLE_EQ(lens.aperture.value, 4.0 * kInch);
    EXPECT_EQ(only.medium.n_d, 1.6);
    EXPECT_EQ(only.medium.V_d, 50.0);
    EXPECT_FALSE(only.semi_diameter_mm) << "1 is what nobody set";
}

TEST(Rayoptics, MirrorsThinLensesAndKinoformsAreKnown) {
    Model model;
    model.stop = "null";
    model.pupil = R"("key": ["image", "f/#"], "value": 5.0)";
    model.interfaces =
        object("ThinLens", R"("interact_mode": "transmit", "max_aperture": 3.0, "_power": 0.02)") + ", " +
        surface(sphere("-0.005"), "reflect") + ", " +
        surface(sphere("0.0"), "transmit",
                ", \"phase_element\": " + object("DiffractiveElement",
                                                 R"("coefficients": [-0.001, 3e-9], "ref_wl": 550.0, "order": 2,
                                             "phase_fct_name": "radial_phase_fct")"));
    model.gaps = gap("1e19") + ", " + gap("50.0") + ", " + gap("-20.0") + ", " + gap("-30.0");
    const optics::Prescription lens = model.read();
    ASSERT_EQ(lens.surfaces.size(), 3u);
    EXPECT_EQ(lens.surfaces[0].ideal_focal_length_mm, 50.0);
    EXPECT_EQ(lens.surfaces[0].semi_diameter_mm, std::nullopt) << "the aperture opens the stop";
    EXPECT_TRUE(lens.surfaces[0].is_stop);
    EXPECT_TRUE(has_finding(lens, "stop-not-stated", "floating stop"));
    EXPECT_TRUE(lens.surfaces[1].is_mirror);
    EXPECT_EQ(lens.surfaces[1].thickness_mm, -20.0);
    ASSERT_TRUE(lens.surfaces[2].phase);
    EXPECT_EQ(lens.surfaces[2].phase->order, 2.0);
    EXPECT_EQ(lens.surfaces[2].phase->radial[0], -0.001);
    EXPECT_EQ(lens.surfaces[2].phase->radial[1], 3e-9);
    EXPECT_EQ(lens.surfaces[2].phase->design_wavelength_nm, 550.0);
    EXPECT_EQ(lens.aperture, (optics::SystemAperture{optics::ApertureKind::working_f_number, 5.0}));
}

TEST(Rayoptics, WhatItCannotFollowIsNamed) {
    Model model;
    model.interfaces = surface(object("XToroid", R"("cv": 0.1)"));
    model.gaps = gap("1e10") + ", " + gap("2.0", object("Mist", R"("label": "fog")"));
    const optics::Prescription lens = model.read();
    EXPECT_TRUE(has_finding(lens, "shape-not-read", "XToroid"));
    EXPECT_TRUE(has_finding(lens, "material-not-read", "Mist"));

    const auto complaint_of = [](Model wrong) { return complaint_about([&] { static_cast<void>(wrong.read()); }); };
    Model furlongs = model;
    furlongs.unit = "furlongs";
    EXPECT_TRUE(says(complaint_of(furlongs), "its lengths are in \"furlongs\", expected mm, cm, m or inches"));
    Model short_of_gaps = model;
    short_of_gaps.gaps = gap("1e10");
    EXPECT_TRUE(says(complaint_of(short_of_gaps), "lens.roa: 3 interfaces and 1 gaps, expected"));
    EXPECT_TRUE(says(complaint_about([] { parse_rayoptics("{}", "lens.roa"); }), "lens.roa: optical_model"));
    EXPECT_FALSE(complaint_about([] { parse_rayoptics("no JSON", "lens.roa"); }).empty());
}

}  // namespace lensproof::formats::rayoptics_test
