#include "engine/polynomial/polynomial_kernel.h"

namespace lensproof::polynomial {

PolynomialKernels avx2_polynomial_kernels() {
    return polynomial_kernels_of<std::experimental::simd_abi::native<double>>();
}

}  // namespace lensproof::polynomial
