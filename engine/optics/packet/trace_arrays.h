// engine/optics/packet/trace_arrays.h — the tracer for any number of rays that lie in someone else's arrays.
#pragma once
#include <cstddef>
#include <cstring>

#include "engine/optics/packet/trace_batch.h"

namespace lensproof::optics {

/// Doubles in someone else's memory, `stride` bytes from one to the next, of any alignment.
struct NumberColumn {
    const char* first;
    std::ptrdiff_t stride;

    double operator[](std::size_t i) const {
        double number = 0.0;
        std::memcpy(&number, first + static_cast<std::ptrdiff_t>(i) * stride, sizeof(number));
        return number;
    }
};

/// Rays as they are given: mm in lens space, and directions of any length but 0.
struct RayArrays {
    NumberColumn x;
    NumberColumn y;
    NumberColumn z;
    NumberColumn dx;
    NumberColumn dy;
    NumberColumn dz;
    std::size_t size;
};

/// `trace` for each of the rays, on up to `threads` threads (0: one a core), into the columns of `traced`, whose `size`
/// is not looked at. Directions are made unit vectors with the bits that `normalized` gives. Throws InputError for a
/// number that is not finite or beyond ±1e15 mm, and a direction of length 0; Stopped as `parallel_for` does.
template <Direction direction = Direction::forward>
void trace_arrays(const SpectralLens<double>& lens, const RayArrays& given, const RayColumns<double>& traced,
                  const BatchSettings& settings = {}, int threads = 0);

}  // namespace lensproof::optics
