// engine/optics/packet/ghost_kernels.h — the loop of ghost_lanes.h, one for each width, as a plain function.
#pragma once
#include "engine/optics/packet/ghost_lanes.h"
#include "engine/optics/packet/trace_kernels.h"

namespace lensproof::optics {

/// A ghost as the loop sees it: plain arrays.
struct GhostWay {
    const int* reflections = nullptr;
    int count = 0;
    const std::uint16_t* wavelengths = nullptr;
    Ray<double> ray;
    StrayMirrors<double> mirrors;
    double image_z = 0.0;
};

/// `coating_reflectance` of one ray. Not inline, so that it is compiled for any machine.
double lane_coated_reflectance(const SpectralLens<double>& lens, int wavelength, int surface, bool forward,
                               double cos_incidence);

using GhostKernel = void (*)(const KernelLens<double>& lens, const GhostWay& way, GhostLanes& lanes);

/// Per level.
GhostKernel scalar_ghost_kernel();
GhostKernel baseline_ghost_kernel();
GhostKernel avx2_ghost_kernel();    // x86-64 alone
GhostKernel avx512_ghost_kernel();  // x86-64 alone

}  // namespace lensproof::optics
