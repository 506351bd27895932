#include "experiments/studies/photographed_lenses/population.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>

#include "calibration/photographed/dng_corrections.h"
#include "engine/base/infinity.h"
#include "engine/base/order_statistics.h"
#include "engine/base/parallel.h"
#include "engine/base/text.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::studies {

namespace {

constexpr double kLikeFocal = 1.25;  // a factor
constexpr double kLikeFormat = 0.9;  // of the half-diagonal
constexpr double kLikeReach = 0.95;  // of what the right prescription reaches
constexpr double kSameCurve = 0.02;  // of the strongest curvature
constexpr std::size_t kEnoughWrong = 3;
constexpr double kMedianError = 1.2533;  // standard error of a normal sample's median over σ/√n

/// A prescription of the list, with all that comparisons need of it.
struct Candidate {
    std::string file;
    optics::Lens lens;
    double focal_mm = 0.0;
    calibration::ImagedField field{};
    double half_diagonal_mm = 0.0;      // of the largest sensor that it is listed with
    std::vector<std::string> models{};  // that it is listed with, in small letters
};

double focal_length(const optics::Lens& lens) {
    return optics::paraxial_data(optics::at_wavelength<double>(lens, spectral::kLineD)).efl;
}

bool is_same_design(const Candidate& a, const Candidate& b) {
    if (a.lens.surfaces.size() != b.lens.surfaces.size()) {
        return false;
    }
    double strongest = 0.0;
    for (const optics::LensSurface& surface : a.lens.surfaces) {
        strongest = std::max(strongest, std::abs(surface.curvature) * a.focal_mm);
    }
    return std::ranges::equal(
        a.lens.surfaces, b.lens.surfaces, [&](const optics::LensSurface& one, const optics::LensSurface& other) {
            return std::abs(one.curvature * a.focal_mm - other.curvature * b.focal_mm) <= kSameCurve * strongest;
        });
}

std::vector<Candidate> candidates_of(const std::vector<LensPair>& pairs, const std::vector<std::string>& others) {
    std::vector<Candidate> candidates;
    const auto add = [&](const std::string& lens, double half_diagonal_mm) {
        if (std::ranges::find(candidates, lens, &Candidate::file) == candidates.end()) {
            Candidate candidate{.file = lens, .lens = focused_for_photographs(formats::load_lens(lens))};
            candidate.focal_mm = focal_length(candidate.lens);
            candidate.half_diagonal_mm = half_diagonal_mm;
            candidates.push_back(std::move(candidate));
        }
    };
    for (const LensPair& pair : pairs) {
        add(pair.lens, 0.0);
    }
    for (const std::string& lens : others) {
        add(lens, kInfinity);
    }
    return candidates;
}

bool is_wrong(const Candidate& other, const Candidate& right, const PairResult& result) {
    const calibration::PhotographedLens& photographed = result.comparison.photographed;
    const double factor = other.focal_mm / right.focal_mm;
    return &other != &right && factor <= kLikeFocal && factor >= 1.0 / kLikeFocal &&
           other.half_diagonal_mm >= kLikeFormat * photographed.half_diagonal_mm() &&
           std::ranges::find(other.models, lower_case(result.pair.photographed.model)) == other.models.end() &&
           !is_same_design(other, right);
}

void compare_with_wrong(const std::vector<Candidate>& candidates, const Candidate& right, PairResult& result) {
    if (!result.comparison.distortion) {
        return;
    }
    for (const Candidate& other : candidates) {
        if (!is_wrong(other, right, result)) {
            continue;
        }
        const auto found = calibration::distortion_agreement(result.comparison.photographed, other.field);
        if (found && found->reach >= kLikeReach * result.comparison.distortion->reach) {
            result.wrong.push_back({.name = other.lens.name, .residual_um = found->residual.rms_um});
        }
    }
    std::ranges::sort(result.wrong, {}, &WrongLens::residual_um);
}

/// Which of the two is to be doubted where a right prescription is beyond the limit, as far as numbers show it.
std::string doubt_of(const PairResult& result, const std::vector<PairResult>& all) {
    const MeasuredComparison& comparison = result.comparison;
    const auto residual = result.residual_um();
    if (!residual || *residual <= comparison.judgement.limit_um) {
        return {};
    }
    if (comparison.photographed.projection != optics::Projection::rectilinear) {
        return "The entry: lensfun's fisheyes are all this far off.";
    }
    const auto agrees = std::ranges::find_if(all, [&](const PairResult& other) {
        return other.pair.lens == result.pair.lens && other.residual_um() &&
               *other.residual_um() <= other.comparison.judgement.limit_um &&
               other.comparison.photographed_departure_um > other.comparison.judgement.limit_um;
    });
    if (agrees != all.end()) {
        return fmt::format("The entry: the same prescription is {:.1f} µm from \"{}\" at crop factor {:.4g}.",
                           *agrees->residual_um(), agrees->comparison.photographed.model,
                           agrees->comparison.photographed.crop_factor);
    }
    if (comparison.photographed_departure_um < comparison.judgement.limit_um &&
        comparison.simulated_departure_um > 2.0 * comparison.judgement.limit_um) {
        return fmt::format(
            "The entry: its pictures have next to no distortion where the lens has {:.0f} µm, as when the camera had "
            "corrected them.",
            comparison.simulated_departure_um);
    }
    if (!result.wrong.empty() && result.wrong.front().residual_um <= comparison.judgement.limit_um) {
        return fmt::format(
            "The pairing: the entry is within the limit of another lens, {} ({:.1f} µm), so the lens that was sold may "
            "not be the patent's example.",
            result.wrong.front().name, result.wrong.front().residual_um);
    }
    if (result.wrong.size() >= kEnoughWrong && result.wrong.front().residual_um > *residual) {
        return fmt::format(
            "Either, in amount: none of {} other lenses is nearer, but its {:.0f} µm of distortion differ by {:.0f} %.",
            result.wrong.size(), comparison.photographed_departure_um,
            100.0 * *residual / comparison.photographed_departure_um);
    }
    return "Either: no number here tells which.";
}

double median_error(const std::vector<double>& values, double middle) {
    std::vector<double> deviations;
    std::ranges::transform(values, std::back_inserter(deviations),
                           [&](double value) { return std::abs(value - middle); });
    return kMedianError * kSigmaPerMedian * median(deviations) / std::sqrt(static_cast<double>(values.size()));
}

using Databases = std::map<std::filesystem::path, calibration::LensfunDatabase>;

calibration::PhotographedLens photographed_of(const LensPair& pair, double focal_length_mm, Databases& databases) {
    if (!pair.dng.empty()) {
        return calibration::read_dng_corrections(pair.dng, pair.photographed.crop_factor);
    }
    if (!databases.contains(pair.lensfun_data)) {
        databases.emplace(pair.lensfun_data, pair.lensfun_data.empty()
                                                 ? calibration::LensfunDatabase::of_system()
                                                 : calibration::LensfunDatabase::read(pair.lensfun_data));
    }
    calibration::LensfunQuery query = pair.photographed;
    query.focal_length_mm = focal_length_mm;
    return databases.at(pair.lensfun_data).find(query);
}

}  // namespace

std::string pair_id(const LensPair& pair) {
    std::string id = std::filesystem::path(pair.lens).stem().string() + " " + pair.photographed.model;
    if (pair.photographed.crop_factor) {
        id += fmt::format(" crop {:.4g}", *pair.photographed.crop_factor);
    }
    if (pair.photographed.projection && *pair.photographed.projection != optics::Projection::rectilinear) {
        id += std::string(" ") + optics::projection_name(*pair.photographed.projection);
    }
    std::string words;
    for (const char c : lower_case(id)) {
        if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
            words += c;
        } else if (!words.empty() && words.back() != '-') {
            words += '-';
        }
    }
    return words;
}

std::optional<double> PairResult::residual_um() const {
    return comparison.distortion ? std::optional(comparison.distortion->residual.rms_um) : std::nullopt;
}

std::optional<double> PairResult::fraction_beaten() const {
    const std::optional<double> right = residual_um();
    if (!right || wrong.empty()) {
        return std::nullopt;
    }
    const auto farther =
        std::ranges::count_if(wrong, [&](const WrongLens& other) { return other.residual_um > *right; });
    return static_cast<double>(farther) / static_cast<double>(wrong.size());
}

std::vector<PairResult> compare_pairs(const std::vector<LensPair>& pairs, const std::vector<std::string>& others,
                                      int threads) {
    std::vector<Candidate> candidates = candidates_of(pairs, others);
    Databases databases;
    std::vector<PairResult> results;
    double largest_mm = 0.0;
    for (const LensPair& pair : pairs) {
        Candidate& right = *std::ranges::find(candidates, pair.lens, &Candidate::file);
        PairResult result{.pair = pair,
                          .comparison = {.photographed = photographed_of(pair, right.focal_mm, databases), .lens = {}}};
        const double half_diagonal = result.comparison.photographed.half_diagonal_mm();
        right.half_diagonal_mm = std::max(right.half_diagonal_mm, half_diagonal);
        right.models.push_back(lower_case(pair.photographed.model));
        largest_mm = std::max(largest_mm, half_diagonal);
        results.push_back(std::move(result));
    }
    parallel_for(static_cast<int>(candidates.size()), threads, [&](int i) {
        Candidate& candidate = candidates[static_cast<std::size_t>(i)];
        candidate.field =
            calibration::imaged_field(candidate.lens, calibration::camera_wavelengths(candidate.lens), largest_mm, 240);
    });
    parallel_for(static_cast<int>(results.size()), threads, [&](int i) {
        PairResult& result = results[static_cast<std::size_t>(i)];
        const Candidate& right = *std::ranges::find(candidates, result.pair.lens, &Candidate::file);
        result.comparison = compare_with_photographed(right.lens, result.comparison.photographed, std::nullopt);
        compare_with_wrong(candidates, right, result);
    });
    for (PairResult& result : results) {
        result.doubt = doubt_of(result, results);
    }
    return results;
}

PopulationSummary summarize(const std::vector<PairResult>& results) {
    std::vector<double> right;
    std::vector<double> wrong;
    std::vector<double> beaten;
    PopulationSummary summary;
    for (const PairResult& result : results) {
        const auto residual = result.residual_um();
        if (!residual || result.comparison.photographed.projection != optics::Projection::rectilinear) {
            continue;
        }
        const double limit = result.comparison.judgement.limit_um;
        right.push_back(*residual);
        summary.right_within_limit += *residual <= limit ? 1.0 : 0.0;
        for (const WrongLens& other : result.wrong) {
            wrong.push_back(other.residual_um);
            summary.wrong_within_limit += other.residual_um <= limit ? 1.0 : 0.0;
        }
        if (result.wrong.size() >= kEnoughWrong) {
            beaten.push_back(*result.fraction_beaten());
        }
    }
    summary.pairs = static_cast<int>(right.size());
    summary.wrong = static_cast<int>(wrong.size());
    summary.ranked = static_cast<int>(beaten.size());
    if (!right.empty()) {
        summary.right_within_limit /= static_cast<double>(right.size());
        summary.right_median_um = median(right);
        summary.right_median_error_um = median_error(right, summary.right_median_um);
    }
    if (!wrong.empty()) {
        summary.wrong_within_limit /= static_cast<double>(wrong.size());
        summary.wrong_median_um = median(wrong);
        summary.wrong_median_error_um = median_error(wrong, summary.wrong_median_um);
    }
    if (!beaten.empty()) {
        summary.beaten_median = median(beaten);
    }
    return summary;
}

}  // namespace lensproof::studies
