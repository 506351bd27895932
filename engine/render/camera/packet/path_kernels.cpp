#include "engine/render/camera/packet/path_kernels.h"

namespace lensproof::render {

const PathKernels& path_kernels(std::optional<optics::SimdLevel> level) {
    static const optics::LoopsByLevel<PathKernels> found{
        {optics::SimdLevel::scalar, scalar_path_kernels},
        {optics::SimdLevel::baseline, baseline_path_kernels},
#ifdef LENSPROOF_X86_KERNELS
        {optics::SimdLevel::avx2, avx2_path_kernels},
        {optics::SimdLevel::avx512, avx512_path_kernels},
#endif
    };
    return found.at(level);
}

}  // namespace lensproof::render
