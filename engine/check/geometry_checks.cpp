// Surfaces against each other: edges and centres of elements, gaps, cement; and surfaces that do not keep their shape.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "engine/base/bisect.h"
#include "engine/check/checks.h"
#include "engine/check/sag.h"

namespace lensproof::check {

namespace {

// Customs of manufacture are no signs of a wrong table: of 49 products' patents, 49 break one of them. Rule 7: Edmund
// Optics and photonics.com (article 64048): radii below 0.7 diameters are hard to make.
constexpr double kSteepest = 0.714;
constexpr double kFlattestSag = 0.1;  // mm, rule 8, same source
// Rule 9: the customary least edge, at a blank 1 mm wider than the clear diameter; and this project's own.
constexpr double kBlankMargin = 0.5;  // mm of radius
constexpr double kThinnestBlankEdge = 0.7;
constexpr double kThinnestEdge = 1.0;
constexpr double kThinnestRelativeEdge = 0.05;  // of the diameter
// Rule 10: 6 : 1 to 10 : 1 is the usual rule for diameter to centre thickness.
constexpr double kThinnestCentre = 1.0;
constexpr double kThinnestRelativeCentre = 0.1;
constexpr double kNarrowestGap = 0.05;  // mm, rule 11
constexpr double kSelfCentring = 0.56;  // rule 36: Karow, Fabrication Methods for Precision Optics (1993), p. 524
// Rule 11. Clear apertures read off drawings reach a little beyond where the surfaces meet in 10 of 91 tables, by
// 0.2 to 3.8 % of the aperture in all but those of two lenses.
constexpr double kDeepCrossing = 0.04;
// Rule 35. Of the 27 aspheric lenses among 49 products, the two whose aspheres turn over do so beyond 0.89 of an
// aperture that mostly is the transcriber's.
constexpr double kOuterAperture = 0.85;
constexpr int kSamples = 64;   // of the height, where no closed form serves
constexpr int kHalvings = 50;  // of a step between samples

bool is_known(double value) {
    return std::isfinite(value);
}

/// Two successive surfaces, what lies between them, and how far out each reaches; z as light runs between them.
struct Space {
    const CheckedLens& checked;
    int i;  // the first surface, from 0
    bool is_turned = checked.headings[i] < 0.0;
    optics::PrescribedSurface front = is_turned ? checked.row(i).turned() : checked.row(i);
    optics::PrescribedSurface rear = is_turned ? checked.row(i + 1).turned() : checked.row(i + 1);
    double front_reach = checked.semi_diameters[i];
    double rear_reach = checked.semi_diameters[i + 1];

    [[nodiscard]] bool is_estimated() const { return checked.is_estimated[i] || checked.is_estimated[i + 1]; }
    /// What an unstated semi-diameter implies is no more than worth a look.
    [[nodiscard]] optics::Severity at_most(optics::Severity severity) const {
        return is_estimated() ? std::min(severity, warning) : severity;
    }
    [[nodiscard]] int surface() const { return i + 1; }
};

/// Half a unit of the last digit that a length is given with.
double rounding_of(double length) {
    const std::string text = fmt::format("{}", length);
    const std::size_t point = text.find('.');
    const std::size_t decimals = point == std::string::npos ? 0 : text.size() - point - 1;
    return 0.5 * std::pow(10.0, -static_cast<double>(decimals));
}

/// The least separation up to `reach`, and where.
struct Narrowest {
    double separation;
    double r = 0.0;
};

Narrowest narrowest_up_to(const Space& space, double reach) {
    Narrowest narrowest{.separation = space.front.thickness_mm};
    for (int k = 1; k <= kSamples; ++k) {
        const double r = reach * k / kSamples;
        const double here = separation_at(space.front, space.rear, r);
        if (here < narrowest.separation) {
            narrowest = {.separation = here, .r = r};
        }
    }
    return narrowest;
}

/// The height that both surfaces reach, less what the rounding of their semi-diameters may have added.
double certain_reach(const Space& space) {
    return std::min(space.front_reach - rounding_of(space.front_reach),
                    space.rear_reach - rounding_of(space.rear_reach));
}

/// How bad it is that the surfaces come to `separation`: an error where the clear apertures are deep inside each other,
/// no more than a warning where the rounding of semi-diameters, or their having been read off a drawing, explains it.
optics::Severity crossing_severity(const Space& space, double separation) {
    const bool is_explained = narrowest_up_to(space, certain_reach(space)).separation >= 0.0;
    const bool is_deep = -separation > kDeepCrossing * std::min(space.front_reach, space.rear_reach);
    return is_deep && !is_explained ? space.at_most(error) : warning;
}

/// Rules 7 and 8, of a surface by itself.
void check_steepness(const CheckedLens& checked, int i, Findings& findings) {
    const optics::PrescribedSurface& row = checked.row(i);
    const double steepness = std::abs(checked.semi_diameters[i] * row.curvature());
    if (steepness > kSteepest && steepness < 1.0) {
        findings.push_back({"steep-surface", info, i + 1,
                            fmt::format("its radius is only {:.2f} of its diameter: hard to make", 0.5 / steepness),
                            steepness, kSteepest});
    }
    const double depth = std::abs(sag_at(row, checked.semi_diameters[i]));
    if (!row.is_flat() && !row.is_asphere() && depth < kFlattestSag) {
        findings.push_back({"nearly-flat", info, i + 1,
                            fmt::format("it is only {:.3f} mm deep at its rim: would a flat do?", depth), depth,
                            kFlattestSag, "mm"});
    }
}

/// Rule 9: t + sag(i + 1) − sag(i), each at its own semi-diameter. Semi-diameters are of light, or somebody's guess:
/// where the surfaces are apart up to the smaller one, a negative edge says no more than that they are not of glass.
void check_edge(const Space& space, Findings& findings) {
    const auto edge_with = [&](double margin) {
        return space.front.thickness_mm + sag_at(space.rear, space.rear_reach + margin) -
               sag_at(space.front, space.front_reach + margin);
    };
    const double edge = edge_with(0.0);
    const double blank_edge = edge_with(kBlankMargin);
    const double reach = std::max(space.front_reach, space.rear_reach);
    const double least = std::max(kThinnestEdge, kThinnestRelativeEdge * 2.0 * reach);
    const auto report = [&](optics::Severity severity, double value, double limit, std::string message) {
        findings.push_back({"edge-thickness", severity, space.surface(), std::move(message), value, limit, "mm"});
    };
    if (edge < 0.0) {
        const double narrowest = narrowest_up_to(space, std::min(space.front_reach, space.rear_reach)).separation;
        const bool meet = narrowest < 0.0;
        report(meet ? crossing_severity(space, narrowest) : info, edge, 0.0,
               fmt::format("its glass would be {:.3f} mm thick at the edge, each surface taken to its own "
                           "semi-diameter: {}",
                           edge,
                           meet ? "the two surfaces meet inside their apertures"
                                : "are these semi-diameters of light, not of glass?"));
    } else if (space.checked.settings.manufacture && blank_edge < kThinnestBlankEdge) {
        report(info, blank_edge, kThinnestBlankEdge,
               fmt::format("its glass is {:.3f} mm thick at the edge of a blank 1 mm wider than the clear aperture: it "
                           "chips",
                           blank_edge));
    } else if (space.checked.settings.manufacture && edge < least) {
        report(info, edge, least, fmt::format("its glass is only {:.3f} mm thick at the edge", edge));
    }
}

/// Rule 10.
void check_centre(const Space& space, Findings& findings) {
    const double diameter = 2.0 * std::max(space.front_reach, space.rear_reach);
    const bool is_negative = space.front.curvature() < space.rear.curvature();
    const double least = std::max(kThinnestCentre, is_negative ? kThinnestRelativeCentre * diameter : 0.0);
    const double thickness = space.front.thickness_mm;
    if (thickness > 0.0 && thickness < least) {
        findings.push_back({"centre-thickness", info, space.surface(),
                            fmt::format("its glass is only {} mm thick in the middle for a diameter of {:.3g} mm",
                                        thickness, diameter),
                            thickness, least, "mm"});
    }
}

/// Rule 11, over the height that both surfaces reach. A stop's plane that a surface bulges through cuts no glass.
void check_crossing(const Space& space, Findings& findings) {
    const auto [narrowest, where] = narrowest_up_to(space, std::min(space.front_reach, space.rear_reach));
    const bool is_glass = space.checked.is_glass_behind(space.i);
    const bool is_plane = space.checked.is_dummy(space.i) || space.checked.is_dummy(space.i + 1);
    const bool touches = narrowest < 0.0 || (narrowest == 0.0 && where > 0.0);
    if (touches && space.front.thickness_mm > 0.0) {
        findings.push_back({"surfaces-cross", is_plane ? info : crossing_severity(space, narrowest), space.surface(),
                            fmt::format("it runs {:.3f} mm into surface {}, {:.3g} mm from the axis{}", -narrowest,
                                        space.surface() + 1, where, is_plane ? " (a plane without glass)" : ""),
                            narrowest, 0.0, "mm"});
    } else if (space.checked.settings.manufacture && !is_glass && !is_plane && narrowest > 0.0 &&
               narrowest < kNarrowestGap) {
        findings.push_back({"air-gap", info, space.surface(),
                            fmt::format("only {:.3f} mm of air to surface {}, {:.3g} mm from the axis", narrowest,
                                        space.surface() + 1, where),
                            narrowest, kNarrowestGap, "mm"});
    }
}

/// The glass beyond the clear apertures, up to stated rims, ground flat there.
void check_rims(const Space& space, Findings& findings) {
    if (!space.front.rim_mm || !space.rear.rim_mm || space.checked.is_glass_behind(space.i)) {
        return;
    }
    const double separation =
        space.front.thickness_mm + sag_at(space.rear, space.rear_reach) - sag_at(space.front, space.front_reach);
    const bool overlap =
        separation < 0.0 && *space.front.rim_mm > space.rear_reach && *space.rear.rim_mm > space.front_reach;
    if (overlap) {
        findings.push_back(
            {"rims-overlap", warning, space.surface(),
             fmt::format("its rim and that of surface {} overlap by {:.3f} mm", space.surface() + 1, -separation),
             separation, 0.0, "mm"});
    }
}

// Rule 12: an air gap so thin between surfaces so nearly alike is cement that the table spells as two surfaces.
constexpr double kCementGap = 0.02;     // mm
constexpr double kCementRadii = 0.02;   // relative
constexpr double kCementHeights = 0.1;  // relative

void check_cement(const Space& space, Findings& findings) {
    const CheckedLens& checked = space.checked;
    const int i = space.i;
    if (checked.is_glass_behind(i)) {
        const bool is_glass_before = i > 0 && checked.is_glass_behind(i - 1);
        const bool same_dispersion =
            is_glass_before && checked.media[i] && checked.media[i - 1] &&
            optics::abbe_number(checked.media[i]->formula) == optics::abbe_number(checked.media[i - 1]->formula);
        if (is_glass_before && checked.is_dummy(i) && same_dispersion && !space.front.is_stop &&
            !space.front.is_flat()) {
            findings.push_back(
                {"no-index-step", warning, i + 1, "the glasses on both sides of it are the same: it does nothing"});
        }
        return;
    }
    const bool is_cement = i > 0 && checked.is_glass_behind(i - 1) && checked.is_glass_behind(i + 1) &&
                           space.front.thickness_mm >= 0.0 && space.front.thickness_mm <= kCementGap;
    const double front = space.front.curvature();
    const double rear = space.rear.curvature();
    const bool alike = std::abs(front - rear) <= kCementRadii * std::abs(front);
    if (!is_cement || !alike) {
        return;
    }
    const bool other_radius = front != rear;
    const bool other_height = std::abs(space.front_reach - space.rear_reach) > kCementHeights * space.front_reach;
    if (other_radius || other_height) {
        findings.push_back({"cemented-surfaces", warning, i + 1,
                            fmt::format("it looks cemented to surface {}, but their {} differ", i + 2,
                                        other_radius ? "radii" : "semi-diameters"),
                            other_radius ? 1.0 / front - 1.0 / rear : space.front_reach - space.rear_reach, 0.0, "mm"});
    }
}

/// Rule 36: the tangent of the angle between the two surfaces' normals where bell chucks hold them.
void check_centring(const Space& space, Findings& findings) {
    const auto slope = [](const optics::PrescribedSurface& row, double reach) {
        return std::asin(reach * row.curvature());
    };
    const bool is_single =
        (space.i == 0 || !space.checked.is_glass_behind(space.i - 1)) && !space.checked.is_glass_behind(space.i + 1);
    const double angle = std::abs(slope(space.front, space.front_reach) - slope(space.rear, space.rear_reach));
    if (is_single && std::tan(angle) < kSelfCentring && angle < 1.0) {
        findings.push_back({"centring", info, space.surface(),
                            fmt::format("the element does not centre itself between bell chucks (Karow's Z is {:.2f})",
                                        std::tan(angle)),
                            std::tan(angle), kSelfCentring});
    }
}

/// Rule 35: the sag is real over the aperture, and its slope keeps its direction.
void check_asphere(const CheckedLens& checked, int i, Findings& findings) {
    const optics::PrescribedSurface& row = checked.row(i);
    if (!row.is_asphere() && row.conic == 0.0) {
        return;
    }
    const optics::SurfaceShape<double> shape = optics::prescribed_shape(row);
    const double reach = checked.semi_diameters[i];
    const auto slope_at = [&](double r) { return 2.0 * r * optics::sag_profile(shape, r * r).slope; };
    double steepest = 0.0;   // dz/dr, of the first direction
    double rising_to = 0.0;  // r, where the slope last had that direction
    for (int k = 1; k <= kSamples; ++k) {
        const double r = reach * k / kSamples;
        const optics::SagProfile<double> here = optics::sag_profile(shape, r * r);
        if (!here.defined || !is_known(here.sag)) {
            // Of a conic: z is real up to (1 + k) c² r² = 1.
            const double end =
                std::min(r, 1.0 / (std::abs(row.curvature()) * std::sqrt(std::max(0.0, 1.0 + row.conic))));
            findings.push_back(
                {"asphere-ends", row.is_asphere() ? error : warning, i + 1,
                 fmt::format("its conic ends {:.4g} mm from the axis, inside its semi-diameter of {:.4g} mm", end,
                             reach),
                 end, reach, "mm"});
            return;
        }
        const double slope = slope_at(r);
        // A slope of a minute of arc in the other direction is a correction plate's; what it then reaches counts.
        constexpr double kNoticeable = 0.03;
        if (slope * steepest >= 0.0) {
            rising_to = r;
            steepest = std::abs(slope) > std::abs(steepest) ? slope : steepest;
        } else if (std::abs(slope) > kNoticeable && std::abs(steepest) > kNoticeable) {
            const double turned_at =
                bisected({rising_to, r}, kHalvings, [&](double at) { return slope_at(at) * steepest > 0.0; }).outside;
            findings.push_back(
                {"asphere-turns-over", turned_at < kOuterAperture * reach ? warning : info, i + 1,
                 fmt::format(
                     "it turns over inside its aperture: its slope changes sign {:.4g} mm from the axis, of {:.4g} mm",
                     turned_at, reach),
                 turned_at, reach, "mm"});
            return;
        }
    }
}

}  // namespace

bool is_custom_of_manufacture(const optics::Finding& finding) {
    constexpr std::array<std::string_view, 5> kCustoms = {"steep-surface", "nearly-flat", "centre-thickness", "air-gap",
                                                          "centring"};
    // A negative edge is said of every table.
    const bool is_thin_edge = finding.code == "edge-thickness" && finding.limit > 0.0;
    return is_thin_edge || std::ranges::find(kCustoms, finding.code) != kCustoms.end();
}

void check_geometry(const CheckedLens& checked, Findings& findings) {
    for (int i = 0; i < checked.size(); ++i) {
        if (!is_known(checked.semi_diameters[i]) || !is_known(checked.table.curvature[i])) {
            continue;
        }
        if (checked.settings.manufacture) {
            check_steepness(checked, i, findings);
        }
        check_asphere(checked, i, findings);
        const bool has_next = i + 1 < checked.size() && is_known(checked.semi_diameters[i + 1]) &&
                              is_known(checked.table.curvature[i + 1]) && is_known(checked.row(i).thickness_mm);
        if (!has_next) {
            continue;
        }
        const Space space{.checked = checked, .i = i};
        if (checked.is_glass_behind(i)) {
            check_edge(space, findings);
        }
        if (checked.settings.manufacture && checked.is_glass_behind(i)) {
            check_centre(space, findings);
            check_centring(space, findings);
        }
        check_crossing(space, findings);
        check_rims(space, findings);
        check_cement(space, findings);
    }
}

}  // namespace lensproof::check
