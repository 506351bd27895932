// engine/optics/packet/media.h — the media at a surface for the lanes of a packet.
#pragma once
#include <cstdint>

#include "engine/optics/surface_indices.h"

namespace lensproof::optics {

/// On the two sides of a surface as the rays pass it, and the ratio of their indices as `refract` takes it.
template <class Numbers>
struct Media {
    Numbers ratio;
    Numbers before;
    Numbers after;

    /// `at`: the surface's, by wavelength, of which each lane has its own.
    template <class Scalar>
    static Media of(const SurfaceIndices<Scalar>* at, bool is_forward, const std::uint16_t* wavelength) {
        const auto [before, after, forward_ratio, reverse_ratio] = Numbers::gather_rows(at, wavelength);
        return {.ratio = is_forward ? forward_ratio : reverse_ratio,
                .before = is_forward ? before : after,
                .after = is_forward ? after : before};
    }
    /// Of one for all lanes.
    template <class Scalar>
    static Media of(const SurfaceIndices<Scalar>& at, bool is_forward) {
        return {.ratio = Numbers(is_forward ? at.forward_ratio : at.reverse_ratio),
                .before = Numbers(is_forward ? at.before : at.after),
                .after = Numbers(is_forward ? at.after : at.before)};
    }
};

}  // namespace lensproof::optics
