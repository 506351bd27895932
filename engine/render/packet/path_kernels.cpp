#include "engine/render/packet/path_kernels.h"

#include <type_traits>

namespace lensproof {

namespace {

/// Each level's functions are asked for where the machine has the level, and not before: they are made of its
/// instructions.
const LevelPathKernels& kernels_at(SimdLevel level) {
#ifdef LENSPROOF_X86_KERNELS
    if (level == SimdLevel::avx512) {
        static const LevelPathKernels avx512 = avx512_path_kernels();
        return avx512;
    }
    if (level == SimdLevel::avx2) {
        static const LevelPathKernels avx2 = avx2_path_kernels();
        return avx2;
    }
#endif
    if (level == SimdLevel::baseline) {
        static const LevelPathKernels baseline = baseline_path_kernels();
        return baseline;
    }
    static const LevelPathKernels scalar = scalar_path_kernels();
    return scalar;
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
