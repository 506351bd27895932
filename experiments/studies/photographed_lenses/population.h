// experiments/studies/photographed_lenses/population.h — prescriptions against photographs of their products, and
// against those of others.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "calibration/photographed/lensfun_database.h"
#include "experiments/studies/photographed_lenses/measured_comparison.h"

namespace lensproof::studies {

/// A prescription, and the photographed lens that it is the prescription of.
struct LensPair {
    std::string lens;  // one that ships, or a file
    calibration::LensfunQuery photographed;
    std::filesystem::path lensfun_data;  // empty: the system's database
    std::filesystem::path dng;           // not empty: its maker's corrections in place of lensfun's
};

/// Letters, digits and hyphens: prescription, model and crop factor.
std::string pair_id(const LensPair& pair);

/// A wrong prescription, and how far it is from the photographed lens.
struct WrongLens {
    std::string name;
    double residual_um = 0.0;
};

struct PairResult {
    LensPair pair;
    MeasuredComparison comparison;
    std::vector<WrongLens> wrong{};  // nearest first
    std::string doubt{};             // a sentence: which of lens and entry is to be doubted; empty where they agree

    /// The fraction of the wrong ones that are farther away than the right one; nothing where there is none.
    [[nodiscard]] std::optional<double> fraction_beaten() const;
    [[nodiscard]] std::optional<double> residual_um() const;
};

/// Every pair compared, all there is; then its distortion against the other pairs' prescriptions, and against `others`.
/// Those count as wrong that have a focal length within a factor of 1.25, belong to a sensor as large (within 10 %;
/// `others` belong to any), image as far, and are neither listed with that model nor the same design (as many surfaces,
/// and curvatures within 2 % of the strongest). `threads`: 0, one a core. Throws InputError for a lens or an entry that
/// cannot be had.
std::vector<PairResult> compare_pairs(const std::vector<LensPair>& pairs, const std::vector<std::string>& others,
                                      int threads);

/// What the whole says. Fisheyes are left out, whose entries are too poor; µm.
struct PopulationSummary {
    int pairs = 0;
    int wrong = 0;  // comparisons with wrong lenses
    double right_median_um = 0.0;
    double right_median_error_um = 0.0;  // standard, as for a normal distribution's median
    double wrong_median_um = 0.0;
    double wrong_median_error_um = 0.0;
    double beaten_median = 0.0;  // of the pairs with three wrong lenses or more, the fraction that the right one beats
    int ranked = 0;              // those pairs
    double right_within_limit = 0.0;  // shares
    double wrong_within_limit = 0.0;
};
PopulationSummary summarize(const std::vector<PairResult>& results);

}  // namespace lensproof::studies
