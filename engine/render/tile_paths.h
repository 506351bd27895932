// engine/render/tile_paths.h — the camera paths of a tile's samples, one after the other.
#pragma once
#include <cstddef>
#include <cstdint>

#include "engine/render/camera_paths.h"
#include "engine/render/progressive.h"

namespace lensproof::render {

/// Calls filled() for each buffer of these samples' paths, and add(path, pixel) for each path in it, `path` being its
/// place in `buffer` and `pixel` its pixel's in the tile; counts rays in the tile. `producer` draws for a sensor of
/// `width` pixels a row.
template <class Producer, class Filled, class Add>
void for_each_path(const TileSamples& samples, int width, Producer& producer, CameraPathBuffer<double>& buffer,
                   FilmTile& tile, const Filled& filled, const Add& add) {
    const PixelRect& rect = samples.rect;
    const std::int64_t started_before = producer.started();
    for (int y = rect.y; y < rect.y + rect.height; ++y) {
        const std::uint32_t first_pixel =
            static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(width) + static_cast<std::uint32_t>(rect.x);
        producer.start({.first_pixel = first_pixel,
                        .pixels = static_cast<std::uint32_t>(rect.width),
                        .first_sample = samples.first,
                        .samples = samples.end - samples.first});
        const std::size_t first_of_row = tile.pixel(rect.x, y);
        while (producer.fill(buffer)) {
            filled();
            for (int i = 0; i < buffer.size; ++i) {
                add(i, first_of_row + (buffer.pixel[static_cast<std::size_t>(i)] - first_pixel));
            }
        }
    }
    tile.count_rays(static_cast<std::uint64_t>(producer.started() - started_before));
}

}  // namespace lensproof::render
