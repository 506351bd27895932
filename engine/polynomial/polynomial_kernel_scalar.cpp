#include "engine/polynomial/polynomial_kernel.h"

namespace lensproof::polynomial {

PolynomialKernels scalar_polynomial_kernels() {
    return polynomial_kernels_of<std::experimental::simd_abi::scalar>();
}

}  // namespace lensproof::polynomial
