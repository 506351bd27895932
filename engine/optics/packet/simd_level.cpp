#include "engine/optics/packet/simd_level.h"

namespace lensproof::optics {

const char* simd_name(SimdLevel level) {
    switch (level) {
        case SimdLevel::scalar:
            return "scalar";
        case SimdLevel::baseline:
            return "baseline";
        case SimdLevel::avx2:
            return "avx2";
        case SimdLevel::avx512:
            return "avx512";
    }
    return "unknown";
}

std::vector<SimdLevel> available_simd_levels() {
    std::vector<SimdLevel> levels{SimdLevel::scalar, SimdLevel::baseline};
#ifdef LENSPROOF_X86_KERNELS
    if (__builtin_cpu_supports("avx2")) {
        levels.push_back(SimdLevel::avx2);
    }
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vl")) {
        levels.push_back(SimdLevel::avx512);
    }
#endif
    return levels;
}

}  // namespace lensproof::optics
