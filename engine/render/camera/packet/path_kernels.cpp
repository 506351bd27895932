#include "engine/render/camera/packet/path_kernels.h"

#include <type_traits>

namespace lensproof::render {

namespace {

const optics::LoopsByLevel<LevelPathKernels>& kernels() {
    static const optics::LoopsByLevel<LevelPathKernels> found{
        {optics::SimdLevel::scalar, scalar_path_kernels},
        {optics::SimdLevel::baseline, baseline_path_kernels},
#ifdef LENSPROOF_X86_KERNELS
        {optics::SimdLevel::avx2, avx2_path_kernels},
        {optics::SimdLevel::avx512, avx512_path_kernels},
#endif
    };
    return found;
}

}  // namespace

template <class T>
const PathKernels<T>& path_kernels(std::optional<optics::SimdLevel> level) {
    if constexpr (std::is_same_v<T, float>) {
        return kernels().at(level).in_float;
    } else {
        return kernels().at(level).in_double;
    }
}

template const PathKernels<float>& path_kernels<float>(std::optional<optics::SimdLevel>);
template const PathKernels<double>& path_kernels<double>(std::optional<optics::SimdLevel>);

}  // namespace lensproof::render
