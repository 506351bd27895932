#include "engine/polynomial/polynomial_kernels.h"

namespace lensproof::polynomial {

const PolynomialKernels& polynomial_kernels(std::optional<SimdLevel> level) {
    static const LoopsByLevel<PolynomialKernels> found(
        []<SimdLevel level>() { return polynomial_kernels_at<level>(); });
    return found.at(level);
}

}  // namespace lensproof::polynomial
