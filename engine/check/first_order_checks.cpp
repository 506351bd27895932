// First-order data against what is claimed of the lens.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/infinity.h"
#include "engine/check/checks.h"
#include "engine/check/digits.h"
#include "engine/check/rays.h"
#include "engine/check/sag.h"

namespace lensproof::check {

namespace {

struct Limits {
    double error;
    double warning;
};
// Rules 19 and 20. The warnings lie above what 95 % of good tables show: of the lenses that ship with a stated focal
// length one departs by more than 0.4 %; of 49 products' patents two depart in back focus by more than 0.13 % of the
// focal length and have no cover glass to explain it. At f/2.8, 0.2 % of defocus blurs by 1/1400 of the focal length,
// the customary circle of confusion.
constexpr Limits kFocalLength{.error = 0.01, .warning = 0.005};
constexpr Limits kBackFocus{.error = 0.01, .warning = 1.5e-3};  // of the focal length
// A plate before the sensor sets the image back by (1 − 1/n) t. Sensors have from 0.5 to 4 mm of cover glass and
// filters (n of N-BK7), which many a patent counts in the last distance and leaves out of the table.
constexpr double kCoverGlassIndex = 1.5168;
constexpr double kThinnestCoverGlass = 0.5;  // mm
constexpr double kThickestCoverGlass = 4.2;
constexpr double kSameFocalLength = 1e-3;  // the lens itself is as stated
constexpr double kSameDistance = 5e-4;     // of the focal length: a slip that explains a distance meets it so well
constexpr Limits kFNumber{.error = 0.10, .warning = 0.05};  // rule 22
constexpr double kLeastClearAperture = 0.6;                 // of the beam that is stated; below it is another lens's
constexpr Limits kTrack{.error = 1e9, .warning = 0.005};    // rule 30
constexpr double kPetzvalWarning = 1.0;                     // focal lengths, rule 31
constexpr double kInvariantError = 1e-12;                   // relative, rule 32
constexpr double kNoPower = 1e6;                            // focal lengths longer than this many lens lengths are none

double lens_length(const CheckedLens& checked) {
    double length = 0.0;
    for (int i = 0; i + 1 < checked.size(); ++i) {
        length += checked.headings[i] * checked.row(i).thickness_mm;
    }
    return length;
}

/// Rules 21 and 29.
void check_power(const CheckedLens& checked, Findings& findings) {
    const Focus& focus = *checked.focus;
    if (!std::isfinite(focus.efl) || std::abs(focus.efl) > kNoPower * std::max(1.0, lens_length(checked))) {
        findings.push_back({"no-power", error, 0, "the lens has no power: it images nothing", focus.efl, 0.0, "mm"});
        return;
    }
    if (checked.collimates()) {
        findings.push_back({"collimated", info, checked.size(),
                            "light of the object leaves the lens parallel: where the table ends is no image's place",
                            focus.image_distance, kNaN, "mm"});
    } else if (checked.has_virtual_image()) {
        findings.push_back({"virtual-image", info, checked.size(),
                            fmt::format("a diverging lens (focal length {:.4f} mm): its image is virtual, {:.4f} mm in "
                                        "front of the last surface, {} the table puts the image plane",
                                        focus.efl, std::abs(focus.image_distance),
                                        checked.is_at_best_focus ? "near which, at a best focus," : "where"),
                            focus.image_distance, kNaN, "mm"});
    } else if (focus.efl < 0.0) {
        findings.push_back(
            {"negative-power", error, 0,
             fmt::format("the focal length is {:.4f} mm: a diverging lens, which images nothing on a sensor",
                         focus.efl),
             focus.efl, 0.0, "mm"});
    } else if (checked.headings.back() * focus.image_distance <= 0.0) {
        findings.push_back(
            {"image-in-front", warning, checked.size(),
             fmt::format("the image lies {:.3f} mm in front of the last surface, where no sensor can stand",
                         std::abs(focus.image_distance)),
             focus.image_distance, 0.0, "mm"});
    }
}

/// A measured length against a stated one; `scale` is what the limits are fractions of.
struct Comparison {
    double computed;
    double stated;
    double scale;
};

void compare(Findings& findings, const char* code, std::string_view what, const Comparison& c, const Limits& limits,
             int surface = 0) {
    const double off = std::abs(c.computed - c.stated) / std::abs(c.scale);
    if (off > limits.warning) {
        findings.push_back({code, off > limits.error ? error : warning, surface,
                            fmt::format("{} is {:.6g} by the table, {:.6g} as stated: off by {:.3g} %", what,
                                        c.computed, c.stated, 100.0 * off),
                            100.0 * off, 100.0 * (off > limits.error ? limits.error : limits.warning), "%"});
    }
}

/// A cover glass that would explain a back focus.
struct CoverGlass {
    double thickness_mm = 0.0;
    bool is_likeliest = false;  // the lens is as stated, and no slip in the distance explains as much
};

/// Nothing where no sensor's has such a thickness, or where the lens is another than is stated.
std::optional<CoverGlass> explaining_cover_glass(const CheckedLens& checked, const Comparison& back_focus) {
    const double thickness = (back_focus.stated - back_focus.computed) / (1.0 - 1.0 / kCoverGlassIndex);
    const std::optional<double>& efl = checked.claims.efl_mm;
    const double off = efl ? std::abs(checked.focus->efl / *efl - 1.0) : 0.0;
    if (!(thickness >= kThinnestCoverGlass && thickness <= kThickestCoverGlass && off < kFocalLength.warning)) {
        return std::nullopt;
    }
    const auto explains = [&](const NumberChange& change) {
        return std::abs(change.value - back_focus.computed) < kSameDistance * std::abs(back_focus.scale);
    };
    const bool is_slip = std::ranges::any_of(plausible_changes(back_focus.stated), explains);
    return CoverGlass{thickness, !is_slip && off < kSameFocalLength};
}

/// Rule 20. A cover glass is information where the focal length is stated and met, else a guess that still warns; so it
/// is where something else is as likely.
void check_back_focus(const CheckedLens& checked, std::string_view what, const Comparison& back_focus, int surface,
                      Findings& findings) {
    const std::size_t count = findings.size();
    compare(findings, "back-focus", what, back_focus, kBackFocus, surface);
    if (const std::optional<CoverGlass> glass = explaining_cover_glass(checked, back_focus);
        glass && findings.size() > count) {
        optics::Finding& finding = findings.back();
        if (glass->is_likeliest) {
            finding.severity = checked.claims.efl_mm ? info : std::min(finding.severity, warning);
        }
        finding.message += fmt::format("; a cover glass of {:.1f} mm would explain it{}", glass->thickness_mm,
                                       glass->is_likeliest ? "" : ", and so would a slip in a number");
    }
}

/// Rules 19 and 20. The last thickness is a claim too: where the sensor stands.
void check_focal_lengths(const CheckedLens& checked, Findings& findings) {
    const Focus& focus = *checked.focus;
    const optics::StatedData& claims = checked.claims;
    if (claims.efl_mm) {
        compare(findings, "focal-length", "the focal length (mm)", {focus.efl, *claims.efl_mm, *claims.efl_mm},
                kFocalLength);
    }
    const double heading = checked.headings.back();
    const double scale = claims.efl_mm.value_or(focus.efl);
    if (claims.bfl_mm) {
        check_back_focus(checked, "the back focus (mm)", {heading * focus.bfl, *claims.bfl_mm, scale}, 0, findings);
    }
    const double last = checked.stated_image_distance();
    const bool repeats = claims.bfl_mm && std::abs(*claims.bfl_mm - last) < 1e-9;
    if (last > 0.0 && !repeats && !checked.collimates()) {
        const std::size_t count = findings.size();
        check_back_focus(checked, "the image's distance from the last surface (mm, last thickness)",
                         {heading * focus.image_distance, last, scale}, checked.size(), findings);
        if (findings.size() > count && findings.back().code == "back-focus" && checked.is_at_best_focus) {
            findings.back().severity = info;
            findings.back().message += "; real rays of the axial beam are sharpest there: a best focus";
        }
    }
}

/// Rule 30.
void check_track(const CheckedLens& checked, Findings& findings) {
    const double last = checked.stated_image_distance();
    if (const std::optional<double>& track = checked.claims.total_track_mm; track && last > 0.0) {
        compare(findings, "total-track", "the length from first vertex to sensor (mm)",
                {lens_length(checked) + last, *track, *track}, kTrack);
    }
}

/// Rule 31: 1/R = −Σ (n' − n) c / (n n') (Welford, Aberrations of Optical Systems, §8.2 with S4 = H² Σ …).
void check_petzval(const CheckedLens& checked, Findings& findings) {
    double sum = 0.0;
    for (int i = 0; i < checked.size(); ++i) {
        const double n1 = checked.index_before(i);
        const double n2 = checked.table.index[i];
        sum -= checked.table.curvature[i] * (n2 - n1) / (n1 * n2);
    }
    const double radius = 1.0 / sum;
    const double relative = std::abs(radius / checked.focus->efl);
    if (relative < kPetzvalWarning) {
        findings.push_back({"petzval-radius", warning, 0,
                            fmt::format("the Petzval radius is {:.4g} mm, {:.2f} focal lengths: the field is curved "
                                        "more strongly than a single element's",
                                        radius, relative),
                            radius, kPetzvalWarning * checked.focus->efl, "mm"});
    }
}

/// Whether the stop is a surface of an element whose other surface is as wide: stock lenses are stated with the beam
/// that would fill their glass, and with its clear aperture as the rims of both surfaces. A slip is in one of them.
bool is_clear_aperture(const CheckedLens& checked, int stop) {
    constexpr double kAlike = 1e-3;
    const auto is_as_wide = [&](int other) {
        return !checked.is_estimated[other] &&
               std::abs(checked.semi_diameters[other] / checked.semi_diameters[stop] - 1.0) < kAlike;
    };
    return (stop + 1 < checked.size() && checked.is_glass_behind(stop) && is_as_wide(stop + 1)) ||
           (stop > 0 && checked.is_glass_behind(stop - 1) && is_as_wide(stop - 1));
}

/// Rule 22, and the entrance pupil where a design program states that.
void check_aperture(const CheckedLens& checked, Findings& findings) {
    const optics::ParaxialData& data = *checked.paraxial;
    if (!std::isfinite(data.f_number) || checked.assumed_stop) {
        return;
    }
    const int stop = checked.lens->stop_index();
    if (checked.is_estimated[stop]) {
        return;
    }
    const auto stated_as = [&](optics::ApertureKind kind, const std::optional<double>& claim) {
        const optics::SystemAperture& aperture = checked.prescription.aperture;
        return aperture.kind == kind ? std::optional(aperture.value) : claim;
    };
    if (const auto f_number = stated_as(optics::ApertureKind::f_number, checked.claims.f_number)) {
        compare(findings, "f-number", "the f-number", {data.f_number, *f_number, *f_number}, kFNumber, stop + 1);
    }
    if (const auto diameter =
            stated_as(optics::ApertureKind::entrance_pupil_diameter, checked.claims.entrance_pupil_diameter_mm)) {
        const std::size_t count = findings.size();
        compare(findings, "entrance-pupil", "the entrance pupil's diameter (mm)",
                {data.entrance_pupil_diameter, *diameter, *diameter}, kFNumber, stop + 1);
        const double fraction = data.entrance_pupil_diameter / *diameter;
        if (findings.size() > count && fraction < 1.0 && fraction > kLeastClearAperture &&
            is_clear_aperture(checked, stop)) {
            findings.back().severity = info;
            findings.back().message += "; it is the element's clear aperture, which both of its surfaces have";
        }
    }
}

/// Rule 32: n (u ȳ − ū y) of two paraxial rays is the same in every space. A test of the checker's own arithmetic.
void check_invariant(const CheckedLens& checked, Findings& findings) {
    const optics::TraceLens<double> lens = paraxial_lens(checked.table);
    optics::ParaxialRay one{1.0, 0.0};
    optics::ParaxialRay other{0.0, 0.1};
    double expected = kNaN;
    for (int i = 0; i < checked.size(); ++i) {
        one = optics::trace_paraxial(lens, one, i, i);
        other = optics::trace_paraxial(lens, other, i, i);
        const double n = checked.table.index[i];
        const double first = n * one.height * other.slope;
        const double second = n * other.height * one.slope;
        const double invariant = first - second;
        if (i == 0) {
            expected = invariant;
        }
        const double scale = std::abs(first) + std::abs(second) + std::abs(expected);
        if (!(std::abs(invariant - expected) <= kInvariantError * scale)) {
            findings.push_back(
                {"lagrange-invariant", error, i + 1,
                 "the Lagrange invariant changes here: the table's numbers are too extreme to compute with",
                 std::abs(invariant - expected) / scale, kInvariantError});
            return;
        }
        const double gap = checked.row(i).thickness_mm;
        one.height += gap * one.slope;
        other.height += gap * other.slope;
    }
}

/// A sensor that the rim of the last element has passed.
void check_sensor_place(const CheckedLens& checked, Findings& findings) {
    const int last = checked.size() - 1;
    const double heading = checked.headings.back();
    const double distance = heading * checked.row(last).thickness_mm;
    const double rim = heading * sag_at(checked.row(last), checked.semi_diameters[last]);
    if (distance > 0.0 && rim > distance) {
        findings.push_back(
            {"sensor-inside-lens", checked.is_estimated[last] ? warning : error, last + 1,
             fmt::format("the last surface's rim reaches {:.3f} mm behind its vertex, the sensor stands at {:.3f} mm",
                         rim, distance),
             distance - rim, 0.0, "mm"});
    }
}

}  // namespace

void check_first_order(const CheckedLens& checked, Findings& findings) {
    if (!checked.focus) {
        return;
    }
    check_power(checked, findings);
    check_focal_lengths(checked, findings);
    check_track(checked, findings);
    check_invariant(checked, findings);
    check_petzval(checked, findings);
    check_sensor_place(checked, findings);
    if (checked.paraxial) {
        check_aperture(checked, findings);
    }
}

}  // namespace lensproof::check
