#include "engine/render/packet/path_kernels.h"

#include <type_traits>

namespace lensproof {

namespace {

const LevelPathKernels& kernels_at(SimdLevel level) {
    static const LevelPathKernels scalar = scalar_path_kernels();
    static const LevelPathKernels baseline = baseline_path_kernels();
#ifdef LENSPROOF_X86_KERNELS
    static const LevelPathKernels avx2 = avx2_path_kernels();
    static const LevelPathKernels avx512 = avx512_path_kernels();
    if (level == SimdLevel::avx2) {
        return avx2;
    }
    if (level == SimdLevel::avx512) {
        return avx512;
    }
#endif
    return level == SimdLevel::scalar ? scalar : baseline;
}

}  // namespace

template <class T>
const PathKernels<T>& path_kernels(SimdLevel level) {
    if constexpr (std::is_same_v<T, float>) {
        return kernels_at(level).in_float;
    } else {
        return kernels_at(level).in_double;
    }
}

template const PathKernels<float>& path_kernels<float>(SimdLevel);
template const PathKernels<double>& path_kernels<double>(SimdLevel);

}  // namespace lensproof
