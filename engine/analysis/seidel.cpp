#include "engine/analysis/seidel.h"

namespace lensproof::analysis {

template std::optional<SeidelSums<double>> seidel_sums(const optics::TraceLens<double>&,
                                                       const optics::TraceLens<double>&,
                                                       const optics::TraceLens<double>&, const double&, const double&);

}  // namespace lensproof::analysis
