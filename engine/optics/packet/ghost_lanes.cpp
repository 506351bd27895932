#include "engine/optics/packet/ghost_lanes.h"

#include "engine/optics/packet/ghost_kernels.h"

namespace lensproof::optics {

namespace {

const LoopsByLevel<GhostKernels>& ghost_kernels() {
    static const LoopsByLevel<GhostKernels> found([]<SimdLevel level>() { return ghost_kernels_at<level>(); });
    return found;
}

KernelGhost kernel_ghost(const SpectralLens<double>& lens, const GhostPath& path, const StrayMirrors<double>& mirrors) {
    return {.reflections = path.data(),
            .count = static_cast<int>(path.size()),
            .mirrors = mirrors,
            .image_z = lens.at().front().image_z};
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
    ghost_kernels().at(level).trace(kernel_lens(lens), kernel_ghost(lens, path, mirrors), wavelengths.data(), ray,
                                    lanes);
    return lanes;
}

std::optional<double> lane_limit_margin(const SpectralLens<double>& lens, int surface, Vec2d at, bool by_blades) {
    const TraceLens<double>& first = lens.at().front();
    const TraceSurface<double>& limiting = first.surfaces[static_cast<std::size_t>(surface)];
    const GhostLimit limit = ghost_limit(limiting, special_of(first, limiting), at, by_blades);
    return by_blades || limit.edge_margin > -1.0 ? std::optional(limit.margin()) : std::nullopt;
}

void follow_ghost_rays(const SpectralLens<double>& lens, const GhostPath& path, const StrayMirrors<double>& mirrors,
                       FollowedRays& rays, std::optional<SimdLevel> level) {
    ghost_kernels().at(level).follow(kernel_lens(lens), kernel_ghost(lens, path, mirrors), rays);
}

}  // namespace lensproof::optics
