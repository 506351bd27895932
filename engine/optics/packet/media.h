// engine/optics/packet/media.h — the media at a surface for the lanes of a packet.
#pragma once
#include "engine/optics/packet/by_wavelength.h"
#include "engine/optics/surface_indices.h"

namespace lensproof::optics {

/// On the two sides of a surface as the rays pass it, and the ratio of their indices as `refract` takes it.
template <class Numbers>
struct Media {
    Numbers ratio;
    Numbers before;
    Numbers after;

    /// `at`: the surface's, by wavelength.
    template <class Scalar, bool per_lane>
    static Media of(const SurfaceIndices<Scalar>* at, bool is_forward, const ByWavelength<Numbers, per_lane>& lanes) {
        const auto [before, after, forward_ratio, reverse_ratio] = lanes.row(at);
        return {.ratio = is_forward ? forward_ratio : reverse_ratio,
                .before = is_forward ? before : after,
                .after = is_forward ? after : before};
    }
};

}  // namespace lensproof::optics
