// engine/optics/packet/ghost_kernels.h — the loops of ghost_lanes.h, for each width, as plain functions.
#pragma once
#include "engine/optics/packet/ghost_lanes.h"
#include "engine/optics/packet/trace_kernels.h"

namespace lensproof::optics {

/// A ghost as the loop sees it: plain arrays.
struct KernelGhost {
    const int* reflections = nullptr;
    int count = 0;
    StrayMirrors<double> mirrors;
    double image_z = 0.0;
};

/// `coating_reflectance` of one ray. Not inline, so that it is compiled for any machine.
double lane_coated_reflectance(const SpectralLens<double>& lens, int wavelength, int surface, bool forward,
                               double cos_incidence);

/// `GhostLimit::margin` of one ray, where `WorstLimit` has no ratio; else none. Not inline either.
std::optional<double> lane_limit_margin(const SpectralLens<double>& lens, int surface, Vec2d at, bool by_blades);

struct GhostKernels {
    void (*trace)(const KernelLens<double>& lens, const KernelGhost& ghost, const std::uint16_t* wavelengths,
                  const Ray<double>& ray, GhostLanes& lanes) = nullptr;
    void (*follow)(const KernelLens<double>& lens, const KernelGhost& ghost, FollowedRays& rays) = nullptr;
};

/// Compiled for each level by itself (.ci/rooms.cmake).
template <SimdLevel level>
GhostKernels ghost_kernels_at();

}  // namespace lensproof::optics
