#include "engine/optics/packet/trace_batch.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <type_traits>

#include "engine/optics/packet/trace_kernels.h"

namespace lensproof {

namespace {

std::map<SimdLevel, LevelKernels> find_kernels() {
    std::map<SimdLevel, LevelKernels> found{{SimdLevel::scalar, scalar_kernels()},
                                            {SimdLevel::baseline, baseline_kernels()}};
#ifdef LENSPROOF_X86_KERNELS
    if (__builtin_cpu_supports("avx2")) {
        found.emplace(SimdLevel::avx2, avx2_kernels());
    }
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vl")) {
        found.emplace(SimdLevel::avx512, avx512_kernels());
    }
#endif
    return found;
}

const std::map<SimdLevel, LevelKernels>& kernels() {
    static const std::map<SimdLevel, LevelKernels> found = find_kernels();
    return found;
}

template <class T>
const TraceKernels<T>& kernels_of(std::optional<SimdLevel> level) {
    const auto entry = level ? kernels().find(*level) : std::prev(kernels().end());
    if (entry == kernels().end()) {
        throw std::invalid_argument(std::string("this machine has no ") + simd_name(*level));
    }
    if constexpr (std::is_same_v<T, float>) {
        return entry->second.in_float;
    } else {
        return entry->second.in_double;
    }
}

}  // namespace

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
    std::vector<SimdLevel> levels;
    std::ranges::transform(kernels(), std::back_inserter(levels), [](const auto& entry) { return entry.first; });
    return levels;
}

template <class T>
T lane_open_share(const SpectralLens<T>& lens, int surface, T x, T y) {
    const TraceLens<T>& any = lens.at().front();
    const TraceSurface<T>& stop = any.surfaces[static_cast<std::size_t>(surface)];
    return open_share(stop, any.specials[static_cast<std::size_t>(stop.special)], x, y);
}

template <class T>
T lane_coated_share(const SpectralLens<T>& lens, int wavelength, int surface, bool forward, T cos_incidence,
                    T cos_refraction) {
    const TraceLens<T>& at = lens.at(wavelength);
    const TraceSurface<T>& coated = at.surfaces[static_cast<std::size_t>(surface)];
    return coated_share(coated, at.specials[static_cast<std::size_t>(coated.special)], forward, cos_incidence,
                        cos_refraction);
}

template float lane_open_share(const SpectralLens<float>&, int, float, float);
template double lane_open_share(const SpectralLens<double>&, int, double, double);
template float lane_coated_share(const SpectralLens<float>&, int, int, bool, float, float);
template double lane_coated_share(const SpectralLens<double>&, int, int, bool, double, double);

template <Direction direction, class T>
void trace_batch(const SpectralLens<T>& lens, RayBatch<T>& rays, const BatchSettings& settings) {
    const std::vector<TraceSurface<T>>& surfaces = lens.at().front().surfaces;
    const KernelLens<T> plain_lens{.surfaces = surfaces.data(),
                                   .indices = lens.indices().data(),
                                   .specials = lens.at().front().specials.data(),
                                   .lens = &lens,
                                   .count = static_cast<int>(surfaces.size()),
                                   .is_monochromatic = lens.wavelengths() == 1};
    const KernelRays<T> plain_rays{.x = rays.origin.x.data(),
                                   .y = rays.origin.y.data(),
                                   .z = rays.origin.z.data(),
                                   .dx = rays.direction.x.data(),
                                   .dy = rays.direction.y.data(),
                                   .dz = rays.direction.z.data(),
                                   .optical_path = rays.optical_path.data(),
                                   .transmittance = rays.transmittance.data(),
                                   .wavelength = rays.wavelength.data(),
                                   .status = rays.status.data(),
                                   .surface = rays.surface.data(),
                                   .size = rays.size};
    const auto& loops = kernels_of<T>(settings.level)[static_cast<std::size_t>(direction)];
    loops[static_cast<std::size_t>(settings.carry)](plain_lens, plain_rays, settings.rims == Rims::clip);
}

template void trace_batch<Direction::forward>(const SpectralLens<float>&, RayBatch<float>&, const BatchSettings&);
template void trace_batch<Direction::reverse>(const SpectralLens<float>&, RayBatch<float>&, const BatchSettings&);
template void trace_batch<Direction::forward>(const SpectralLens<double>&, RayBatch<double>&, const BatchSettings&);
template void trace_batch<Direction::reverse>(const SpectralLens<double>&, RayBatch<double>&, const BatchSettings&);

}  // namespace lensproof
