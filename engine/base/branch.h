// engine/base/branch.h — branches on GPUs.
#pragma once

namespace lensproof {

/// Keeps the branch of a rare case one. nvcc would predicate its few operations, and predicated ones take their time
/// whether or not they are done.
constexpr void stay_a_branch() {
#ifdef __CUDA_ARCH__
    __syncwarp(__activemask());
#endif
}

}  // namespace lensproof
