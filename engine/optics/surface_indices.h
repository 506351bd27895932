// engine/optics/surface_indices.h — a surface's refractive indices at one wavelength, as batches of rays look them up.
#pragma once

namespace lensproof::optics {

/// They lie together, so that one read of memory finds them all. The media as light from the scene passes them; the
/// ratios as TraceSurface has them.
template <class T>
struct alignas(4 * sizeof(T)) SurfaceIndices {
    T before;
    T after;
    T forward_ratio;
    T reverse_ratio;
};

}  // namespace lensproof::optics
