// engine/render/camera/survivors.h — which of a chunk's samples became paths.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/render/camera/packet/path_chunk.h"

namespace lensproof::render {

/// In their order.
struct Survivors {
    std::array<std::uint16_t, kPathChunk> path;
    int count = 0;

    /// `is_path(i)` of each of so many samples.
    template <class IsPath>
    Survivors(int samples, const IsPath& is_path) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(samples); ++i) {
            path[static_cast<std::size_t>(count)] = static_cast<std::uint16_t>(i);
            count += is_path(i) ? 1 : 0;
        }
    }

    /// Writes what a column has of them to `to`, one after the other.
    template <class From, class To>
    void copy(const From* column, To* to) const {
        for (int k = 0; k < count; ++k) {
            to[k] = column[path[static_cast<std::size_t>(k)]];
        }
    }
};

}  // namespace lensproof::render
