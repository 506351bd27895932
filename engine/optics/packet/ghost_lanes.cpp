#include "engine/optics/packet/ghost_lanes.h"

#include "engine/optics/packet/ghost_kernels.h"

namespace lensproof::optics {

namespace {

const LoopsByLevel<GhostKernel>& ghost_kernels() {
    static const LoopsByLevel<GhostKernel> found{
        {SimdLevel::scalar, scalar_ghost_kernel},
        {SimdLevel::baseline, baseline_ghost_kernel},
#ifdef LENSPROOF_X86_KERNELS
        {SimdLevel::avx2, avx2_ghost_kernel},
        {SimdLevel::avx512, avx512_ghost_kernel},
#endif
    };
    return found;
}

}  // namespace

double lane_coated_reflectance(const SpectralLens<double>& lens, int wavelength, int surface, bool forward,
                               double cos_incidence) {
    const TraceLens<double>& at = lens.at(wavelength);
    const TraceSurface<double>& coated = at.surfaces[static_cast<std::size_t>(surface)];
    return coating_reflectance(at.specials[static_cast<std::size_t>(coated.special)].coating, coated.index_before,
                               coated.index_after, cos_incidence, forward);
}

GhostLanes trace_ghost_lanes(const SpectralLens<double>& lens, std::span<const std::uint16_t, kGhostLanes> wavelengths,
                             const GhostPath& path, const Ray<double>& ray, const StrayMirrors<double>& mirrors,
                             std::optional<SimdLevel> level) {
    GhostLanes lanes;
    ghost_kernels().at(level)(kernel_lens(lens),
                              {.reflections = path.data(),
                               .count = static_cast<int>(path.size()),
                               .wavelengths = wavelengths.data(),
                               .ray = ray,
                               .mirrors = mirrors,
                               .image_z = lens.at().front().image_z},
                              lanes);
    return lanes;
}

}  // namespace lensproof::optics
