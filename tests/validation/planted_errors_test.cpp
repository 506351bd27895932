// tests/validation/planted_errors_test.cpp — good prescriptions, corrupted in every way that tables get corrupted, and
// how many of the corruptions the checker sees. It prints the table.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "engine/base/csv.h"
#include "engine/base/infinity.h"
#include "engine/check/checked_lens.h"
#include "engine/check/rays.h"
#include "engine/check/sag.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/prescription/prescription_file.h"
#include "tests/places.h"
#include "tests/trials.h"

namespace lensproof::planted_errors_test {

/// A prescription with one thing wrong.
struct Corruption {
    std::string kind;
    int surface = 0;  // from 1; 0: the lens as a whole
    std::string was;  // the number that was right, as a suggestion would write it
    optics::Prescription prescription;
};

/// The codes that name a kind of corruption rightly.
const std::map<std::string, std::set<std::string>> kRightNames = {
    {"radius: sign turned", {"focal-length", "back-focus", "negative-power", "no-power"}},
    {"radius: digits swapped", {"focal-length", "back-focus"}},
    {"radius: decimal point lost", {"focal-length", "back-focus", "extreme-value"}},
    {"radius: in inches or cm", {"focal-length", "back-focus", "units"}},
    {"radius: asphere's sign turned", {"blur", "marginal-ray", "asphere-turns-over", "asphere-ends"}},
    {"rows swapped", {"focal-length", "back-focus", "negative-power", "no-power", "blur"}},
    {"thickness: decimal point lost", {"focal-length", "back-focus"}},
    {"thickness: doubled", {"focal-length", "back-focus"}},
    {"index: digits swapped", {"focal-length", "back-focus", "index-range"}},
    {"thickness: digits swapped", {"focal-length", "back-focus"}},
    {"thickness: negative", {"negative-thickness"}},
    {"thickness: in inches or cm", {"focal-length", "back-focus", "units"}},
    {"thickness: surfaces crossed", {"surfaces-cross", "edge-thickness", "sensor-inside-lens"}},
    {"all lengths in inches or cm", {"units", "focal-length"}},
    {"all thicknesses in inches or cm", {"units", "focal-length", "back-focus"}},
    {"all semi-diameters in inches or cm", {"units", "f-number"}},
    {"all diameters for semi-diameters", {"diameters", "f-number"}},
    {"one diameter for a semi-diameter",
     {"diameters", "edge-thickness", "surfaces-cross", "semi-diameter-beyond-sphere", "f-number"}},
    {"glass: the nearest", {"focal-length", "back-focus", "glass-index", "glass-abbe", "axial-colour"}},
    {"glass: another of the lens", {"focal-length", "back-focus", "glass-index", "glass-abbe", "axial-colour"}},
    {"glass: far away", {"focal-length", "back-focus", "glass-index", "glass-abbe", "axial-colour"}},
    {"glass: unknown name", {"glass-unknown"}},
    {"stop missing", {"stop-missing"}},
    {"stop doubled", {"stop-doubled"}},
    {"not a number", {"not-finite"}},
    {"list reversed", {"reversed", "focal-length", "back-focus"}},
};

/// Whether such a slip is one where it changes images; others are wrong whatever they change.
bool is_judged_by_images(const std::string& kind) {
    const std::set<std::string>& names = kRightNames.at(kind);
    return names.contains("back-focus") || names.contains("focal-length") || names.contains("blur");
}

std::string digits_of(double value) {
    return fmt::format("{}", value);
}

double number(const std::string& text) {
    return std::strtod(text.c_str(), nullptr);
}

/// Every number that two swapped neighbouring digits make of `value`.
std::vector<double> swapped(double value) {
    std::vector<double> all;
    const std::string text = digits_of(value);
    for (std::size_t i = 0; i + 1 < text.size(); ++i) {
        std::string other = text;
        std::swap(other[i], other[i + 1]);
        const bool digits = std::isdigit(text[i]) != 0 && std::isdigit(text[i + 1]) != 0 && text[i] != text[i + 1];
        if (digits && number(other) != 0.0) {
            all.push_back(number(other));
        }
    }
    return all;
}

class Corruptor {
  public:
    Corruptor(const optics::Prescription& good, const optics::GlassCatalogue& glasses)
        : good_(good), glasses_(glasses) {
        for (int i = 0; i < size(); ++i) {
            corrupt_radius(i);
            corrupt_thickness(i);
            corrupt_semi_diameter(i);
            corrupt_glass(i);
        }
        corrupt_stop();
        corrupt_lens();
    }

    [[nodiscard]] const std::vector<Corruption>& all() const { return all_; }

  private:
    [[nodiscard]] int size() const { return static_cast<int>(good_.surfaces.size()); }
    [[nodiscard]] const optics::PrescribedSurface& row(int i) const { return good_.surfaces[i]; }

    void plant(const std::string& kind, int surface, const std::string& was,
               const std::function<void(optics::Prescription&)>& change) {
        all_.push_back({.kind = kind, .surface = surface, .was = was, .prescription = good_});
        change(all_.back().prescription);
    }

    void corrupt_radius(int i) {
        const double radius = row(i).radius_mm;
        if (row(i).is_flat()) {
            return;
        }
        const auto set = [&](const std::string& kind, double value) {
            plant(kind, i + 1, digits_of(radius), [&](optics::Prescription& p) { p.surfaces[i].radius_mm = value; });
        };
        set("radius: sign turned", -radius);
        for (const double value : swapped(radius)) {
            set("radius: digits swapped", value);
        }
        const std::string text = digits_of(radius);
        if (const std::size_t point = text.find('.'); point != std::string::npos) {
            set("radius: decimal point lost", number(std::string(text).erase(point, 1)));
        }
        set("radius: in inches or cm", radius / 25.4);
        set("radius: in inches or cm", radius / 10.0);
        set("not a number", kNaN);
        for (std::size_t k = 0; k < row(i).asphere.size(); ++k) {
            if (const double term = row(i).asphere[k]; term != 0.0) {
                plant("radius: asphere's sign turned", i + 1, "",
                      [&](optics::Prescription& p) { p.surfaces[i].asphere[k] = -term; });
            }
        }
        if (i + 1 < size()) {
            plant("rows swapped", i + 1, "",
                  [&](optics::Prescription& p) { std::swap(p.surfaces[i], p.surfaces[i + 1]); });
        }
    }

    void corrupt_thickness(int i) {
        const double thickness = row(i).thickness_mm;
        const bool moves = !good_.zoom.empty() && good_.zoom.front().gaps_mm.contains(i + 1);
        if (thickness == 0.0 || moves) {
            return;  // of a zoom's moving gaps, the table's own value is overridden
        }
        const auto set = [&](const std::string& kind, double value) {
            plant(kind, i + 1, digits_of(thickness),
                  [&](optics::Prescription& p) { p.surfaces[i].thickness_mm = value; });
        };
        for (const double value : swapped(thickness)) {
            set("thickness: digits swapped", value);
        }
        const std::string text = digits_of(thickness);
        if (const std::size_t point = text.find('.'); point != std::string::npos) {
            set("thickness: decimal point lost", number(std::string(text).erase(point, 1)));
        }
        set("thickness: doubled", 2.0 * thickness);
        set("thickness: negative", -thickness);
        set("thickness: in inches or cm", thickness / 25.4);
        set("thickness: in inches or cm", thickness / 10.0);
        set("not a number", kNaN);
        if (i + 1 == size() || !row(i).semi_diameter_mm || !row(i + 1).semi_diameter_mm || row(i).is_stop ||
            row(i + 1).is_stop) {
            return;
        }
        // As close as the rims forbid: there the surfaces are 5 % of the aperture inside each other.
        const double reach = std::min(*row(i).semi_diameter_mm, *row(i + 1).semi_diameter_mm);
        const double bulge = thickness - check::separation_at(row(i), row(i + 1), reach);
        if (const double gap = bulge - 0.05 * reach; gap > 0.0 && gap < thickness) {
            set("thickness: surfaces crossed", gap);
        }
    }

    void corrupt_semi_diameter(int i) {
        if (row(i).semi_diameter_mm && !row(i).is_stop) {
            plant("one diameter for a semi-diameter", i + 1, "",
                  [&](optics::Prescription& p) { *p.surfaces[i].semi_diameter_mm *= 2.0; });
        }
    }

    void corrupt_glass(int i) {
        const std::optional<optics::Glass> glass = check::stated_glass(row(i), glasses_, good_.preferred_makers);
        if (row(i).medium.is_air() || !glass) {
            return;
        }
        const double n_d = optics::refractive_index(glass->formula, spectral::kLineD);
        const double V_d =
            std::holds_alternative<optics::ConstantIndex>(glass->formula) ? 50.0 : optics::abbe_number(glass->formula);
        const auto set = [&](const std::string& kind, const optics::Glass& other) {
            plant(kind, i + 1, row(i).medium.glass, [&](optics::Prescription& p) {
                optics::StatedMedium& medium = p.surfaces[i].medium;
                const bool by_name = !medium.glass.empty();
                if (by_name) {
                    medium.glass = other.name;
                }
                if (!by_name) {
                    medium.n_d = std::round(optics::refractive_index(other.formula, spectral::kLineD) * 1e5) * 1e-5;
                    medium.V_d = medium.V_d ? std::optional(std::round(optics::abbe_number(other.formula) * 10) * 0.1)
                                            : std::nullopt;
                }
            });
        };
        const std::vector<optics::Glass> by_distance = glasses_.nearest(n_d, V_d, glasses_.glasses().size());
        for (const optics::Glass& other : by_distance) {
            if (other.name != row(i).medium.glass && is_found(other) &&
                std::abs(optics::refractive_index(other.formula, spectral::kLineD) - n_d) > 2e-3) {
                set("glass: the nearest", other);
                break;
            }
        }
        for (const optics::Glass& other : by_distance) {
            if (std::abs(optics::refractive_index(other.formula, spectral::kLineD) - n_d) > 0.08) {
                set("glass: far away", other);
                break;
            }
        }
        for (const optics::PrescribedSurface& other : good_.surfaces) {
            const bool differs = other.medium.glass != row(i).medium.glass || other.medium.n_d != row(i).medium.n_d;
            if (!other.medium.is_air() && differs) {
                plant("glass: another of the lens", i + 1, "",
                      [&](optics::Prescription& p) { p.surfaces[i].medium = other.medium; });
                break;
            }
        }
        if (row(i).medium.n_d && row(i).medium.glass.empty()) {
            for (const double value : swapped(*row(i).medium.n_d)) {
                plant("index: digits swapped", i + 1, digits_of(*row(i).medium.n_d),
                      [&](optics::Prescription& p) { p.surfaces[i].medium.n_d = value; });
            }
        }
        plant("glass: unknown name", i + 1, "", [&](optics::Prescription& p) {
            p.surfaces[i].medium = {};
            p.surfaces[i].medium.glass = "XK7";
        });
    }

    void corrupt_stop() {
        for (int i = 0; i < size(); ++i) {
            if (row(i).is_stop) {
                plant("stop missing", 0, "", [&](optics::Prescription& p) { p.surfaces[i].is_stop = false; });
                if (row(i).is_flat() && size() > 2 && i > 0) {
                    plant("stop missing", 0, "", [&](optics::Prescription& p) {
                        p.surfaces[i - 1].thickness_mm += p.surfaces[i].thickness_mm;
                        p.surfaces.erase(p.surfaces.begin() + i);
                        p.zoom.clear();
                    });
                }
            } else {
                plant("stop doubled", i + 1, "", [&](optics::Prescription& p) { p.surfaces[i].is_stop = true; });
            }
        }
    }

    void corrupt_semi_diameters(const std::string& kind, double factor) {
        plant(kind, 0, "", [&](optics::Prescription& p) {
            for (optics::PrescribedSurface& surface : p.surfaces) {
                if (surface.semi_diameter_mm) {
                    *surface.semi_diameter_mm *= factor;
                }
            }
        });
    }

    void corrupt_lens() {
        for (const double factor : {1.0 / 25.4, 0.1}) {
            plant("all lengths in inches or cm", 0, "", [&](optics::Prescription& p) {
                for (optics::PrescribedSurface& surface : p.surfaces) {
                    surface.radius_mm *= factor;
                    surface.thickness_mm *= factor;
                    if (surface.semi_diameter_mm) {
                        *surface.semi_diameter_mm *= factor;
                    }
                    double scale = 1.0 / factor;  // of r², r⁴, …
                    for (double& term : surface.asphere) {
                        term *= scale;
                        scale /= factor * factor;
                    }
                }
                for (optics::ZoomPosition& position : p.zoom) {
                    for (auto& [at, gap] : position.gaps_mm) {
                        gap *= factor;
                    }
                }
            });
            plant("all thicknesses in inches or cm", 0, "", [&](optics::Prescription& p) {
                for (optics::PrescribedSurface& surface : p.surfaces) {
                    surface.thickness_mm *= factor;
                }
                p.zoom.clear();
            });
            corrupt_semi_diameters("all semi-diameters in inches or cm", factor);
        }
        corrupt_semi_diameters("all diameters for semi-diameters", 2.0);
        plant("list reversed", 0, "", [&](optics::Prescription& p) {
            for (int i = 0; i < size(); ++i) {
                const int from = size() - 1 - i;
                p.surfaces[i] = row(from);
                p.surfaces[i].medium = from > 0 ? row(from - 1).medium : optics::StatedMedium{};
                p.surfaces[i].thickness_mm = from > 0 ? row(from - 1).thickness_mm : row(size() - 1).thickness_mm;
            }
            p.zoom.clear();
        });
    }

    /// Whether its name leads to it, not to another maker's glass.
    [[nodiscard]] bool is_found(const optics::Glass& glass) const {
        const std::optional<optics::Glass> found = glasses_.resolve(glass.name, good_.preferred_makers).glass;
        return found && found->formula == glass.formula;
    }

    const optics::Prescription& good_;
    const optics::GlassCatalogue& glasses_;
    std::vector<Corruption> all_;
};

using Keys = std::map<std::pair<std::string, int>, optics::Severity>;

/// Errors and warnings by code and surface.
Keys keys_of(const check::CheckReport& report) {
    Keys keys;
    for (const optics::Finding& finding : report.findings) {
        if (finding.severity != optics::Severity::info) {
            optics::Severity& worst = keys.try_emplace({finding.code, finding.surface}, finding.severity).first->second;
            worst = std::max(worst, finding.severity);
        }
    }
    return keys;
}

/// The codes that say more of `corrupted` than of the untouched lens.
std::set<std::string> new_codes(const Keys& untouched, const Keys& corrupted) {
    std::set<std::string> codes;
    for (const auto& [key, severity] : corrupted) {
        const auto before = untouched.find(key);
        if (before == untouched.end() || before->second < severity) {
            codes.insert(key.first);
        }
    }
    return codes;
}

/// A lens that is known to be good.
struct GoodLens {
    std::string name;
    optics::Prescription prescription;
    optics::StatedData claims;
    std::size_t every = 1;  // of its corruptions, how many are planted: each, each second, …
};

/// What ships, and beside the checkout, where they are there, patents of photographed products with the focal length
/// that an independent tracer found.
std::vector<GoodLens> good_lenses() {
    std::vector<GoodLens> lenses;
    for (const std::string& name : formats::shipped_lens_names()) {
        lenses.push_back(
            {name, formats::read_prescription(formats::find_lens_file(name)), {}, trials<std::size_t>(2, 6)});
    }
    const std::filesystem::path matched = shared_data() / "matched";
    if (!std::filesystem::exists(matched / "pairs.csv")) {
        return lenses;
    }
    std::map<std::string, double> focal_lengths;
    CsvTable pairs = CsvTable::read(matched / "pairs.csv");
    while (const std::optional<CsvRow> row = pairs.next()) {
        focal_lengths[row->text("prescription")] = row->number("efl_mm");
    }
    for (const auto& [name, focal_length] : focal_lengths) {
        const optics::Prescription product = formats::read_prescription(matched / "prescriptions" / (name + ".csv"));
        if (std::ranges::none_of(product.remarks, [](const optics::Finding& remark) {
                return remark.severity == optics::Severity::error;  // surfaces that are not traced here
            })) {
            lenses.push_back({name, product, {.efl_mm = focal_length}, trials<std::size_t>(7, 21)});
        }
    }
    return lenses;
}

/// What an image shows of a lens: its scale, where it lies, and how sharp it can be.
struct Imaging {
    std::optional<check::Focus> focus;
    double blur = 0.0;  // mm, rms on the axis at the best focus; NaN where no ray passes
};

Imaging imaging_of(const GoodLens& good, const optics::Prescription& prescription,
                   const optics::GlassCatalogue& glasses) {
    const check::CheckedLens checked =
        check::make_checked_lens(optics::at_zoom_position(prescription, 0), good.claims, glasses, {});
    Imaging imaging{.focus = checked.focus, .blur = kNaN};
    if (checked.traced && checked.focus) {
        const double height = check::axial_beam(checked).height;
        const check::AxialSpread spread = check::axial_spread(checked, height);
        imaging.blur = height > 0.0 ? spread.at(spread.best_z()) : kNaN;
    }
    return imaging;
}

/// Whether a change can be seen in images: in their scale, by 1 %; in where they lie, by 0.2 % of the focal length,
/// which at f/2.8 blurs by the customary circle of confusion, 1/1500 of it; or in the sharpest of them, by a blur of
/// that radius.
bool matters(const Imaging& before, const Imaging& after) {
    if (!before.focus || !after.focus || std::isnan(before.blur) || std::isnan(after.blur)) {
        return true;
    }
    const double f = std::abs(before.focus->efl);
    const bool is_same = std::abs(after.focus->efl - before.focus->efl) < 0.01 * f &&
                         std::abs(after.focus->bfl - before.focus->bfl) < 0.002 * f &&
                         std::abs(after.blur - before.blur) < f / 3000.0;
    return !is_same;
}

/// Of one kind. What is named and restored is counted among those that matter.
struct Tally {
    int planted = 0;
    int mattering = 0;
    int found_of_all = 0;
    int found_of_mattering = 0;
    int named_rightly = 0;
    int restored = 0;
};

TEST(PlantedErrors, AreFoundAndTheUntouchedLibraryIsClean) {
    const optics::GlassCatalogue& glasses = formats::shipped_glasses();
    std::map<std::string, Tally> tallies;
    Tally total;
    std::size_t lenses = 0;
    int false_errors = 0;
    const bool verbose = std::getenv("LENSPROOF_LIST_MISSED") != nullptr;
    for (const GoodLens& lens : good_lenses()) {
        const optics::Prescription& good = lens.prescription;
        const std::string& name = lens.name;
        const check::CheckReport untouched = check::check_prescription(good, lens.claims, glasses);
        const Imaging imaging = imaging_of(lens, good, glasses);
        ++lenses;
        false_errors += untouched.ok() ? 0 : 1;
        const Corruptor corruptor(good, glasses);
        for (std::size_t at = lenses % lens.every; at < corruptor.all().size(); at += lens.every) {
            const Corruption& corruption = corruptor.all()[at];
            const check::CheckReport report = check::check_prescription(corruption.prescription, lens.claims, glasses);
            const std::set<std::string> codes = new_codes(keys_of(untouched), keys_of(report));
            const bool mattering = !is_judged_by_images(corruption.kind) || corruption.surface == 0 ||
                                   matters(imaging, imaging_of(lens, corruption.prescription, glasses));
            const bool named = std::ranges::any_of(
                codes, [&](const std::string& code) { return kRightNames.at(corruption.kind).contains(code); });
            const bool restored = std::ranges::any_of(report.findings, [&](const optics::Finding& finding) {
                return finding.code == "suggestion" && finding.surface == corruption.surface &&
                       !corruption.was.empty() &&
                       finding.message.find(" " + corruption.was + " in place") != std::string::npos;
            });
            for (Tally* tally : {&tallies[corruption.kind], &total}) {
                ++tally->planted;
                tally->mattering += mattering ? 1 : 0;
                tally->found_of_all += codes.empty() ? 0 : 1;
                tally->found_of_mattering += mattering && !codes.empty() ? 1 : 0;
                tally->named_rightly += mattering && named ? 1 : 0;
                tally->restored += mattering && restored ? 1 : 0;
            }
            if (verbose && mattering && codes.empty()) {
                fmt::print("missed: {} surface {} {} (was {})\n", name, corruption.surface, corruption.kind,
                           corruption.was);
            }
        }
    }
    const auto print = [](const std::string& kind, const Tally& t) {
        fmt::print("{:36} {:6} {:6.1f} % {:6} {:6.1f} % {:6.1f} % {:6.1f} %\n", kind, t.planted,
                   100.0 * t.found_of_all / t.planted, t.mattering, 100.0 * t.found_of_mattering / t.mattering,
                   100.0 * t.named_rightly / t.mattering, 100.0 * t.restored / t.mattering);
    };
    fmt::print("{:36} {:>6} {:>8} {:>6} {:>8} {:>8} {:>8}\n", "planted in " + std::to_string(lenses) + " lenses", "all",
               "found", "*", "found*", "named*", "undone*");
    for (const auto& [kind, tally] : tallies) {
        print(kind, tally);
    }
    print("total", total);
    fmt::print(
        "*: without those that leave the focal length within 1 %, the back focus within 0.2 % of it and the best blur\n"
        "within 1/3000 of it.\n"
        "named: by a finding that is about such a slip; undone: a suggestion gives the right number back.\n"
        "untouched: {} of {} lenses with an error\n",
        false_errors, lenses);
    double sum_over_kinds = 0.0;
    for (const auto& [kind, tally] : tallies) {
        ASSERT_GT(tally.mattering, 0) << kind;
        const double fraction = static_cast<double>(tally.found_of_mattering) / tally.mattering;
        constexpr int kEnough = 20;  // below, one that is missed weighs more than a twentieth
        if (tally.mattering >= kEnough) {
            // Less two standard errors of so many: of the shipped lenses alone a kind has few.
            EXPECT_GE(fraction, 0.85 - 2.0 * std::sqrt(0.85 * 0.15 / tally.mattering)) << kind;
        }
        sum_over_kinds += fraction;
    }
    EXPECT_GE(sum_over_kinds / static_cast<double>(tallies.size()), 0.95);
    EXPECT_GE(total.found_of_mattering, 0.98 * total.mattering);
    EXPECT_LE(false_errors, 0.02 * static_cast<double>(lenses));
}

}  // namespace lensproof::planted_errors_test
