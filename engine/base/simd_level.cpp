#include "engine/base/simd_level.h"

#include <array>

namespace lensproof {

const char* simd_name(SimdLevel level) {
    constexpr std::array kNames = {"scalar", "baseline", "avx2", "avx512"};
    return kNames[static_cast<std::size_t>(level)];
}

std::vector<SimdLevel> available_simd_levels() {
    std::vector<SimdLevel> levels{SimdLevel::scalar, SimdLevel::baseline};
#ifdef LENSPROOF_X86_KERNELS
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {  // fma: for LENSPROOF_FUSED
        levels.push_back(SimdLevel::avx2);
    }
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vl")) {
        levels.push_back(SimdLevel::avx512);
    }
#endif
    return levels;
}

}  // namespace lensproof
