// Which change of one number would restore the stated focal length and back focus.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/check/checks.h"
#include "engine/check/digits.h"
#include "engine/check/restoration.h"
#include "engine/check/sag.h"

namespace lensproof::check {

namespace {

constexpr std::size_t kMost = 5;            // suggestions that are reported
constexpr double kRounding = 5e-4;          // of the focal length: residuals below it are alike
constexpr std::size_t kNeighbours = 12;     // glasses that one may have been mistaken for
constexpr double kThinnestRelative = 0.02;  // of the diameter: no glass is meant to be thinner
constexpr double kFromWarning = 0.003;      // residual from which something looks wrong

/// One number of the table as it might have been meant.
struct Trial {
    int surface = 0;  // from 0
    std::string message;
    double unlikelihood = 1.0;  // 1 for slips that happen often
    double residual = 0.0;
    ParaxialTable table;

    /// Lower is better: how far off, and how far-fetched.
    [[nodiscard]] double cost() const { return (residual + kRounding) * unlikelihood; }
};

/// The trials that bring the lens back to what is claimed of it.
class Trials {
  public:
    explicit Trials(const CheckedLens& checked) : lens_(checked), restoration_(checked) {}

    [[nodiscard]] bool is_needed() const {
        return lens_.focus && restoration_.has_claims() && restoration_.residual_as_given() > kFromWarning;
    }

    void run() {
        for (int i = 0; i < lens_.size(); ++i) {
            try_radius(i);
            try_thickness(i);
            try_index(i);
        }
        std::ranges::stable_sort(found_, {}, &Trial::cost);
    }

    [[nodiscard]] const std::vector<Trial>& found() const { return found_; }
    [[nodiscard]] const Restoration& restoration() const { return restoration_; }

  private:
    void judge(int surface, ParaxialTable table, double unlikelihood, const std::string& message) {
        const double residual = restoration_.residual(table);
        if (restoration_.restores(residual)) {
            found_.push_back({.surface = surface,
                              .message = message,
                              .unlikelihood = unlikelihood,
                              .residual = residual,
                              .table = std::move(table)});
        }
    }

    void try_radius(int i) {
        const optics::PrescribedSurface& row = lens_.row(i);
        if (row.is_flat()) {
            return;
        }
        for (const NumberChange& change : plausible_changes(row.radius_mm)) {
            if (change.value == 0.0) {
                continue;
            }
            ParaxialTable table = lens_.table;
            table.curvature[i] += 1.0 / change.value - row.curvature();
            judge(i, std::move(table), change.unlikelihood,
                  fmt::format("radius {} in place of {} ({})", change.value, row.radius_mm, change.slip));
        }
    }

    void try_thickness(int i) {
        const double given = lens_.row(i).thickness_mm;
        if (given == 0.0 || i + 1 == lens_.size()) {
            return;  // the last one is a claim
        }
        for (const NumberChange& change : plausible_changes(given)) {
            if (change.value > 0.0) {
                ParaxialTable table = lens_.table;
                table.gap[i] = change.value;
                judge(i, std::move(table), change.unlikelihood,
                      fmt::format("thickness {} in place of {} behind it ({})", change.value, given, change.slip));
            }
        }
    }

    void try_index(int i) {
        if (!lens_.is_glass_behind(i)) {
            return;
        }
        const optics::StatedMedium& medium = lens_.row(i).medium;
        if (medium.n_d && medium.glass.empty()) {
            for (const NumberChange& change : plausible_changes(*medium.n_d)) {
                if (change.value > 1.3 && change.value < 2.3) {
                    ParaxialTable table = lens_.table;
                    table.index[i] += change.value - *medium.n_d;
                    judge(i, std::move(table), change.unlikelihood,
                          fmt::format("n_d {} in place of {} behind it ({})", change.value, *medium.n_d, change.slip));
                }
            }
            return;
        }
        if (!lens_.media[i]) {
            return;
        }
        const optics::DispersionFormula& formula = lens_.media[i]->formula;
        const double n_d = optics::refractive_index(formula, spectral::kLineD);
        for (const optics::Glass& glass :
             lens_.known_glasses->nearest(n_d, optics::abbe_number(formula), kNeighbours)) {
            constexpr double kFarFetched = 3.0;
            ParaxialTable table = lens_.table;
            table.index[i] = optics::refractive_index(glass.formula, lens_.wavelength_nm);
            if (glass.name != medium.glass && optics::covers(glass, lens_.wavelength_nm)) {
                judge(i, std::move(table), kFarFetched,
                      fmt::format("glass {} {} in place of {} behind it", glass.catalogue, glass.name, medium.glass));
            }
        }
    }

    const CheckedLens& lens_;
    Restoration restoration_;
    std::vector<Trial> found_;
};

/// Whether the changed table could be made: no glass that is a foil, or that cuts through itself at its clear
/// apertures.
bool is_possible(const CheckedLens& checked, const Trial& trial) {
    const auto row = [&](int i) {
        optics::PrescribedSurface changed = checked.row(i);
        if (!changed.is_asphere()) {
            changed.radius_mm = trial.table.curvature[i] == 0.0 ? 0.0 : 1.0 / trial.table.curvature[i];
        }
        changed.thickness_mm = trial.table.gap[i];
        return changed;
    };
    for (const int i : {trial.surface - 1, trial.surface}) {
        if (i < 0 || i + 1 >= checked.size()) {
            continue;
        }
        const double reach = std::min(checked.semi_diameters[i], checked.semi_diameters[i + 1]);
        const bool is_foil = trial.table.gap[i] < kThinnestRelative * 2.0 * checked.semi_diameters[i];
        if (checked.is_glass_behind(i) && is_foil && trial.table.gap[i] != checked.table.gap[i]) {
            return false;
        }
        if (std::isfinite(reach) && !(separation_at(row(i), row(i + 1), reach) > 0.0)) {
            return false;
        }
    }
    return true;
}

/// A slip in the last thickness, which is a claim itself: where the focal length is as stated, or not stated, the
/// change that puts the sensor into the image. Whether there is one.
bool suggest_last_thickness(const CheckedLens& checked, Findings& findings) {
    const double given = checked.row(checked.size() - 1).thickness_mm;
    const double efl = checked.focus->efl;
    const double image = checked.focus->image_distance;
    const bool is_lens_as_stated =
        !checked.claims.efl_mm || std::abs(efl / *checked.claims.efl_mm - 1.0) < kFromWarning;
    const auto miss = [&](double thickness) { return std::abs((thickness - image) / efl); };
    const bool is_meant = checked.is_at_best_focus || checked.has_virtual_image() || checked.collimates();
    if (!is_lens_as_stated || is_meant || given == 0.0 || !(miss(given) > kFromWarning)) {
        return false;
    }
    std::optional<NumberChange> best;
    for (const NumberChange& change : plausible_changes(given)) {
        if (miss(change.value) < kRounding && (!best || miss(change.value) < miss(best->value))) {
            best = change;
        }
    }
    if (best) {
        findings.push_back({"suggestion", info, checked.size(),
                            fmt::format("thickness {} in place of {} behind it ({}) would put the sensor into the "
                                        "image, within {:.2g} % of the focal length",
                                        best->value, given, best->slip, 100.0 * miss(best->value)),
                            100.0 * miss(best->value), 100.0 * kRounding, "%"});
    }
    return best.has_value();
}

}  // namespace

void suggest_changes(const CheckedLens& checked, Findings& findings) {
    Trials trials(checked);
    if (!checked.focus || suggest_last_thickness(checked, findings) || !trials.is_needed()) {
        return;
    }
    trials.run();
    std::size_t reported = 0;
    for (const Trial& trial : trials.found()) {
        if (reported == kMost) {
            break;
        }
        if (is_possible(checked, trial)) {
            ++reported;
            findings.push_back(
                {"suggestion", info, trial.surface + 1,
                 fmt::format("{} would bring the stated focal length and back focus back, within {:.2g} %",
                             trial.message, 100.0 * trial.residual),
                 100.0 * trial.residual, 100.0 * Restoration::kRestored, "%"});
        }
    }
}

}  // namespace lensproof::check
