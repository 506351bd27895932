// Glasses: whether names are known, figures agree with them, and every wavelength of a render has an index.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/check/checks.h"

namespace lensproof::check {

namespace {

// Rule 13: from fluorite crystals to the densest flints.
constexpr double kLowestIndex = 1.35;
constexpr double kHighestIndex = 2.2;
constexpr double kLowestAbbe = 15.0;
constexpr double kHighestAbbe = 100.0;
// Rule 15. Listings of three decimals are off by half a unit of the last, and a little.
constexpr double kIndexError = 1e-3;
constexpr double kIndexRounding = 5.1e-4;
constexpr double kIndexWarning = 2e-4;
constexpr double kAbbeError = 0.05;  // relative
constexpr double kAbbeWarning = 0.01;
// Rule 17: what renders take by default, of which patents that list indices give no more than the lines g to C.
constexpr double kRenderFrom = 400.0;
constexpr double kRenderTo = 700.0;
constexpr double kListedLines[] = {spectral::kLineG, spectral::kLineC};

optics::GlassMatch resolve(const CheckedLens& checked, const std::string& name) {
    return checked.known_glasses->resolve(name, checked.prescription.preferred_makers);
}

std::string medium_in_words(const optics::StatedMedium& medium) {
    return medium.glass.empty() ? fmt::format("n_d = {}", medium.n_d.value_or(kNaN)) : medium.glass;
}

/// Rule 13.
void check_index_range(const CheckedLens& checked, int i, Findings& findings) {
    const double index = std::abs(checked.table.index[i]);
    const std::string is = fmt::format("the index behind it is {:.6g}", index);
    // What a catalogue has of a name is a material's, however high: germanium's 4 in the infrared.
    const bool is_catalogued =
        !checked.row(i).medium.glass.empty() && resolve(checked, checked.row(i).medium.glass).glass;
    if (index < 1.0) {
        findings.push_back({"index-range", error, i + 1, is + ": below that of air", index, 1.0});
    } else if (!is_catalogued && (index < kLowestIndex || index > kHighestIndex)) {
        findings.push_back({"index-range", warning, i + 1, is + ": no glass has it", index,
                            index < kLowestIndex ? kLowestIndex : kHighestIndex});
    }
    const optics::StatedMedium& medium = checked.row(i).medium;
    const double V_d = medium.V_d.value_or(60.0);
    if (V_d <= 0.0 || V_d < kLowestAbbe || V_d > kHighestAbbe) {
        findings.push_back({"abbe-range", V_d <= 0.0 ? error : warning, i + 1,
                            fmt::format("an Abbe number of {} behind it: no glass has it", V_d), V_d,
                            V_d < kLowestAbbe ? kLowestAbbe : kHighestAbbe});
    }
    if (!optics::covers(*checked.media[i], spectral::kLineF) || !optics::covers(*checked.media[i], spectral::kLineC)) {
        return;
    }
    const optics::DispersionFormula& formula = checked.media[i]->formula;
    const double n_F = optics::refractive_index(formula, spectral::kLineF);
    const double n_d = optics::refractive_index(formula, spectral::kLineD);
    const double n_C = optics::refractive_index(formula, spectral::kLineC);
    const bool has_dispersion = n_F != n_C;
    if (has_dispersion && !(n_F > n_d && n_d > n_C)) {
        findings.push_back(
            {"dispersion-order", warning, i + 1,
             fmt::format("its index does not fall from blue to red: {:.5f} at F, {:.5f} at d, {:.5f} at C", n_F, n_d,
                         n_C),
             n_F - n_C, 0.0});
    }
}

/// Rule 15, of a name beside figures.
void check_figures(const CheckedLens& checked, int i, const optics::Glass& glass, Findings& findings) {
    const optics::StatedMedium& medium = checked.row(i).medium;
    if (medium.n_d) {
        const double n_d = optics::refractive_index(glass.formula, spectral::kLineD);
        const double off = std::abs(*medium.n_d - n_d);
        // Three decimals are a listing's habit, more are a claim.
        const bool has_three_decimals = std::abs(*medium.n_d * 1e3 - std::round(*medium.n_d * 1e3)) < 1e-6;
        if (off > kIndexWarning) {
            const bool rounded = has_three_decimals && off <= kIndexRounding;
            findings.push_back({"glass-index",
                                off > kIndexError ? error
                                : rounded         ? info
                                                  : warning,
                                i + 1,
                                fmt::format("n_d = {} is stated beside {}, which has {:.5f}{}", *medium.n_d,
                                            medium.glass, n_d, rounded ? ": rounded" : ""),
                                off, off > kIndexError ? kIndexError : kIndexWarning});
        }
    }
    if (medium.V_d && std::isfinite(*medium.V_d)) {
        const double V_d = optics::abbe_number(glass.formula);
        const double off = std::abs(*medium.V_d / V_d - 1.0);
        if (off > kAbbeWarning) {
            findings.push_back(
                {"glass-abbe", off > kAbbeError ? error : warning, i + 1,
                 fmt::format("V_d = {} is stated beside {}, which has {:.2f}", *medium.V_d, medium.glass, V_d),
                 100.0 * off, 100.0 * (off > kAbbeError ? kAbbeError : kAbbeWarning), "%"});
        }
    }
}

/// Rule 14.
void check_name(const CheckedLens& checked, int i, Findings& findings) {
    const optics::StatedMedium& medium = checked.row(i).medium;
    if (medium.glass.empty() || medium.is_air() || checked.settings.indices.contains(medium.glass)) {
        return;
    }
    const optics::GlassMatch match = resolve(checked, medium.glass);
    if (match.glass) {
        if (match.how == optics::GlassMatch::How::spelled_differently) {
            findings.push_back({"glass-spelling", info, i + 1,
                                fmt::format("the glass {} is taken for {} {}", medium.glass, match.glass->catalogue,
                                            match.glass->name)});
        }
        if (!match.also_in.empty()) {
            findings.push_back(
                {"glass-ambiguous", info, i + 1,
                 fmt::format(
                     "the glass {} is taken for that of {}; a glass of this name, with another formula, is in {}, too",
                     medium.glass, match.glass->catalogue, fmt::join(match.also_in, ", "))});
        }
        if (match.glass->status == "obsolete") {
            findings.push_back({"glass-obsolete", info, i + 1,
                                fmt::format("{} {} is no longer made", match.glass->catalogue, match.glass->name)});
        }
        if (!checked.prescription.figures_are_spare) {
            check_figures(checked, i, *match.glass, findings);
        }
        return;
    }
    findings.push_back(optics::unknown_glass(medium, match, i + 1));
}

/// Whether the table gives the glass behind a surface by figures alone.
bool is_given_by_figures(const CheckedLens& checked, int i) {
    const optics::StatedMedium& medium = checked.row(i).medium;
    const bool is_named = !medium.glass.empty() && resolve(checked, medium.glass).glass;
    return checked.is_glass_behind(i) && !is_named && medium.n_d && medium.indices.empty();
}

/// Rule 16. A table that gives no glass's dispersion is silent about colour; one that leaves some out has a gap.
void check_achromatic(const CheckedLens& checked, Findings& findings) {
    std::vector<int> surfaces;
    std::size_t glasses = 0;
    for (int i = 0; i < checked.size(); ++i) {
        if (is_given_by_figures(checked, i) && !checked.row(i).medium.V_d) {
            surfaces.push_back(i + 1);
        }
        glasses += checked.is_glass_behind(i) ? 1 : 0;
    }
    if (!surfaces.empty()) {
        findings.push_back({"no-dispersion", surfaces.size() < glasses ? warning : info, surfaces.front(),
                            fmt::format("no Abbe number and no known name for the glass behind surface{} {}: a "
                                        "spectral render sees one colour there",
                                        surfaces.size() > 1 ? "s" : "", fmt::join(surfaces, ", "))});
    }
}

/// How far the model of dispersion may be off for glasses that are given by n_d and V_d.
void report_normal_line(const CheckedLens& checked, Findings& findings) {
    std::vector<int> surfaces;
    int worst = 0;
    double worst_error = 0.0;
    const auto error_at = [&](int i, double wavelength) {
        const optics::StatedMedium& medium = checked.row(i).medium;
        return optics::normal_line_error(checked.known_glasses->glasses(), *medium.n_d, *medium.V_d, wavelength)
            .percentile_95;
    };
    for (int i = 0; i < checked.size(); ++i) {
        const optics::StatedMedium& medium = checked.row(i).medium;
        if (!is_given_by_figures(checked, i) || !(medium.V_d.value_or(0.0) > 0.0) || !(*medium.n_d > 1.0)) {
            continue;
        }
        surfaces.push_back(i + 1);
        // In a render, the model errs most in the blue.
        const double off = error_at(i, kRenderFrom);
        if (off >= worst_error) {
            worst_error = off;
            worst = i;
        }
    }
    if (surfaces.empty()) {
        return;
    }
    const std::string others = surfaces.size() > 1
                                   ? fmt::format(", the worst of {} such glasses here (behind surfaces {})",
                                                 surfaces.size(), fmt::join(surfaces, ", "))
                                   : "";
    std::vector<std::string> errors;
    for (const double wavelength : {optics::kNormalLineMinNm, kRenderFrom, kRenderTo, optics::kNormalLineMaxNm}) {
        errors.push_back(fmt::format("{:.1e} at {} nm", error_at(worst, wavelength), wavelength));
    }
    findings.push_back({"normal-line", info, worst + 1,
                        fmt::format("given by n_d and V_d alone{}: its dispersion is modelled, with an error in n of "
                                    "up to {} (95 % of the real glasses nearby)",
                                    others, fmt::join(errors, ", ")),
                        worst_error});
}

/// Rule 17. Without an index at the wavelength that is asked for, nothing can be computed; without one elsewhere, some
/// renders are off.
void check_wavelengths(const CheckedLens& checked, int i, Findings& findings) {
    if (checked.settings.indices.contains(checked.row(i).medium.glass)) {
        return;  // an index in place of a glass holds at every wavelength
    }
    const optics::Glass& glass = *checked.media[i];
    const double asked = checked.wavelength_nm;
    std::vector<double> wavelengths{asked};
    wavelengths.insert(wavelengths.end(), checked.prescription.wavelengths_nm.begin(),
                       checked.prescription.wavelengths_nm.end());
    wavelengths.insert(wavelengths.end(), {kRenderFrom, kRenderTo});
    const auto outside =
        std::ranges::find_if(wavelengths, [&](double wavelength) { return !optics::covers(glass, wavelength); });
    if (outside == wavelengths.end()) {
        return;
    }
    const bool nothing_computed = *outside == asked;
    // Of what renders take; a lens for the infrared or the ultraviolet makes no claim there.
    const bool is_visible = std::ranges::any_of(wavelengths.begin(), wavelengths.end() - 2, [](double wavelength) {
        return wavelength >= kRenderFrom && wavelength <= kRenderTo;
    });
    const bool is_usual =
        outside >= wavelengths.end() - 2 &&
        (!is_visible || std::ranges::all_of(kListedLines, [&](double line) { return optics::covers(glass, line); }));
    findings.push_back(
        {"wavelength-range",
         nothing_computed ? error
         : is_usual       ? info
                          : warning,
         i + 1,
         fmt::format("{} nm is outside the range of {}, {} to {} nm{}", *outside, glass.name, glass.min_wavelength_nm,
                     glass.max_wavelength_nm, nothing_computed ? ": nothing is computed there" : ""),
         *outside, *outside < glass.min_wavelength_nm ? glass.min_wavelength_nm : glass.max_wavelength_nm, "nm"});
}

/// Rule 18.
void check_last_medium(const CheckedLens& checked, Findings& findings) {
    const int last = checked.size() - 1;
    if (!checked.row(last).medium.is_air() && std::abs(checked.table.index[last]) != 1.0) {
        findings.push_back({"last-medium", warning, last + 1,
                            fmt::format("the last surface is followed by {}, not by air: is a row missing?",
                                        medium_in_words(checked.row(last).medium)),
                            checked.table.index[last], 1.0});
    }
}

}  // namespace

void check_glasses(const CheckedLens& checked, Findings& findings) {
    for (int i = 0; i < checked.size(); ++i) {
        check_name(checked, i, findings);
        if (checked.row(i).medium.is_air() || !checked.media[i]) {
            continue;
        }
        check_wavelengths(checked, i, findings);
        if (std::isfinite(checked.table.index[i])) {
            check_index_range(checked, i, findings);
        }
    }
    check_achromatic(checked, findings);
    report_normal_line(checked, findings);
    check_last_medium(checked, findings);
}

}  // namespace lensproof::check
