// experiments/studies/photographed_lenses/photographed_plots.h — drawings of prescriptions against photographs.
#pragma once
#include <string>
#include <vector>

#include "experiments/studies/photographed_lenses/population.h"

namespace lensproof::studies {

inline constexpr double kPhotographedChartWidth = 760.0;
inline constexpr double kPhotographedChartHeight = 460.0;

/// Right and wrong prescriptions' residuals, each as the fraction of them that is smaller.
std::string population_chart(const std::vector<PairResult>& results);

/// A pair's distortion, photographed and simulated, over the image height.
std::string pair_chart(const PairResult& result);

}  // namespace lensproof::studies
