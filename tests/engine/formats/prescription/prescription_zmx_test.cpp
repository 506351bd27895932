// Zemax files: what they mean, against closed forms and other programs; what they do not say, by name; and back again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/text_encoding.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/optics/lens.h"
#include "tests/complaint.h"
#include "tests/engine/formats/prescription/has_finding.h"
#include "tests/engine/formats/prescription/same_rays.h"

namespace lensproof::formats::prescription_zmx_test {

constexpr double kUlp = std::numeric_limits<double>::epsilon();

const std::string kHead = "VERS 140124 258 36214\r\nMODE SEQ\r\nNAME plate\r\nUNIT MM X W X CM MR CPMM\r\nENPD 4\r\n";

std::string surf(int number, const std::string& lines) {
    return "SURF " + std::to_string(number) + "\r\n" + lines;
}

std::string coordinate_break(const std::array<double, 6>& values, double thickness) {
    std::string lines = "  TYPE COORDBRK\r\n";
    for (std::size_t i = 0; i < values.size(); ++i) {
        lines += "  PARM " + std::to_string(i + 1) + " " + std::to_string(values[i]) + "\r\n";
    }
    return lines + "  DISZ " + std::to_string(thickness) + "\r\n";
}

const std::string kObject = surf(0, "  TYPE STANDARD\r\n  DISZ INFINITY\r\n");
const std::string kStop = surf(1, "  STOP\r\n  DISZ 10\r\n  DIAM 5 1 0 0 1 \"\"\r\n");

optics::Prescription parse(const std::string& text) {
    return parse_zmx(text, "test.zmx");
}

std::string complaint(const std::string& text) {
    return complaint_about([&] { parse(text); });
}

/// The events of a ray at 587.5618 nm, the rims not clipping.
std::vector<optics::SurfaceEvent<double>> events_of(const optics::Prescription& prescription, const Ray<double>& ray) {
    std::vector<optics::SurfaceEvent<double>> events;
    const optics::TraceLens<double> lens = optics::at_wavelength<double>(optics::make_lens(prescription, {}), 587.5618);
    optics::trace<optics::Direction::forward, optics::Rims::follow>(
        lens, ray, [&](const optics::SurfaceEvent<double>& event) { events.push_back(event); });
    return events;
}

// A plate whose front normal is turned by +20° about x, by the right-hand rule, leans towards −y; a ray along the axis
// is shifted there by t sin(i − i') / cos i' (Born & Wolf 4.4) and goes on parallel. About fifteen roundings of numbers
// of size 20 mm.
TEST(Zmx, TiltedPlateShiftsTheAxialRay) {
    constexpr double kThickness = 6.0;
    constexpr double kIndex = 1.6;
    const std::string text = kHead + kObject + kStop + surf(2, coordinate_break({0, 0, 20, 0, 0, 0}, 0)) +
                             surf(3, "  CURV 0\r\n  DISZ 6\r\n  GLAS ___BLANK 1 0 1.6 0 0\r\n  DIAM 9 1\r\n") +
                             surf(4, "  CURV 0\r\n  DISZ 0\r\n  DIAM 9 1\r\n") +
                             surf(5, coordinate_break({0, 0, -20, 0, 0, 1}, 8)) + surf(6, "  DISZ 0\r\n");
    const auto events = events_of(parse(text), {{0, 0, -3}, {0, 0, 1}});
    ASSERT_EQ(events.size(), 3U);
    const double outside = radians(20.0);
    const double inside = std::asin(std::sin(outside) / kIndex);
    const double shift = kThickness * std::sin(outside - inside) / std::cos(inside);
    EXPECT_NEAR(events[2].ray.origin.y, -shift, 300 * kUlp);
    EXPECT_NEAR(events[2].ray.origin.x, 0.0, 300 * kUlp);
    EXPECT_NEAR(events[2].ray.direction.z, 1.0, 8 * kUlp);
}

const std::string kLensOne = "  CURV 0.02\r\n  DISZ 5\r\n  GLAS ___BLANK 1 0 1.5 0 0\r\n  DIAM 15 1\r\n";
const std::string kLensTwo = "  CURV 0.01\r\n  DISZ 3\r\n  GLAS ___BLANK 1 0 1.6 0 0\r\n  DIAM 15 1\r\n";

std::string twice_broken(const std::array<double, 6>& first, const std::array<double, 6>& second) {
    return kHead + kObject + kStop + surf(2, coordinate_break(first, 2)) + surf(3, kLensOne) +
           surf(4, "  CURV -0.03\r\n  DISZ 1\r\n  DIAM 15 1\r\n") + surf(5, coordinate_break(second, 6)) +
           surf(6, kLensTwo) + surf(7, "  CURV 0\r\n  DISZ 40\r\n  DIAM 15 1\r\n") + surf(8, "  DISZ 0\r\n");
}

/// The ray from (1, 2, −20) along (0.1, −0.05, 1) through a lens, to 1e-12 mm at each surface.
void expect_points(const optics::Prescription& lens, const std::vector<Vec3d>& expected) {
    const auto events = events_of(lens, {{1.0, 2.0, -20.0}, normalized(Vec3d{0.1, -0.05, 1.0})});
    ASSERT_EQ(events.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_NEAR(length(events[i].ray.origin - expected[i]), 0.0, 1e-12) << i;
    }
}

// The ray from (1, 2, −20) along (0.1, −0.05, 1) through two lenses behind two breaks, as rayoptics 0.9.8 traces it in
// global coordinates. Its reader takes tilts about x and y by the left-hand rule, against OpticStudio's help ("in a
// right hand direction"), so it was given these two with their signs turned. Decimals as printed, 16 digits of 60 mm.
TEST(Zmx, BreaksAddUpAsInRayoptics) {
    const optics::Prescription lens = parse(twice_broken({0.5, -0.3, 7, 4, 11, 0}, {-0.4, 0.2, -3, 2, 5, 0}));
    expect_points(lens, {{3.0, 1.0, 0.0},
                         {4.198235820891371, 0.4008820895543145, 11.982358208913709},
                         {4.504811215734998, 0.026935120238308574, 16.617944178415396},
                         {4.577836372828337, -0.5215534058643445, 23.73513018161006},
                         {4.662912089043725, -0.7443628775239016, 26.669193728059515}});
}

// The same with tilts about x only, which Optiland 0.6.3 takes by the right-hand rule too (its order of several tilts
// is another). It keeps the models' n_d as 1.5 and 1.6 at the d line.
TEST(Zmx, TiltsAboutOneAxisAsInOptiland) {
    const optics::Prescription lens = parse(twice_broken({0.5, -0.3, 7, 0, 0, 0}, {-0.4, 0.2, -3, 0, 0, 0}));
    expect_points(lens, {{3.0, 1.0, 0.0},
                         {4.224866887551243, 0.3875665562243784, 12.248668875512429},
                         {4.414301865587335, 0.01621719694166268, 16.839001010028138},
                         {4.43380568141283, -0.5476351568850525, 24.115145966758934},
                         {4.3914607940108885, -0.7740374976876677, 27.007866593232723}});
}

// A break with the order flag and every sign turned undoes the break without (OpticStudio's help, "Coordinate Break").
TEST(Zmx, ReversedBreakUndoesABreak) {
    const optics::Prescription lens =
        parse(kHead + kObject + kStop + surf(2, coordinate_break({0.5, -0.3, 7, 4, 11, 0}, 0)) +
              surf(3, coordinate_break({-0.5, 0.3, -7, -4, -11, 1}, 0)) + surf(4, kLensOne) +
              surf(5, "  DISZ 40\r\n  DIAM 15 1\r\n") + surf(6, "  DISZ 0\r\n"));
    ASSERT_EQ(lens.surfaces.size(), 3U);
    for (const optics::PrescribedSurface& row : lens.surfaces) {
        EXPECT_EQ(row.misalignment, optics::Misalignment{});
    }
    EXPECT_TRUE(lens.remarks.empty());
    EXPECT_NEAR(lens.surfaces[0].thickness_mm, 10.0, 8 * 10.0 * kUlp);
}

TEST(Zmx, SaysWhatTheHeadMeans) {
    const std::string text =
        "VERS 1\nMODE SEQ\nNAME A lens\nNOTE 0 Source: a book\nNOTE 0 a note\nUNIT IN X W X CM MR CPMM\n"
        "FNUM 2.8 0\nGCAT SCHOTT OHARA\nFTYP 0 0 2 2 0 0 0\nXFLN 0 0 77\nYFLN 0 14 77\n"
        "WAVM 1 0.4861327 1\nWAVM 2 0.58756180000000004 1\nWAVM 3 0.55 1\nPWAV 2\n" +
        kObject +
        surf(1,
             "  STOP\n  TYPE EVENASPH\n  CURV 0.5\n  PARM 1 0.25\n  PARM 2 2\n  CONI -1\n  DISZ 0.1\n"
             "  GLAS N-BK7 0 0 1.5 40\n  DIAM 0.3 1\n  MEMA 0.4 0\n") +
        surf(2, "  DISZ 1\n  GLAS LAK9 0 0 1.691 54.7\n") + surf(3, "  DISZ 0\n  DIAM 0.5 1\n");
    const optics::Prescription lens = parse(text);
    EXPECT_EQ(lens.name, "A lens");
    EXPECT_EQ(lens.source, "a book");
    EXPECT_EQ(lens.notes, "a note");
    EXPECT_EQ(lens.aperture, (optics::SystemAperture{optics::ApertureKind::f_number, 2.8}));
    EXPECT_EQ(lens.fields.points, (std::vector<Vec2d>{{0.0, 0.0}, {0.0, 14.0}}));
    EXPECT_DOUBLE_EQ(lens.stated.half_field_deg.value(), 14.0);
    EXPECT_DOUBLE_EQ(lens.stated.image_circle_mm.value(), 25.4);
    EXPECT_EQ(lens.preferred_makers, (std::vector<std::string>{"SCHOTT", "OHARA"}));
    EXPECT_EQ(lens.wavelengths_nm, (std::vector<double>{587.5618, 486.1327}));
    EXPECT_TRUE(std::isinf(lens.object_distance_mm));
    EXPECT_TRUE(has_finding(lens, "units", "in IN"));
    const optics::PrescribedSurface& asphere = lens.surfaces.at(0);
    EXPECT_DOUBLE_EQ(asphere.radius_mm, 2 * 25.4);
    EXPECT_DOUBLE_EQ(asphere.thickness_mm, 2.54);
    EXPECT_DOUBLE_EQ(asphere.asphere[0], 0.25 / 25.4);
    EXPECT_DOUBLE_EQ(asphere.asphere[1], 2.0 / std::pow(25.4, 3));
    EXPECT_DOUBLE_EQ(asphere.semi_diameter_mm.value(), 0.3 * 25.4);
    EXPECT_DOUBLE_EQ(asphere.rim_mm.value(), 0.4 * 25.4);
    EXPECT_EQ(asphere.medium.glass, "N-BK7");
    EXPECT_FALSE(asphere.medium.n_d) << "1.5 and 40 are what Zemax writes where it says nothing";
    EXPECT_EQ(lens.surfaces.at(1).medium.n_d, 1.691);
    EXPECT_EQ(lens.surfaces.at(1).medium.V_d, 54.7);
    EXPECT_FALSE(lens.surfaces.at(1).semi_diameter_mm);
}

// A drum lens of a catalogue: its light leaves parallel, so its image plane lies at infinity, where no sensor is.
TEST(Zmx, AnImageAtInfinityIsNoDistance) {
    const optics::Prescription lens =
        parse(kHead + kObject + kStop + surf(2, "  CURV 0.8\r\n  DISZ INFINITY\r\n") + surf(3, "  DISZ 0\r\n"));
    ASSERT_EQ(lens.surfaces.size(), 2U);
    EXPECT_EQ(lens.surfaces[1].thickness_mm, 0.0);
    EXPECT_TRUE(has_finding(lens, "image-at-infinity", "the image lies at infinity"));
}

// A Gaussian of factor 0 is an even pupil.
TEST(Zmx, AnApodizationOfNothingIsNone) {
    const std::string rest = kObject + kStop + surf(2, "  CURV 0.1\r\n  DISZ 9\r\n") + surf(3, "  DISZ 0\r\n");
    EXPECT_FALSE(has_finding(parse(kHead + "GFAC 0 0\r\n" + rest), "not-understood", "GFAC"));
    EXPECT_FALSE(has_finding(parse(kHead + "GFAC 1 0\r\n" + rest), "not-understood", "GFAC"));
    EXPECT_TRUE(has_finding(parse(kHead + "GFAC 1 1\r\n" + rest), "not-understood", "GFAC"));
}

TEST(Zmx, NamesWhatItDoesNotUnderstand) {
    const optics::Prescription lens =
        parse(kHead + "WHAT 3\r\n" + kObject +
              surf(1, "  STOP\r\n  TYPE BICONICX\r\n  DISZ 2\r\n  ZZZZ 1\r\n  ZZZZ 2\r\n  SQAP 1 1\r\n  COAT AR\r\n") +
              surf(2, "  CURV 0.1 4 1 1 0\r\n  DISZ 3\r\n  GLAS MIRROR 0 0\r\n  PZUP 1 1 0 0\r\n") +
              surf(3, coordinate_break({0, 0, 5, 0, 0, 0}, 1)) + surf(4, "  CURV 0.1\r\n  DISZ 0\r\n") +
              "EFFL 0 1\r\nTOL TOFF 0\r\nMNUM 2 1\r\nTHIC 1 1 2 0\r\nTHIC 1 2 4 0\r\nWAVE 1 1 0.5\r\nWAVE 1 2 0.6\r\n");
    EXPECT_TRUE(has_finding(lens, "not-understood", "line 6: WHAT"));
    EXPECT_TRUE(
        has_finding(lens, "not-understood", "surface 1 of the file: ZZZZ is not understood and left out (2 lines"));
    EXPECT_TRUE(has_finding(lens, "surface-type", "BICONICX"));
    EXPECT_TRUE(has_finding(lens, "aperture-shape", "SQAP"));
    EXPECT_TRUE(has_finding(lens, "coating", "AR"));
    EXPECT_TRUE(has_finding(lens, "solve", "CURV"));
    EXPECT_TRUE(has_finding(lens, "image-shape", "surface 4"));
    EXPECT_TRUE(has_finding(lens, "image-tilt", "surface 4"));
    EXPECT_TRUE(has_finding(lens, "not-read", "EFFL"));
    EXPECT_TRUE(has_finding(lens, "multi-configuration", "WAVE 1"));
    EXPECT_EQ(lens.remarks.size(), 10U) << "each once";
    ASSERT_EQ(lens.zoom.size(), 2U);
    EXPECT_EQ(lens.zoom[1].gaps_mm.at(1), 4.0);
    EXPECT_TRUE(lens.surfaces.at(1).is_mirror);
}

// Light runs back from a mirror in what it came in, and Zemax's signs with it.
TEST(Zmx, ReadsMirrors) {
    const optics::Prescription lens =
        parse(kHead + kObject + surf(1, "  STOP\r\n  CURV -0.01\r\n  DISZ 4\r\n  GLAS N-BK7 0 0 1.5 40\r\n") +
              surf(2, "  CURV -0.008\r\n  DISZ -4\r\n  GLAS MIRROR 0 0 1.5 40\r\n") +
              surf(3, "  CURV -0.01\r\n  DISZ -90\r\n") + surf(4, "  DISZ 0\r\n"));
    EXPECT_TRUE(lens.remarks.empty());
    EXPECT_TRUE(lens.surfaces.at(1).is_mirror);
    EXPECT_EQ(lens.surfaces.at(1).medium.glass, "N-BK7");
    EXPECT_EQ(lens.surfaces.at(1).radius_mm, -125.0);
    EXPECT_EQ(lens.surfaces.at(2).thickness_mm, -90.0);
}

// A flat mirror between two breaks of 45° turns the axis by 90°; behind it lengths and radii have the other sign. A
// second one turns it back, to a lens as it is written without mirrors.
TEST(Zmx, UnfoldsTheAxisAtFlatMirrors) {
    const std::string fold = "  CURV 0\r\n  DISZ 0\r\n  GLAS MIRROR 0 0\r\n  DIAM 15 0\r\n";
    const optics::Prescription folded = parse(
        kHead + kObject + kStop + surf(2, kLensOne) + surf(3, "  CURV -0.03\r\n  DISZ 30\r\n  DIAM 15 1\r\n") +
        surf(4, coordinate_break({0, 0, 45, 0, 0, 0}, 0)) + surf(5, fold) +
        surf(6, coordinate_break({0, 0, 45, 0, 0, 0}, -20)) +
        surf(7, "  CURV -0.01\r\n  DISZ -3\r\n  GLAS ___BLANK 1 0 1.6 0 0\r\n  DIAM 15 1\r\n") +
        surf(8, "  CURV 0.002\r\n  DISZ -25\r\n  DIAM 15 1\r\n") + surf(9, coordinate_break({0, 0, 0, 45, 0, 0}, 0)) +
        surf(10, fold) + surf(11, coordinate_break({0, 0, 0, 45, 0, 0}, 17)) + surf(12, "  DISZ 0\r\n"));
    const optics::Prescription straight =
        parse(kHead + kObject + kStop + surf(2, kLensOne) + surf(3, "  CURV -0.03\r\n  DISZ 50\r\n  DIAM 15 1\r\n") +
              surf(4, kLensTwo) + surf(5, "  CURV -0.002\r\n  DISZ 42\r\n  DIAM 15 1\r\n") + surf(6, "  DISZ 0\r\n"));
    EXPECT_TRUE(has_finding(folded, "fold", "SURF 5"));
    EXPECT_TRUE(has_finding(folded, "fold", "SURF 10"));
    EXPECT_FALSE(has_finding(folded, "image-tilt", ""));
    EXPECT_FALSE(folded.has_mirrors());
    EXPECT_TRUE(folded.is_rotationally_symmetric());
    const Ray<double> ray{{1.0, 2.0, -20.0}, normalized(Vec3d{0.1, -0.05, 1.0})};
    auto at_folded = events_of(folded, ray);
    const auto at_straight = events_of(straight, ray);
    ASSERT_EQ(at_folded.size(), 7U);
    at_folded.erase(at_folded.begin() + 6);
    at_folded.erase(at_folded.begin() + 3);
    for (std::size_t i = 0; i < at_straight.size(); ++i) {
        EXPECT_NEAR(length(at_folded[i].ray.origin - at_straight[i].ray.origin), 0.0, 1e-12) << i;
    }
    EXPECT_NEAR(folded.surfaces.back().thickness_mm, 17.0, 1e-12);
}

// Only a powered mirror stays one: here the axis is folded to the side, where a concave one sends light back.
TEST(Zmx, KeepsMirrorsOfPowerBehindAFold) {
    const optics::Prescription lens = parse(
        kHead + kObject + surf(1, "  STOP\r\n  DISZ 40\r\n  DIAM 5 1\r\n") +
        surf(2, coordinate_break({0, 0, 45, 0, 0, 0}, 0)) + surf(3, "  CURV 0\r\n  DISZ 0\r\n  GLAS MIRROR 0 0\r\n") +
        surf(4, coordinate_break({0, 0, 45, 0, 0, 0}, -60)) +
        surf(5, "  CURV 0.005\r\n  DISZ 50\r\n  GLAS MIRROR 0 0\r\n  DIAM 20 1\r\n") + surf(6, "  DISZ 0\r\n"));
    EXPECT_FALSE(lens.surfaces.at(1).is_mirror);
    EXPECT_NEAR(lens.surfaces.at(1).thickness_mm, 60.0, 1e-12);
    EXPECT_TRUE(lens.surfaces.at(2).is_mirror);
    EXPECT_NEAR(lens.surfaces.at(2).radius_mm, -200.0, 1e-12);
    EXPECT_NEAR(lens.surfaces.at(2).thickness_mm, -50.0, 1e-12);
}

TEST(Zmx, IsSilentOnWhatBearsOnNoRay) {
    const optics::Prescription lens =
        parse(kHead + "LUID 1\r\nEERA 0\r\nIWDP 1\r\nSTUD 0\r\n" + kObject +
              surf(1, "  STOP\r\n  SSID 5\r\n  DISZ 2\r\n  OEMA 0.5 0 0 0\r\n") + surf(2, "  DISZ 0\r\n"));
    EXPECT_TRUE(lens.remarks.empty());
    EXPECT_TRUE(lens.figures_are_spare);
}

TEST(Zmx, TakesTheFirstSurfaceForAStopThatIsNotMarked) {
    const optics::Prescription lens = parse(kHead + kObject + surf(1, "  DISZ 2\r\n  DIAM 9\r\n") +
                                            surf(2, "  DISZ 3\r\n") + surf(3, "  DISZ 0\r\n"));
    EXPECT_TRUE(lens.surfaces.at(0).is_stop);
    EXPECT_FALSE(lens.surfaces.at(0).semi_diameter_mm) << "ENPD opens it";
    EXPECT_FALSE(lens.surfaces.at(1).is_stop);
    EXPECT_TRUE(has_finding(lens, "stop", "no STOP"));
}

// The terms of the odd asphere are of r, r², …, those of the extended ones of (r / R), (r / R)², … or of their squares,
// with the number of terms and R before them (OpticStudio's help).
TEST(Zmx, ReadsOddAndExtendedAspheres) {
    const optics::Prescription lens =
        parse(kHead + kObject +
              surf(1,
                   "  STOP\r\n  TYPE ODDASPHE\r\n  CURV 0.02\r\n  PARM 1 1e-3\r\n  PARM 3 2e-5\r\n  PARM 8 -3e-9\r\n"
                   "  DISZ 2\r\n  GLAS N-BK7 0 0 1.5 40\r\n") +
              surf(2,
                   "  TYPE XOSPHERE\r\n  CURV 0.0\r\n  XDAT 1 5\r\n  XDAT 2 10\r\n  XDAT 5 0.4\r\n  XDAT 7 -0.1\r\n"
                   "  DISZ 3\r\n") +
              surf(3, "  TYPE XASPHERE\r\n  XDAT 1 2\r\n  XDAT 2 10\r\n  XDAT 4 0.4\r\n  DISZ 3\r\n") +
              surf(4, "  DISZ 0\r\n"));
    const auto& rows = lens.surfaces;
    EXPECT_EQ(rows.at(0).odd_asphere, (optics::AsphereTerms{1e-3, 2e-5}));
    EXPECT_EQ(rows.at(0).asphere, (optics::AsphereTerms{0.0, 0.0, 0.0, -3e-9}));
    EXPECT_DOUBLE_EQ(rows.at(1).term(3), 4e-4);
    EXPECT_DOUBLE_EQ(rows.at(1).term(5), -1e-6);
    EXPECT_DOUBLE_EQ(rows.at(2).term(4), 4e-5);
    EXPECT_FALSE(rows.at(2).has_odd_terms());
    EXPECT_FALSE(has_finding(lens, "surface-type", ""));
    const optics::Prescription beyond =
        parse(kHead + kObject + surf(1, "  STOP\r\n  TYPE XOSPHERE\r\n  XDAT 23 1e-9\r\n  DISZ 2\r\n") +
              surf(2, "  DISZ 0\r\n"));
    EXPECT_TRUE(has_finding(beyond, "surface-type", "a term 1e-09 r^21, which is left out: powers to r^20"));
}

TEST(Zmx, NamesTermsThatAnEvenAsphereHasNot) {
    const optics::Prescription lens =
        parse(kHead + "FTYP 4 0 1 1\r\nYFLN 20\r\n" + kObject +
              surf(1,
                   "  STOP\r\n  TYPE EVENASPH\r\n  PARM 8 0\r\n  PARM 9 1e-9\r\n  PARM 10 0\r\n"
                   "  PARM 11 2\r\n  DISZ 2\r\n") +
              surf(2, "  DISZ 0\r\n"));
    EXPECT_TRUE(has_finding(lens, "surface-type", "PARM 9 = 1e-09, PARM 11 = 2 of the EVENASPH"));
    EXPECT_TRUE(has_finding(lens, "fields", "theodolite"));
    EXPECT_FALSE(has_finding(lens, "fields", "mm"));
    EXPECT_THROW(optics::make_lens(lens, {}), InputError);
}

TEST(Zmx, HostileFilesAreRefusedByLine) {
    const auto lens = [](const std::string& lines) {
        return kHead + kObject + surf(1, lines) + surf(2, "  DISZ 0\r\n");
    };
    EXPECT_TRUE(says(complaint(""), "test.zmx"));
    EXPECT_NE(complaint(std::string(1000, '\0')), "");
    EXPECT_NE(complaint("\x7f"
                        "ELF\x02\x01\x01"),
              "");
    EXPECT_NE(complaint(kHead + kObject), "") << "no lens";
    EXPECT_TRUE(says(complaint("MODE NSC\n"), "test.zmx:1: MODE is \"NSC\""));
    EXPECT_TRUE(says(complaint("UNIT FURLONG\n"), ":1: UNIT"));
    EXPECT_TRUE(says(complaint(kHead + "SURF 10000000000\r\n"), "test.zmx:6: SURF 10000000000"));
    EXPECT_TRUE(says(complaint(lens(" CURV x\r\n")), "test.zmx:10: SURF 1: CURV is \"x\""));
    EXPECT_TRUE(says(complaint(lens(" DISZ\r\n")), "DISZ is \"\""));
    EXPECT_TRUE(
        says(complaint(lens(" GLAS ___BLANK 1 0 1.5 6O\r\n")), "test.zmx:10: SURF 1: GLAS is \"6O\", expected"));
    EXPECT_TRUE(says(complaint(lens(" GLAS N-BK7 0 0 1,6 60\r\n")), "GLAS is \"1,6\""));
    EXPECT_EQ(complaint(lens("  DIAM 5 1 0 0 1 \"\"\r\n  GLAS N-BK7\r\n")), "");
    EXPECT_TRUE(says(complaint(lens(" PARM 1e9 1\r\n")), "PARM"));
    EXPECT_TRUE(says(complaint(lens("") + "MNUM 10000000000 1\r\n"), "MNUM"));
    EXPECT_NE(complaint(kHead + kObject + surf(1, coordinate_break({}, INFINITY)) + surf(2, "  DISZ 1\r\n") +
                        surf(3, "  DISZ 0\r\n")),
              "");
    EXPECT_EQ(complaint(lens("  CURV nan\r\n  DISZ -inf\r\n")), "") << "for the checker to say";
    std::string many = kHead;
    for (int i = 0; i <= 2000; ++i) {
        many += surf(i, "  DISZ 1\r\n");
    }
    EXPECT_TRUE(says(complaint(many), "a lens of 1999 surfaces, expected up to 1000"));
    for (int i = 2001; i <= 3010; ++i) {
        many += surf(i, "  DISZ 1\r\n");
    }
    EXPECT_TRUE(says(complaint(many), "SURF 3002"));
    std::string unknown = kHead + kObject;
    for (int i = 0; i < 5000; ++i) {
        unknown += "  K" + std::to_string(i) + " 1\r\n";
    }
    EXPECT_EQ(parse(unknown + kStop + surf(2, "")).remarks.size(), 101U);
}

TEST(Zmx, EveryEncodingIsTheSameLens) {
    const std::string text = kHead + "NOTE 0 5 \xC2\xB5m\r\n" + kObject + kStop + surf(2, "  DISZ 0\r\n");
    EXPECT_EQ(parse(text).notes, "5 \xC2\xB5m");
    EXPECT_EQ(parse(to_utf16(text)).notes, "5 \xC2\xB5m");
    EXPECT_EQ(parse(to_utf16(text).substr(2)).surfaces.size(), 1U);
    EXPECT_TRUE(to_zmx(parse(text)).text.starts_with("\xFF\xFE"));
}

/// Written and read again.
optics::Prescription again(const optics::Prescription& prescription) {
    return parse_zmx(to_zmx(prescription).text, prescription.file);
}

optics::Prescription tessar() {
    return read_prescription(find_lens_file("tessar"));
}

TEST(Zmx, TessarComesBack) {
    const optics::Prescription lens = tessar();
    const optics::Prescription back = again(lens);
    expect_same_rays(lens, back);
    EXPECT_TRUE(back.remarks.empty());
    EXPECT_EQ(back.name, lens.name);
    EXPECT_EQ(back.source, lens.source);
    EXPECT_EQ(back.notes, lens.notes);
    EXPECT_EQ(back.aperture, optics::SystemAperture{}) << "the stop's size governs";
    EXPECT_EQ(back.stated.half_field_deg, lens.stated.half_field_deg);
    const std::vector<optics::Finding> lost = to_zmx(lens).lost;
    ASSERT_EQ(lost.size(), 1U);
    EXPECT_EQ(lost[0].severity, optics::Severity::info);
}

// The stop's DIAM is what Zemax drew; an aperture of its own, or a user's DIAM on a surface of power, cuts beams.
TEST(Zmx, ApertureGovernsTheStop) {
    using optics::ApertureKind;
    const auto lens = [](const std::string& aperture, const std::string& stop) {
        return parse("MODE SEQ\nUNIT MM\n" + aperture + kObject + surf(1, "  STOP\n" + stop + "  DISZ 0\n") +
                     surf(2, "  CURV 0.02\n  DISZ 2\n  GLAS ___BLANK 1 0 1.5 60\n  DIAM 9 0\n") +
                     surf(3, "  DISZ 99\n  DIAM 9 0\n") + surf(4, "  DISZ 0\n"));
    };
    const auto opening = [](const optics::Prescription& prescription) {
        return optics::make_lens(prescription, {}).surfaces[0].semi_diameter;
    };
    // f = 100 mm by 1/((n − 1) c); the stop stands in front, so it is the entrance pupil.
    EXPECT_NEAR(opening(lens("ENPD 12\n", "  DIAM 7.9 0\n")), 6.0, 1e-12);
    EXPECT_NEAR(opening(lens("FNUM 10 0\n", "  DIAM 7.9 0\n")), 5.0, 1e-12);
    EXPECT_NEAR(opening(lens("FLOA\n", "  DIAM 7.9 0\n")), 7.9, 1e-12);
    EXPECT_NEAR(opening(lens("ENPD 12\n", "  DIAM 7.9 0\n  FLAP 0 4 0\n")), 4.0, 1e-12);
    EXPECT_NEAR(opening(lens("ENPD 12\n", "  DIAM 4 1\n")), 6.0, 1e-12) << "a plane without power";
    EXPECT_NEAR(opening(lens("ENPD 12\n", "  DIAM 4 1\n  MEMA 4.5 0\n")), 6.0, 1e-12) << "what MEMA follows is gone";
    EXPECT_NEAR(opening(lens("ENPD 12\n", "  CURV 0.001\n  DIAM 4 1\n")), 4.0, 1e-12);
}

TEST(Zmx, ApertureAndFieldsComeBack) {
    optics::Prescription lens = tessar();
    lens.aperture = {optics::ApertureKind::working_f_number, 4.5};
    lens.fields = {.kind = optics::FieldKind::image_height,
                   .points = {{0.0, 0.0}, {3.0, 10.5}},
                   .vignetting = {{}, {.decentre = {0.0, 0.1}, .compression = {0.05, 0.2}}}};
    const optics::Prescription back = again(lens);
    EXPECT_EQ(back.aperture, lens.aperture);
    EXPECT_EQ(back.fields, lens.fields);
}

TEST(Zmx, EveryShapeComesBack) {
    optics::Prescription lens = tessar();
    lens.surfaces[0].conic = -0.3;
    lens.surfaces[0].asphere = {1e-5, 2e-7, -3e-10, 1e-13};
    lens.surfaces[2].asphere[9] = 1e-26;
    lens.surfaces[4].radius_x_mm = -70.0;
    lens.surfaces[4].asphere[1] = 1e-7;
    lens.surfaces[5].radius_x_mm = kInfinity;
    lens.surfaces[6].medium = {.n_d = 1.7, .V_d = 50.0};
    lens.surfaces[7].rim_mm = 18.0;
    lens.object_distance_mm = 2000.0;
    lens.wavelengths_nm = {546.074, 480.0};
    const optics::Prescription back = again(lens);
    expect_same_rays(lens, back);
    EXPECT_TRUE(back.remarks.empty());
    EXPECT_EQ(back.surfaces[7].rim_mm, 18.0);
    EXPECT_EQ(back.object_distance_mm, 2000.0);
    EXPECT_EQ(back.wavelengths_nm, lens.wavelengths_nm);
}

TEST(Zmx, TiltedSurfacesAndGroupsComeBack) {
    optics::Prescription lens = tessar();
    lens.surfaces[7].misalignment = {.decentre_mm = {0.2, -0.1}, .tilt_deg = {1.0, -0.5, 30.0}};
    lens.groups.push_back({.first = 5, .last = 6, .misalignment = {{0.3, 0.4}, {-2.0, 1.0, 10.0}}, .pivot_mm = 5.0});
    const optics::Prescription back = again(lens);
    expect_same_rays(lens, back);
    EXPECT_TRUE(back.remarks.empty());
}

TEST(Zmx, ZoomPositionsComeBack) {
    optics::Prescription lens = tessar();
    lens.surfaces[2].misalignment.tilt_deg = {1.0, 0.0, 0.0};
    lens.zoom = {{.name = "near", .gaps_mm = {{3, 5.0}, {8, 79.0}}}, {.name = "far", .gaps_mm = {{8, 82.0}}}};
    const optics::Prescription back = again(lens);
    ASSERT_EQ(back.zoom.size(), 2U);
    for (std::size_t position = 0; position < 2; ++position) {
        expect_same_rays(optics::at_zoom_position(lens, position), optics::at_zoom_position(back, position));
    }
}

TEST(Zmx, SaysWhatItCannotWrite) {
    optics::Prescription lens = tessar();
    lens.projection = optics::Projection::equidistant;
    lens.stop_shape = optics::PolygonStop{};
    lens.coatings["AR"] = std::vector<optics::WavelengthValue>{{550.0, 0.01}};
    lens.surfaces[1].coating = "AR";
    lens.surfaces[2].barrel_mm = 20.0;
    lens.surfaces[4].medium = {.indices = {{400.0, 1.66}, {700.0, 1.63}}};
    lens.surfaces[4].radius_x_mm = 50.0;
    lens.surfaces[4].asphere[8] = 1e-26;
    lens.focus_groups.push_back({.first = 1, .last = 8});
    std::string said;
    for (const optics::Finding& finding : to_zmx(lens).lost) {
        EXPECT_TRUE(finding.code.starts_with("lost-")) << finding.code;
        said += std::to_string(finding.surface) + " " + finding.message + "\n";
    }
    for (const char* words : {"0 a .zmx file cannot say the projection", "stop that is no circle",
                              "2 a .zmx file cannot say what the coating AR", "barrel",
                              "5 a .zmx file cannot say a table of indices", "beyond y^14", "focus"}) {
        EXPECT_TRUE(says(said, words));
    }
}

// Whatever lens can be entered can be written and read back: an object, an image, and two breaks around each surface
// come on top of a thousand.
TEST(Zmx, ALensOfEverySizeIsReadBack) {
    optics::Prescription lens;
    lens.name = "many";
    lens.surfaces.resize(kMostSurfaces, {.radius_mm = 1e4, .thickness_mm = 0.5, .semi_diameter_mm = 3.0});
    lens.surfaces.front().is_stop = true;
    for (const double tilt_deg : {0.0, 1e-3}) {
        for (optics::PrescribedSurface& row : lens.surfaces) {
            row.misalignment.tilt_deg[0] = tilt_deg;
        }
        EXPECT_EQ(parse_zmx(to_zmx(lens).text, "many.zmx").surfaces.size(), lens.surfaces.size());
    }
}

}  // namespace lensproof::formats::prescription_zmx_test
