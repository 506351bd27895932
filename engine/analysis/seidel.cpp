#include "engine/analysis/seidel.h"

namespace lensproof {

template std::optional<SeidelSums<double>> seidel_sums(const TraceLens<double>&, const TraceLens<double>&,
                                                       const TraceLens<double>&, const double&, const double&);

}  // namespace lensproof
