#include "engine/render/camera/packet/path_kernel.h"

namespace lensproof::render {

PathKernels avx2_path_kernels() {
    return path_kernels_of<std::experimental::simd_abi::native<double>>();
}

}  // namespace lensproof::render
