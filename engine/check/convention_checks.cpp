// Tables that are right in another convention: in inches, with diameters for semi-diameters, from the sensor to the
// scene.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/infinity.h"
#include "engine/check/checks.h"
#include "engine/check/restoration.h"
#include "engine/check/sag.h"

namespace lensproof::check {

namespace {

struct Unit {
    const char* name;
    double factor;  // to mm
};

// Rule 25.
constexpr std::array kUnits = {Unit{"inches", 25.4}, Unit{"cm", 10.0}, Unit{"m", 1000.0}, Unit{"tenths of a mm", 0.1},
                               Unit{"mm of a table meant in inches", 1.0 / 25.4}};
constexpr double kSameUnit = 0.02;       // how well a ratio meets a unit's factor
constexpr double kUnitSlip = 0.05;       // a unit that is wrong throws a lens off by more than this
constexpr double kNormalisedFrom = 0.9;  // mm of focal length: tables for f = 1
constexpr double kNormalisedTo = 1.1;
// Rule 24.
constexpr double kTwiceFrom = 1.8;
constexpr double kTwiceTo = 2.2;
constexpr double kFastest = 0.5;   // f-number: n sin u' cannot exceed 1 in air
constexpr double kSlowest = 16.0;  // the slowest of 119 tables, the Gyogyotto, has f/8

void warn(Findings& findings, const char* code, int surface, std::string message, double value, double limit) {
    findings.push_back({code, warning, surface, std::move(message), value, limit});
}

void check_lens_units(const CheckedLens& checked, Findings& findings) {
    const double efl = checked.focus->efl;
    const std::optional<double>& claim = checked.claims.efl_mm;
    if (!claim) {
        if (efl > kNormalisedFrom && efl < kNormalisedTo) {
            warn(findings, "units", 0,
                 fmt::format("the focal length is {:.4f} mm: a table for f = 1, to be scaled?", efl), efl,
                 kNormalisedTo);
        }
        return;
    }
    for (const Unit& unit : kUnits) {
        if (std::abs(*claim / efl / unit.factor - 1.0) < kSameUnit) {
            warn(findings, "units", 0,
                 fmt::format("the stated focal length is {:.4g} times the table's: are its lengths in {}?",
                             *claim / efl, unit.name),
                 *claim / efl, unit.factor);
            return;
        }
    }
}

/// One column, or one number, in another unit than the rest.
void check_mixed_units(const CheckedLens& checked, const Restoration& restoration, Findings& findings) {
    if (!(restoration.residual_as_given() > kUnitSlip)) {
        return;
    }
    const auto report = [&](int surface, const std::string& what, const Unit& unit, double residual) {
        warn(findings, "units", surface,
             fmt::format("in {}, {} would bring focal length and back focus within {:.2g} % of what is stated",
                         unit.name, what, 100.0 * residual),
             100.0 * restoration.residual_as_given(), 100.0 * Restoration::kRestored);
    };
    for (const Unit& unit : kUnits) {
        ParaxialTable gaps = checked.table;
        ParaxialTable radii = checked.table;
        for (int i = 0; i < checked.size(); ++i) {
            gaps.gap[i] *= unit.factor;
            radii.curvature[i] /= unit.factor;
        }
        if (const double residual = restoration.residual(gaps); restoration.restores(residual)) {
            report(0, "the thicknesses", unit, residual);
        }
        if (const double residual = restoration.residual(radii); restoration.restores(residual)) {
            report(0, "the radii", unit, residual);
        }
        for (int i = 0; i < checked.size(); ++i) {
            ParaxialTable one = checked.table;
            one.curvature[i] /= unit.factor;
            if (const double residual = restoration.residual(one); restoration.restores(residual)) {
                report(i + 1, fmt::format("its radius of {}", checked.row(i).radius_mm), unit, residual);
            }
            one = checked.table;
            one.gap[i] *= unit.factor;
            if (const double residual = restoration.residual(one); restoration.restores(residual)) {
                report(i + 1, fmt::format("the thickness of {} behind it", checked.row(i).thickness_mm), unit,
                       residual);
            }
        }
    }
}

/// How many surfaces and elements are impossible with semi-diameters `scale` times those given.
int impossible_rims(const CheckedLens& checked, double scale) {
    int count = 0;
    for (int i = 0; i < checked.size(); ++i) {
        const double own_reach = scale * checked.semi_diameters[i];
        const double sag = sag_at(checked.row(i), own_reach);
        if (std::isnan(sag)) {
            ++count;
        } else if (i + 1 < checked.size() && checked.is_glass_behind(i)) {
            const double edge =
                checked.row(i).thickness_mm + sag_at(checked.row(i + 1), scale * checked.semi_diameters[i + 1]) - sag;
            const double reach = scale * std::min(checked.semi_diameters[i], checked.semi_diameters[i + 1]);
            const bool crosses = separation_at(checked.row(i), checked.row(i + 1), reach) < 0.0;
            count += edge < 0.0 && crosses ? 1 : 0;
        }
    }
    return count;
}

/// Rule 24, of the table as a whole.
void check_all_diameters(const CheckedLens& checked, Findings& findings) {
    const bool is_stated = std::ranges::none_of(checked.is_estimated, [](bool estimated) { return estimated; });
    if (!is_stated) {
        return;
    }
    if (checked.paraxial && checked.claims.f_number) {
        const double ratio = *checked.claims.f_number / checked.paraxial->f_number;
        if (ratio > kTwiceFrom && ratio < kTwiceTo) {
            warn(findings, "diameters", 0,
                 fmt::format("the stated f-number is {:.2f} times the table's: diameters in place of semi-diameters?",
                             ratio),
                 ratio, kTwiceFrom);
            return;
        }
        if (1.0 / ratio > kTwiceFrom && 1.0 / ratio < kTwiceTo) {
            warn(findings, "diameters", 0,
                 fmt::format("the table's f-number is {:.2f} times the stated one: semi-diameters halved once too "
                             "often?",
                             1.0 / ratio),
                 ratio, 1.0 / kTwiceFrom);
            return;
        }
        for (const Unit& unit : kUnits) {
            if (std::abs(1.0 / ratio / unit.factor - 1.0) < kSameUnit) {
                warn(findings, "units", 0,
                     fmt::format("the table's f-number is {:.3g} times the stated one: semi-diameters in {}?",
                                 1.0 / ratio, unit.name),
                     1.0 / ratio, unit.factor);
                return;
            }
        }
    }
    const int impossible = impossible_rims(checked, 1.0);
    if (impossible >= 2 && impossible_rims(checked, 0.5) == 0) {
        warn(findings, "diameters", 0,
             fmt::format("{} surfaces reach beyond their spheres or cut through their elements' edges, and none would "
                         "with half the semi-diameters: diameters in their place?",
                         impossible),
             impossible, 0.0);
    }
}

/// A semi-diameter that sticks out of its neighbours by a factor of two, on both sides, or at an end of the lens of its
/// element's other one. Of 91 tables, elements are more than 1.75 times as wide on one side only where the other is
/// nearly a half sphere, and one beside a stop.
void check_one_diameter(const CheckedLens& checked, int i, Findings& findings) {
    const double here = checked.semi_diameters[i];
    double largest = 0.0;
    double smallest = kInfinity;
    for (const int k : {i - 1, i + 1}) {
        if (k >= 0 && k < checked.size()) {
            largest = std::max(largest, checked.semi_diameters[k]);
            smallest = std::min(smallest, checked.semi_diameters[k]);
        }
    }
    // The two neighbours agree with each other, and with half of what stands here.
    constexpr double kAgree = 1.35;
    constexpr double kSticksOut = 1.6;
    constexpr double kSticksOutAtAnEnd = 1.75;
    constexpr double kSteep = 0.75;
    const bool one_sided = i == 0 || i + 1 == checked.size();
    const bool same_element = (i > 0 && checked.is_glass_behind(i - 1)) || checked.is_glass_behind(i);
    const double half = 0.5 * here;
    const bool fits_halved = half < kAgree * smallest && half * kAgree > largest;
    const int other = i == 0 ? 1 : i - 1;
    const bool is_fair =
        !one_sided ||
        (checked.size() > 1 && checked.semi_diameters[other] * std::abs(checked.row(other).curvature()) < kSteep);
    if (is_fair && same_element && here > (one_sided ? kSticksOutAtAnEnd : kSticksOut) * largest && fits_halved) {
        warn(findings, "diameters", i + 1,
             fmt::format("its semi-diameter of {} mm is {:.2f} times its neighbours': a diameter?", here,
                         here / largest),
             here / largest, kSticksOut);
    }
}

/// Whether a design program's file states, beside the rims, the aperture that they make.
bool has_stated_aperture(const CheckedLens& checked) {
    constexpr double kSame = 0.1;
    const optics::SystemAperture& aperture = checked.prescription.aperture;
    const auto is_met = [&](optics::ApertureKind kind, double computed) {
        return aperture.kind == kind && std::abs(std::abs(computed) / aperture.value - 1.0) < kSame;
    };
    return is_met(optics::ApertureKind::entrance_pupil_diameter, checked.paraxial->entrance_pupil_diameter) ||
           is_met(optics::ApertureKind::f_number, checked.paraxial->f_number);
}

/// What no lens's speed is.
void check_speed(const CheckedLens& checked, Findings& findings) {
    if (!checked.paraxial || checked.assumed_stop) {
        return;
    }
    const double f_number = std::abs(checked.paraxial->f_number);
    const int stop = checked.lens->stop_index() + 1;
    if (f_number < kFastest) {
        warn(findings, "f-number", stop,
             fmt::format("the table's f-number is {:.3f}, and none below 0.5 images sharply: diameters in place of "
                         "semi-diameters?",
                         f_number),
             f_number, kFastest);
    } else if (f_number > kSlowest && std::isfinite(f_number) && !has_stated_aperture(checked)) {
        warn(findings, "f-number", stop,
             fmt::format("the table's f-number is {:.3g}, slower than any lens is wide open: semi-diameters in inches "
                         "or cm?",
                         f_number),
             f_number, kSlowest);
    }
}

/// Rule 34: the list from the sensor to the scene, or with every sign turned.
void check_order(const CheckedLens& checked, const Restoration& restoration, Findings& findings) {
    const int count = checked.size();
    const auto judge = [&](const ParaxialTable& table, const char* what) {
        const double residual = restoration.residual(table);
        if (restoration.restores(residual)) {
            warn(findings, "reversed", 0,
                 fmt::format("{}, the table would meet the stated focal length and back focus within {:.2g} %", what,
                             100.0 * residual),
                 100.0 * restoration.residual_as_given(), 100.0 * Restoration::kRestored);
        }
    };
    ParaxialTable reversed = checked.table;
    for (int i = 0; i < count; ++i) {
        reversed.curvature[i] = checked.table.curvature[count - 1 - i];
        reversed.index[i] = checked.index_before(count - 1 - i);
        if (i + 1 < count) {
            reversed.gap[i] = checked.table.gap[count - 2 - i];
        }
    }
    judge(reversed, "read from its last row to its first");
    const auto turn = [](ParaxialTable table) {
        std::ranges::transform(table.curvature, table.curvature.begin(), std::negate<>());
        return table;
    };
    judge(turn(reversed), "turned round, scene for sensor");
    judge(turn(checked.table), "with the signs of all radii turned");
}

}  // namespace

void check_conventions(const CheckedLens& checked, Findings& findings) {
    check_all_diameters(checked, findings);
    check_speed(checked, findings);
    for (int i = 0; i < checked.size(); ++i) {
        check_one_diameter(checked, i, findings);
    }
    if (!checked.focus) {
        return;
    }
    check_lens_units(checked, findings);
    const Restoration restoration(checked);
    if (restoration.has_claims()) {
        check_mixed_units(checked, restoration, findings);
        check_order(checked, restoration, findings);
    }
}

}  // namespace lensproof::check
