#include "experiments/draw/lens_section.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <string>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/base/markup.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/optics/meridional_bundle.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/draw/label_row.h"
#include "experiments/draw/section_rays.h"
#include "experiments/draw/svg.h"
#include "tests/experiments/draw/svg_checks.h"

namespace lensproof::draw::lens_section_test {

optics::Prescription shipped(const std::string& name) {
    return formats::read_prescription(formats::find_lens_file(name));
}

std::string drawn(const optics::Prescription& prescription, const std::vector<optics::Finding>& findings = {}) {
    const optics::Lens lens = optics::make_lens(prescription, formats::shipped_glasses());
    return lens_section_svg(prescription, &lens, findings);
}

TEST(Svg, NumbersAreShortAndAlwaysFinite) {
    EXPECT_EQ(svg_number(1.0), "1");
    EXPECT_EQ(svg_number(0.126), "0.13");
    EXPECT_EQ(svg_number(-0.001), "0");
    EXPECT_EQ(svg_number(120.0), "120");
    EXPECT_EQ(svg_number(1e300), "10000000");
    EXPECT_EQ(svg_number(kNaN), "0");
    EXPECT_EQ(svg_number(-kInfinity), "0");
}

TEST(Svg, TextFromAFileStaysText) {
    EXPECT_EQ(escape_markup("<script>\"a\" & 'b'"), "&lt;script&gt;&quot;a&quot; &amp; &#39;b&#39;");
    EXPECT_EQ(escape_markup("Müller – 9°"), "Müller – 9°");
    EXPECT_EQ(escape_markup(std::string_view("a\0b\x1b"
                                             "c\x7f",
                                             6)),
              "a\uFFFD"
              "b\uFFFD"
              "c\uFFFD");
    // A lone continuation byte, a truncated sequence, an overlong '/', a surrogate, a right-to-left override, U+FFFF.
    for (const char* bad : {"\x80", "\xC3", "\xC0\xAF", "\xED\xA0\x80", "\u202E", "\uFFFF"}) {
        EXPECT_EQ(escape_markup(bad).substr(0, 3), "\uFFFD") << bad;
        EXPECT_EQ(escape_markup(bad).find(bad), std::string::npos);
    }
}

TEST(Svg, TextIsCutBetweenCharacters) {
    EXPECT_EQ(shortened("Müller", 6), "Müller");
    EXPECT_EQ(shortened("Müller", 3), "Mü…");
    EXPECT_EQ(wrapped("one two three four", 9, 2), (std::vector<std::string>{"one two", "three fo…"}));
    EXPECT_EQ(wrapped("unbreakable", 4, 3), (std::vector<std::string>{"unbr", "eaka", "ble"}));
    EXPECT_EQ(wrapped("", 4, 3), (std::vector<std::string>{""}));
}

TEST(LabelRow, LabelsStandWhereTheyWishUnlessInOneAnothersWay) {
    EXPECT_EQ(spread_labels({{50.0, 10.0}, {20.0, 10.0}}, 0.0, 100.0), (std::vector<double>{50.0, 20.0}));
    // Two at the same place: side by side about it. At the edge: pushed inwards.
    EXPECT_EQ(spread_labels({{50.0, 10.0}, {50.0, 10.0}}, 0.0, 100.0), (std::vector<double>{45.0, 55.0}));
    EXPECT_EQ(spread_labels({{99.0, 10.0}, {99.0, 10.0}}, 0.0, 100.0), (std::vector<double>{85.0, 95.0}));
    // Too many for the row: they share it evenly.
    EXPECT_EQ(spread_labels({{0.0, 100.0}, {0.0, 100.0}}, 0.0, 100.0), (std::vector<double>{25.0, 75.0}));
}

// The outermost rays that pass are followed by one that does not: a thousandth of a millimetre farther out, a rim or
// the stop ends it. On axis the bundle of a centred lens is symmetric.
TEST(MeridionalBundle, ReachesFromRimToRim) {
    const optics::Lens lens = formats::load_lens("tessar");
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, spectral::kLineD);
    const optics::ChiefRays chiefs(lens, spectral::kLineD);
    for (const double field : {0.0, 10.0, 20.0}) {
        const optics::MeridionalBundle bundle = optics::meridional_bundle(traced, *chiefs.at_field(field * kDegree));
        for (const double end : {bundle.lower, bundle.upper}) {
            EXPECT_EQ(optics::trace(traced, bundle.ray({0.0, end})).status, optics::RayStatus::ok);
            EXPECT_NE(optics::trace(traced, bundle.ray({0.0, end + std::copysign(1e-3, end)})).status,
                      optics::RayStatus::ok);
        }
    }
    const optics::MeridionalBundle axial = optics::meridional_bundle(traced, *chiefs.at_field(0.0));
    EXPECT_NEAR(axial.upper, -axial.lower, 1e-9);
    // It is the stop that bounds it: the outermost ray grazes its edge, 15 mm from the axis.
    double height_at_stop = 0.0;
    optics::trace(traced, axial.ray({0.0, axial.upper}), [&](const optics::SurfaceEvent<double>& event) {
        height_at_stop = event.surface == lens.stop_index() ? event.ray.origin.y : height_at_stop;
    });
    EXPECT_NEAR(height_at_stop, 15.0, 1e-9);
}

TEST(MeridionalBundle, ANearObjectsRaysLeaveOnePoint) {
    const optics::Lens lens = formats::load_lens("tessar");
    const optics::ChiefRays chiefs(lens, spectral::kLineD);
    const double distance = 500.0;
    const optics::MeridionalBundle bundle = optics::meridional_bundle(
        optics::at_wavelength<double>(lens, spectral::kLineD), *chiefs.at_field(10.0 * kDegree), distance);
    const auto object_height = [&](double offset) {
        return optics::meet_plane(bundle.ray({0.0, offset}), -distance).point.y;
    };
    EXPECT_LT(bundle.lower, -5.0);
    EXPECT_NEAR(object_height(bundle.lower), object_height(bundle.upper), 1e-9);
    EXPECT_LT(object_height(0.0), -80.0);  // −(500 + entrance pupil) tan 10°
}

TEST(LensSection, RaysEndOnTheSensorAndBundlesComeToAFocus) {
    for (const std::string name : {"tessar", "petzval", "muller-fisheye"}) {
        const optics::Prescription prescription = shipped(name);
        const optics::Lens lens = optics::make_lens(prescription, formats::shipped_glasses());
        const SectionRays rays = section_rays(prescription, lens, 10.0, 5);
        ASSERT_EQ(rays.bundles.size(), 3U) << name;
        for (const SectionBundle& bundle : rays.bundles) {
            ASSERT_EQ(bundle.rays.size(), 5U) << name;
            for (const SectionRay& ray : bundle.rays) {
                EXPECT_TRUE(ray.passes);
                EXPECT_NEAR(ray.points.back().z, lens.image_z, 1e-12);
                // One point in front, one a surface, one on the sensor.
                EXPECT_EQ(ray.points.size(), lens.surfaces.size() + 2);
            }
        }
        EXPECT_NEAR(rays.bundles[1].field_angle / rays.bundles[2].field_angle, 0.7, 1e-9) << name;
    }
}

// The front rim of the Müller fisheye clips the chief ray from 74.8° (its notes), 77.95° is claimed: the drawing keeps
// to what passes, and says so.
TEST(LensSection, AFieldBeyondTheRimsIsNotDrawn) {
    const optics::Prescription prescription = shipped("muller-fisheye");
    const SectionRays rays =
        section_rays(prescription, optics::make_lens(prescription, formats::shipped_glasses()), 5.0, 3);
    EXPECT_NEAR(rays.bundles.back().field_angle / kDegree, 74.8, 0.1);
    EXPECT_NE(rays.remark.find("77.95"), std::string::npos);
    EXPECT_NE(drawn(prescription).find("77.95° is stated"), std::string::npos);
}

TEST(LensSection, ShowsEveryElementTheStopAndThreeBundles) {
    for (const auto& [name, elements] : {std::pair{"tessar", 4U}, {"petzval", 4U}, {"muller-fisheye", 6U}}) {
        const std::string svg = drawn(shipped(name));
        EXPECT_TRUE(is_well_formed(svg));
        EXPECT_FALSE(has_bad_number(svg));
        EXPECT_EQ(count(svg, "class=\"glass\""), elements) << name;
        EXPECT_EQ(count(svg, "class=\"stop\""), 2U);
        EXPECT_EQ(count(svg, "class=\"sensor\""), 1U);
        EXPECT_EQ(count(svg, "class=\"ray\"") + count(svg, "class=\"ray chief\""), 15U);
        EXPECT_EQ(count(svg, "class=\"marked"), 0U);
    }
}

// Nine of them on a narrow page: the legend has a line and an angle for each, in more rows than one, and none ends
// beyond the page.
TEST(LensSection, EachOfManyFieldsHasALineOfItsOwnAndItsAngleInTheLegend) {
    const optics::Prescription prescription = shipped("tessar");
    const optics::Lens lens = optics::make_lens(prescription, formats::shipped_glasses());
    const LensSectionOptions options{.width_px = 500.0, .fields_deg = {0, 3, 6, 9, 12, 15, 18, 21, 24.25}};
    const std::string svg = lens_section_svg(prescription, &lens, {}, options);
    std::set<std::string> lines;
    std::set<double> heights;
    for (std::size_t at = svg.find("class=\"field\""); at != std::string::npos;
         at = svg.find("class=\"field\"", at + 1)) {
        const std::size_t begin = svg.rfind('<', at);
        const std::string element = svg.substr(begin, svg.find('>', begin) - begin);
        const auto value = [&](const std::string& key) {
            const std::size_t from = element.find(" " + key + "=\"");
            return from == std::string::npos
                       ? ""
                       : element.substr(from + key.size() + 3,
                                        element.find('"', from + key.size() + 3) - from - key.size() - 3);
        };
        lines.insert(value("stroke") + " " + value("stroke-dasharray"));
        double x1 = 0.0;
        double y1 = 0.0;
        double x2 = 0.0;
        ASSERT_EQ(std::sscanf(value("d").c_str(), "M%lf %lf %lf", &x1, &y1, &x2), 3) << element;
        heights.insert(y1);
        EXPECT_LT(x2, options.width_px) << element;
    }
    EXPECT_EQ(lines.size(), 9U);
    EXPECT_GT(heights.size(), 1U);
    EXPECT_NE(svg.find(">24.25°</text>"), std::string::npos);
}

TEST(LensSection, IsTheSameBytesEveryTime) {
    EXPECT_EQ(drawn(shipped("tessar")), drawn(shipped("tessar")));
}

TEST(LensSection, MarksTheSurfacesOfErrorsAndWarnings) {
    const std::vector<optics::Finding> findings = {
        {.code = "air-gap", .severity = optics::Severity::warning, .surface = 3, .message = "narrow"},
        {.code = "edge-thickness", .severity = optics::Severity::error, .surface = 3, .message = "negative"},
        {.code = "efl", .severity = optics::Severity::error, .surface = 0, .message = "3 % off"},
        {.code = "glass", .severity = optics::Severity::warning, .surface = 7, .message = "inferred"},
        {.code = "rounded", .severity = optics::Severity::info, .surface = 1, .message = "indices"},
        {.code = "nowhere", .severity = optics::Severity::error, .surface = 99, .message = "no such surface"},
        {.code = "seventh", .severity = optics::Severity::info, .surface = 0, .message = "not written out"}};
    const std::string svg = drawn(shipped("tessar"), findings);
    EXPECT_TRUE(is_well_formed(svg));
    EXPECT_EQ(count(svg, "class=\"marked"), 2U);
    EXPECT_EQ(count(svg, "class=\"marked error surface-3\""), 1U);
    EXPECT_EQ(count(svg, "class=\"marked warning surface-7\""), 1U);
    EXPECT_NE(svg.find(">edge-thickness +1</text>"), std::string::npos);
    EXPECT_LT(svg.find("surface 3 · edge-thickness: negative"), svg.find("surface 3 · air-gap: narrow"));
    EXPECT_NE(svg.find("and 1 more"), std::string::npos);
}

TEST(LensSection, ATableThatCannotBeTracedIsDrawnWithoutRays) {
    optics::Prescription prescription = shipped("tessar");
    prescription.surfaces[4].radius_mm = kNaN;
    prescription.surfaces[5].thickness_mm = -3.0;
    prescription.surfaces[6].semi_diameter_mm = kNaN;
    prescription.surfaces[1].conic = kInfinity;
    const std::string svg = lens_section_svg(prescription, nullptr, {{.code = "radius", .surface = 5}});
    EXPECT_TRUE(is_well_formed(svg));
    EXPECT_FALSE(has_bad_number(svg));
    EXPECT_EQ(count(svg, "class=\"glass\""), 4U);
    EXPECT_EQ(count(svg, "class=\"ray"), 0U);
    EXPECT_EQ(count(svg, "class=\"marked warning surface-5\""), 1U);
    EXPECT_NE(svg.find("cannot be traced"), std::string::npos);
}

TEST(LensSection, HostileNamesStayText) {
    optics::Prescription prescription = shipped("tessar");
    const std::string hostile = "</text><script>alert('\"')</script>&\x01\xff\u202E]]>";
    prescription.name = hostile + std::string(100000, '<');
    prescription.surfaces[0].medium.glass = hostile;
    const std::vector<optics::Finding> findings = {
        {.code = hostile, .surface = 2, .message = hostile + std::string(50000, '&')}};
    const std::string svg = lens_section_svg(prescription, nullptr, findings);
    EXPECT_TRUE(is_well_formed(svg));
    EXPECT_EQ(svg.find("<script"), std::string::npos);
    EXPECT_EQ(count(svg, "<svg"), 1U);
}

// Whatever stands in a table: every key of every surface replaced by every kind of absurd number, traceable or not.
TEST(LensSection, AbsurdTablesAreDrawnAllTheSame) {
    for (const double absurd : {kNaN, kInfinity, -kInfinity, 0.0, -1.0, 1e-300, 1e-3, 1e6, 1e300}) {
        for (int key = 0; key < 8; ++key) {
            optics::Prescription prescription = shipped("tessar");
            for (const std::size_t i : {1U, 3U, 7U}) {
                optics::PrescribedSurface& row = prescription.surfaces[i];
                switch (key) {
                    case 0:
                        row.radius_mm = absurd;
                        break;
                    case 1:
                        row.thickness_mm = absurd;
                        break;
                    case 2:
                        row.semi_diameter_mm = absurd;
                        break;
                    case 3:
                        row.conic = absurd;
                        break;
                    case 4:
                        row.asphere[3] = absurd;
                        break;
                    case 5:
                        row.misalignment.decentre_mm[1] = absurd;
                        break;
                    case 6:
                        row.misalignment.tilt_deg[0] = absurd;
                        break;
                    default:
                        row.rim_mm = row.barrel_mm = absurd;
                        break;
                }
            }
            prescription.stated.image_circle_mm = absurd;
            prescription.stated.half_field_deg = absurd;
            prescription.object_distance_mm = absurd;
            std::optional<optics::Lens> lens;
            try {
                lens = optics::make_lens(prescription, formats::shipped_glasses());
            } catch (const std::exception&) {
            }
            const std::string svg = lens_section_svg(prescription, lens ? &*lens : nullptr, {});
            EXPECT_TRUE(is_well_formed(svg)) << "key " << key << ", " << absurd;
            EXPECT_FALSE(has_bad_number(svg)) << "key " << key << ", " << absurd;
        }
    }
}

TEST(LensSection, EmptyAndVeryLongTablesAreDrawn) {
    EXPECT_TRUE(is_well_formed(lens_section_svg({}, nullptr, {})));
    optics::Prescription prescription = shipped("tessar");
    const std::vector<optics::PrescribedSurface> once = prescription.surfaces;
    for (int i = 0; i < 120; ++i) {
        prescription.surfaces.insert(prescription.surfaces.end(), once.begin(), once.end());
    }
    std::vector<optics::Finding> findings;
    for (int i = 1; i <= static_cast<int>(prescription.surfaces.size()); ++i) {
        findings.push_back(
            {.code = "stop-doubled", .severity = optics::Severity::error, .surface = i, .message = "again"});
    }
    const std::string svg = lens_section_svg(prescription, nullptr, findings);
    EXPECT_TRUE(is_well_formed(svg));
    EXPECT_LT(svg.size(), 5'000'000U);
}

}  // namespace lensproof::draw::lens_section_test
