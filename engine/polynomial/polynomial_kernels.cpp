#include "engine/polynomial/polynomial_kernels.h"

namespace lensproof::polynomial {

const PolynomialKernels& polynomial_kernels(std::optional<SimdLevel> level) {
    static const LoopsByLevel<PolynomialKernels> found{
        {SimdLevel::scalar, scalar_polynomial_kernels},
        {SimdLevel::baseline, baseline_polynomial_kernels},
#ifdef LENSPROOF_X86_KERNELS
        {SimdLevel::avx2, avx2_polynomial_kernels},
        {SimdLevel::avx512, avx512_polynomial_kernels},
#endif
    };
    return found.at(level);
}

}  // namespace lensproof::polynomial
