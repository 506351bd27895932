// Row by row: what each number may be, whatever the others are.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/check/checks.h"
#include "engine/check/sag.h"

namespace lensproof::check {

namespace {

// Rule 3: a radius so many focal lengths long is how some files write a flat (lentil's 99999 and 100000).
constexpr double kFlatRadiusInFocalLengths = 1e5;
constexpr double kFlatRadius = 99999.0;  // mm, where there is no focal length
// Beyond these the tracer refuses, or a number is no longer one of optics; the bounds are this project's.
constexpr double kSmallestRadius = 1e-3;  // mm
constexpr double kLargestLength = 1e7;    // mm
constexpr double kLargestConic = 1e4;
constexpr double kUsualLength = 1e4;  // mm: beyond 10 m, glass or aperture is a slip of the decimal point

void add(Findings& findings, const char* code, optics::Severity severity, int surface, std::string message,
         double value = kNaN, double limit = kNaN, const char* unit = "") {
    findings.push_back({code, severity, surface, std::move(message), value, limit, unit});
}

/// Rule 2: no NaN anywhere, no infinite thickness, aperture or index; an infinite radius is a flat.
void check_finite(const optics::PrescribedSurface& row, int surface, Findings& findings) {
    const auto complain = [&](const char* what, double value) {
        add(findings, "not-finite", error, surface, fmt::format("the {} is {}, no number", what, value), value);
    };
    if (std::isnan(row.radius_mm)) {
        complain("radius", row.radius_mm);
    }
    if (row.radius_x_mm && std::isnan(*row.radius_x_mm)) {
        complain("radius across", *row.radius_x_mm);
    }
    if (!std::isfinite(row.thickness_mm)) {
        complain("thickness behind it", row.thickness_mm);
    }
    if (!std::isfinite(row.conic)) {
        complain("conic constant", row.conic);
    }
    for (int power = 1; power <= optics::kHighestPower; ++power) {
        if (!std::isfinite(row.term(power))) {
            complain("aspheric coefficient", row.term(power));
        }
    }
    for (const auto& [what, length] : {std::pair{"semi-diameter", row.semi_diameter_mm},
                                       {"rim's semi-diameter", row.rim_mm},
                                       {"barrel's radius", row.barrel_mm}}) {
        if (length && !std::isfinite(*length)) {
            complain(what, *length);
        }
    }
    if (row.medium.n_d && !std::isfinite(*row.medium.n_d)) {
        complain("index behind it", *row.medium.n_d);
    }
    if (row.medium.V_d && !std::isfinite(*row.medium.V_d)) {
        complain("Abbe number behind it", *row.medium.V_d);
    }
}

/// Rule 3: spellings of a flat other than "inf" and nothing at all.
void check_flat_spelling(const CheckedLens& checked, int i, Findings& findings) {
    const optics::PrescribedSurface& row = checked.row(i);
    const double flat_from = checked.focus && std::isfinite(checked.focus->efl)
                                 ? std::min(kFlatRadiusInFocalLengths * std::abs(checked.focus->efl), kFlatRadius)
                                 : kFlatRadius;
    if (row.radius_mm == 0.0 && !row.is_stop) {
        add(findings, "flat-radius", info, i + 1, "a radius of 0 is taken for flat", 0.0);
    } else if (std::isfinite(row.radius_mm) && std::abs(row.radius_mm) >= flat_from) {
        add(findings, "flat-radius", info, i + 1,
            fmt::format("a radius of {} mm is as good as flat; written so to mean it?", row.radius_mm), row.radius_mm,
            flat_from, "mm");
    }
}

/// Numbers that are finite and yet no lens's.
void check_extremes(const optics::PrescribedSurface& row, int surface, Findings& findings) {
    const auto judge = [&](const char* what, double length) {
        if (std::isfinite(length) && length > kUsualLength) {
            const bool is_beyond = length > kLargestLength;
            add(findings, "extreme-value", is_beyond ? error : warning, surface,
                fmt::format("the {} is {} mm: more than {}", what, length,
                            is_beyond ? "10 km, the most that is taken" : "10 m"),
                length, is_beyond ? kLargestLength : kUsualLength, "mm");
        }
    };
    if (!row.is_flat() && std::isfinite(row.radius_mm) && std::abs(row.radius_mm) < kSmallestRadius) {
        add(findings, "extreme-value", error, surface,
            fmt::format("a radius of {} mm is smaller than a micrometre", row.radius_mm), row.radius_mm,
            kSmallestRadius, "mm");
    }
    judge("thickness behind it", row.thickness_mm);
    judge("semi-diameter", row.semi_diameter_mm.value_or(0.0));
    if (std::isfinite(row.conic) && std::abs(row.conic) > kLargestConic) {
        add(findings, "extreme-value", warning, surface,
            fmt::format("a conic constant of {} is beyond any that is ground", row.conic), row.conic, kLargestConic);
    }
    if (std::isfinite(row.term(1)) && row.term(1) != 0.0) {
        add(findings, "pointed-surface", warning, surface,
            fmt::format("its A1 of {} makes it a cone at the vertex: focal length and the like leave that out",
                        row.term(1)),
            row.term(1), 0.0);
    }
}

/// Rule 5: light only runs forwards, and back behind each mirror; surfaces without a gap are cemented or a dummy.
void check_thickness_sign(const CheckedLens& checked, int i, Findings& findings) {
    const double thickness = checked.headings[i] * checked.row(i).thickness_mm;
    const bool is_last = i + 1 == checked.size();
    if (thickness < -optics::kGapRounding && is_last && checked.has_virtual_image()) {
        return;
    }
    if (thickness < -optics::kGapRounding) {
        add(findings, "negative-thickness", error, i + 1,
            is_last ? fmt::format("the sensor stands {} mm in front of the last surface", -thickness)
                    : fmt::format("the next surface stands {} mm in front of this one", -thickness),
            thickness, 0.0, "mm");
        return;
    }
    if (thickness > optics::kGapRounding) {
        return;
    }
    if (is_last) {
        add(findings, "no-image-distance", info, i + 1,
            "the last thickness is 0: the table does not say where the sensor stands", 0.0, 0.0, "mm");
    } else if (checked.is_dummy(i) || checked.is_dummy(i + 1)) {
        return;  // a plane that says a place within a medium takes no room
    } else if (checked.is_glass_behind(i)) {
        add(findings, "zero-thickness", error, i + 1, "the glass behind it has no thickness", 0.0, 0.0, "mm");
    } else if (checked.row(i).curvature() != checked.row(i + 1).curvature()) {
        // Two of 49 products' patents list vertices that touch, of surfaces that part from there.
        const double reach = std::min(checked.semi_diameters[i], checked.semi_diameters[i + 1]);
        const bool parts = separation_at(checked.row(i), checked.row(i + 1), reach) > 0.0;
        add(findings, "zero-thickness", parts ? info : warning, i + 1,
            "it touches the next surface, though neither is a dummy and they are not curved alike", 0.0, 0.0, "mm");
    }
}

/// Rule 6: a sphere ends at its equator. A semi-diameter must be a length at all.
void check_semi_diameter(const CheckedLens& checked, int i, Findings& findings) {
    const optics::PrescribedSurface& row = checked.row(i);
    if (!row.semi_diameter_mm && !row.rim_mm) {
        const bool is_free_stop =
            row.is_stop && checked.prescription.governing_aperture().kind == optics::ApertureKind::stop;
        add(findings, "semi-diameter-missing", is_free_stop ? warning : info, i + 1,
            is_free_stop ? "neither an aperture nor the stop's size is stated: what the other surfaces let pass of an "
                           "axial beam sets it"
                         : "no semi-diameter is stated: marginal and chief ray set it");
        return;
    }
    const double semi_diameter = checked.semi_diameters[i];
    if (semi_diameter <= 0.0) {
        add(findings, "semi-diameter-not-positive", error, i + 1,
            fmt::format("a semi-diameter of {} mm lets no light pass", semi_diameter), semi_diameter, 0.0, "mm");
        return;
    }
    // Of a conic: z is real up to (1 + k) c² r² = 1.
    const double equator = 1.0 / (std::abs(row.curvature()) * std::sqrt(std::max(0.0, 1.0 + row.conic)));
    constexpr double kAtEquator = 1e-9;  // a ball's rim is its equator
    if (semi_diameter > (1.0 + kAtEquator) * equator) {
        add(findings, "semi-diameter-beyond-sphere", error, i + 1,
            fmt::format("its semi-diameter of {} mm is not below its radius of {:.6g} mm: such a surface does not "
                        "exist. A diameter in place of a semi-diameter?",
                        semi_diameter, equator),
            semi_diameter, equator, "mm");
    }
}

/// Rule 4: exactly one stop, between the surfaces.
void check_stop(const CheckedLens& checked, Findings& findings) {
    std::vector<int> stops;
    for (int i = 0; i < checked.size(); ++i) {
        if (checked.row(i).is_stop) {
            stops.push_back(i + 1);
        }
    }
    const std::string assumed =
        checked.assumed_stop
            ? fmt::format("; rays are judged as though surface {} were it, the narrowest", *checked.assumed_stop + 1)
            : "";
    if (stops.empty()) {
        add(findings, "stop-missing", error, 0, "no surface is marked as the aperture stop" + assumed, 0, 1);
    } else if (stops.size() > 1) {
        add(findings, "stop-doubled", error, stops[1],
            fmt::format("surface {} is marked as the aperture stop already{}", stops[0], assumed),
            static_cast<double>(stops.size()), 1);
    } else if (checked.size() > 1 && stops[0] == checked.size()) {
        add(findings, "stop-position", checked.is_single_element() ? info : warning, stops[0],
            "the aperture stop is the last surface: a lens with its stop behind it, or the image plane listed?");
    } else if (checked.size() > 1 && stops[0] == 1) {
        add(findings, "stop-position", checked.headings[0] * checked.row(0).thickness_mm > 0.0 ? info : warning, 1,
            "the aperture stop is the first surface: a lens with its stop in front, or the object plane listed?");
    }
}

/// Rule 34: a row that was typed twice.
void check_duplicate(const CheckedLens& checked, int i, Findings& findings) {
    const optics::PrescribedSurface& row = checked.row(i);
    const optics::PrescribedSurface& next = checked.row(i + 1);
    const bool same = !row.is_flat() && row.radius_mm == next.radius_mm && row.thickness_mm == next.thickness_mm &&
                      row.semi_diameter_mm == next.semi_diameter_mm && row.asphere == next.asphere &&
                      row.odd_asphere == next.odd_asphere && row.along_normal == next.along_normal &&
                      row.medium.glass == next.medium.glass && row.medium.n_d == next.medium.n_d;
    if (same) {
        add(findings, "duplicate-surface", warning, i + 2, "it repeats the surface before it to the digit");
    }
}

}  // namespace

void check_table(const CheckedLens& checked, Findings& findings) {
    check_stop(checked, findings);
    for (int i = 0; i < checked.size(); ++i) {
        check_finite(checked.row(i), i + 1, findings);
        check_extremes(checked.row(i), i + 1, findings);
        check_flat_spelling(checked, i, findings);
        check_thickness_sign(checked, i, findings);
        check_semi_diameter(checked, i, findings);
        if (i + 1 < checked.size()) {
            check_duplicate(checked, i, findings);
        }
    }
}

}  // namespace lensproof::check
