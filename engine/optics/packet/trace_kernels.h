// engine/optics/packet/trace_kernels.h — the packet tracer's inner loops, one for each width, as plain functions.
#pragma once
#include <array>

#include "engine/optics/packet/spectral_lens.h"
#include "engine/optics/packet/trace_batch.h"

namespace lensproof::optics {

/// A lens as the inner loop sees it: plain arrays.
template <class T>
struct KernelLens {
    const TraceSurface<T>* surfaces = nullptr;
    const typename SpectralLens<T>::Indices* indices = nullptr;  // a surface
    const SpecialSurface<T>* specials = nullptr;
    const SpectralLens<T>* lens = nullptr;  // for what is done ray by ray
    int count = 0;
    int wavelengths = 1;
    bool absorbs = false;

    /// `wavelength` of the rays is then not looked at.
    [[nodiscard]] bool is_monochromatic() const { return wavelengths == 1; }
};

template <class T>
KernelLens<T> kernel_lens(const SpectralLens<T>& lens);

/// `mask_transmittance`, `coated_transmittance` and `fading` of one ray, and its thin element. Not inline, so that they
/// are compiled for any machine.
template <class T>
T lane_mask_transmittance(const SpectralLens<T>& lens, int surface, T x, T y);
template <class T>
T lane_coated_transmittance(const SpectralLens<T>& lens, int wavelength, int surface, bool forward, T cos_incidence);

template <class T>
const ThinElement<T>& lane_thin_element(const SpectralLens<T>& lens, int wavelength, int surface);

template <class T>
T lane_fading(T optical_depth);

template <class T>
using TraceKernel = void (*)(const KernelLens<T>& lens, const RayColumns<T>& rays, bool clip);

/// The inner loops of one level by Direction and Carry.
template <class T>
using TraceKernels = std::array<std::array<TraceKernel<T>, 3>, 2>;

/// Of one level.
struct LevelKernels {
    TraceKernels<float> in_float;
    TraceKernels<double> in_double;
};
/// Compiled for each level by itself (.ci/rooms.cmake).
template <SimdLevel level>
LevelKernels trace_kernels_at();

}  // namespace lensproof::optics
