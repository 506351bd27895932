// experiments/cli/picture_measures.h — the numbers of a comparison of pictures, and what is held against their limits.
#pragma once
#include <string>
#include <vector>

#include "calibration/comparison/picture_comparison.h"
#include "experiments/cli/compare_pictures.h"
#include "experiments/findings/verdict.h"

namespace lensproof::cli {

/// A number of the comparison, by its JSON key. `limit`: 0 is none.
struct Measure {
    std::string key;
    std::string title;
    calibration::Estimate estimate;
    double limit = 0.0;
    /// What is held against the limit's, the smaller the better.
    calibration::Estimate fault;
    double largest_fault = 0.0;
    std::string fault_title;

    [[nodiscard]] findings::Check check() const;
};

std::vector<Measure> measures(const calibration::PictureComparison& found, const PictureOptions& options);

}  // namespace lensproof::cli
