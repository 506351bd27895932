#include "engine/render/camera/packet/path_kernels.h"

namespace lensproof::render {

const PathKernels& path_kernels(std::optional<SimdLevel> level) {
    static const LoopsByLevel<PathKernels> found{
        {SimdLevel::scalar, scalar_path_kernels},
        {SimdLevel::baseline, baseline_path_kernels},
#ifdef LENSPROOF_X86_KERNELS
        {SimdLevel::avx2, avx2_path_kernels},
        {SimdLevel::avx512, avx512_path_kernels},
#endif
    };
    return found.at(level);
}

}  // namespace lensproof::render
