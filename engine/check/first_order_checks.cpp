// First-order data against what is claimed of the lens.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/check/checks.h"
#include "engine/check/sag.h"

namespace lensproof::check {

namespace {

// Rules 19 and 20: what rounding of radii and indices explains in published tables is below the warnings.
constexpr double kFocalLengthError = 0.01;
constexpr double kFocalLengthWarning = 0.003;
constexpr double kBackFocusError = 0.01;  // of the focal length
constexpr double kBackFocusWarning = 5e-4;
constexpr double kFNumberError = 0.10;  // rule 22
constexpr double kFNumberWarning = 0.05;
constexpr double kTrackWarning = 0.005;    // rule 30
constexpr double kPetzvalWarning = 1.0;    // focal lengths, rule 31
constexpr double kInvariantError = 1e-12;  // relative, rule 32
constexpr double kNoPower = 1e6;           // focal lengths longer than this many lens lengths are none

double lens_length(const CheckedLens& checked) {
    double length = 0.0;
    for (int i = 0; i + 1 < checked.size(); ++i) {
        length += checked.row(i).thickness_mm;
    }
    return length;
}

/// Rules 21 and 29.
void check_power(const CheckedLens& checked, Findings& findings) {
    const Focus& focus = *checked.focus;
    if (!std::isfinite(focus.efl) || std::abs(focus.efl) > kNoPower * std::max(1.0, lens_length(checked))) {
        findings.push_back({.code = "no-power",
                            .severity = optics::Severity::error,
                            .message = "the lens has no power: it images nothing",
                            .value = focus.efl,
                            .limit = 0.0,
                            .unit = "mm"});
        return;
    }
    if (focus.efl < 0.0) {
        findings.push_back({.code = "negative-power",
                            .severity = optics::Severity::error,
                            .message = fmt::format("the focal length is {:.4f} mm: a diverging lens, which images "
                                                   "nothing on a sensor",
                                                   focus.efl),
                            .value = focus.efl,
                            .limit = 0.0,
                            .unit = "mm"});
    } else if (focus.image_distance <= 0.0) {
        findings.push_back({.code = "image-in-front",
                            .severity = optics::Severity::warning,
                            .surface = checked.size(),
                            .message = fmt::format("the image lies {:.3f} mm in front of the last surface, where no "
                                                   "sensor can stand",
                                                   -focus.image_distance),
                            .value = focus.image_distance,
                            .limit = 0.0,
                            .unit = "mm"});
    }
}

/// A measured length against a stated one; `scale` is what the limits are fractions of.
struct Comparison {
    const char* code;
    std::string what;
    double computed;
    double stated;
    double scale;
    double error;
    double warning;
    int surface = 0;
};

void compare(const Comparison& c, Findings& findings) {
    const double off = std::abs(c.computed - c.stated) / std::abs(c.scale);
    if (!(off > c.warning)) {
        return;
    }
    findings.push_back({.code = c.code,
                        .severity = off > c.error ? optics::Severity::error : optics::Severity::warning,
                        .surface = c.surface,
                        .message = fmt::format("{} is {:.6g} by the table, {:.6g} as stated: off by {:.3g} %", c.what,
                                               c.computed, c.stated, 100.0 * off),
                        .value = 100.0 * off,
                        .limit = 100.0 * (off > c.error ? c.error : c.warning),
                        .unit = "%"});
}

/// Rules 19 and 20. The last thickness is a claim too: where the sensor stands.
void check_focal_lengths(const CheckedLens& checked, Findings& findings) {
    const Focus& focus = *checked.focus;
    const optics::StatedData& claims = checked.claims;
    if (claims.efl_mm) {
        compare({.code = "focal-length",
                 .what = "the focal length (mm)",
                 .computed = focus.efl,
                 .stated = *claims.efl_mm,
                 .scale = *claims.efl_mm,
                 .error = kFocalLengthError,
                 .warning = kFocalLengthWarning},
                findings);
    }
    const double scale = claims.efl_mm.value_or(focus.efl);
    if (claims.bfl_mm) {
        compare({.code = "back-focus",
                 .what = "the back focus (mm)",
                 .computed = focus.bfl,
                 .stated = *claims.bfl_mm,
                 .scale = scale,
                 .error = kBackFocusError,
                 .warning = kBackFocusWarning},
                findings);
    }
    const double last = checked.row(checked.size() - 1).thickness_mm;
    const bool repeats = claims.bfl_mm && std::abs(*claims.bfl_mm - last) < 1e-9;
    if (last > 0.0 && !repeats) {
        compare({.code = "back-focus",
                 .what = "the image's distance from the last surface (mm, last thickness)",
                 .computed = focus.image_distance,
                 .stated = last,
                 .scale = scale,
                 .error = kBackFocusError,
                 .warning = kBackFocusWarning,
                 .surface = checked.size()},
                findings);
    }
}

/// Rule 30.
void check_track(const CheckedLens& checked, Findings& findings) {
    const double last = checked.row(checked.size() - 1).thickness_mm;
    if (checked.claims.total_track_mm && last > 0.0) {
        compare({.code = "total-track",
                 .what = "the length from first vertex to sensor (mm)",
                 .computed = lens_length(checked) + last,
                 .stated = *checked.claims.total_track_mm,
                 .scale = *checked.claims.total_track_mm,
                 .error = 1e9,
                 .warning = kTrackWarning},
                findings);
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
        findings.push_back({.code = "petzval-radius",
                            .severity = optics::Severity::warning,
                            .message = fmt::format("the Petzval radius is {:.4g} mm, {:.2f} focal lengths: the field "
                                                   "is curved more strongly than a single element's",
                                                   radius, relative),
                            .value = radius,
                            .limit = kPetzvalWarning * checked.focus->efl,
                            .unit = "mm"});
    }
}

/// Rule 22, and the entrance pupil where a design program states that.
void check_aperture(const CheckedLens& checked, Findings& findings) {
    const optics::ParaxialData& data = *checked.paraxial;
    if (!std::isfinite(data.f_number) || checked.assumed_stop) {
        return;
    }
    const bool stop_is_stated = !checked.is_estimated[checked.lens->stop_index()];
    if (checked.claims.f_number && stop_is_stated) {
        compare({.code = "f-number",
                 .what = "the f-number",
                 .computed = data.f_number,
                 .stated = *checked.claims.f_number,
                 .scale = *checked.claims.f_number,
                 .error = kFNumberError,
                 .warning = kFNumberWarning,
                 .surface = checked.lens->stop_index() + 1},
                findings);
    }
    if (checked.claims.entrance_pupil_diameter_mm && stop_is_stated) {
        compare({.code = "entrance-pupil",
                 .what = "the entrance pupil's diameter (mm)",
                 .computed = data.entrance_pupil_diameter,
                 .stated = *checked.claims.entrance_pupil_diameter_mm,
                 .scale = *checked.claims.entrance_pupil_diameter_mm,
                 .error = kFNumberError,
                 .warning = kFNumberWarning,
                 .surface = checked.lens->stop_index() + 1},
                findings);
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
            findings.push_back({.code = "lagrange-invariant",
                                .severity = optics::Severity::error,
                                .surface = i + 1,
                                .message = "the Lagrange invariant changes here: the table's numbers are too extreme "
                                           "to compute with",
                                .value = std::abs(invariant - expected) / scale,
                                .limit = kInvariantError});
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
    const double distance = checked.row(last).thickness_mm;
    const double rim = sag_at(checked.row(last), checked.semi_diameters[last]);
    if (distance > 0.0 && rim > distance) {
        findings.push_back(
            {.code = "sensor-inside-lens",
             .severity = checked.is_estimated[last] ? optics::Severity::warning : optics::Severity::error,
             .surface = last + 1,
             .message = fmt::format("the last surface's rim reaches {:.3f} mm behind its vertex, the "
                                    "sensor stands at {:.3f} mm",
                                    rim, distance),
             .value = distance - rim,
             .limit = 0.0,
             .unit = "mm"});
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
