// engine/render/integrators/pixel_paths.h — the samples of a tile, for paths that do not begin in the lens's buffers.
#pragma once
#include <cstdint>

#include "engine/render/integrators/view.h"
#include "engine/render/sampling/path_sampler.h"

namespace lensproof::render {

/// Calls `trace(x, y, sample, path, numbers)` for each sample of each pixel: with its wavelengths, the hero drawn
/// evenly, and the numbers that are left.
template <class Trace>
void for_each_path(const View& view, std::uint64_t seed, const TileSamples& samples, const Trace& trace) {
    const PixelRect& rect = samples.rect;
    const spectral::SpectralGrid& grid = view.camera->grid();
    for (int y = rect.y; y < rect.y + rect.height; ++y) {
        for (int x = rect.x; x < rect.x + rect.width; ++x) {
            const auto pixel = static_cast<std::uint32_t>(y * view.camera->sensor().width + x);
            for (std::uint32_t sample = samples.first; sample < samples.end; ++sample) {
                PathSampler numbers(seed, pixel, sample);
                const spectral::PathWavelengths path = grid.path(static_cast<int>(numbers.next()[0] * grid.size()));
                trace(x, y, sample, path, numbers);
            }
        }
    }
}

}  // namespace lensproof::render
