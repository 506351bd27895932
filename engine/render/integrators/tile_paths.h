// engine/render/integrators/tile_paths.h — the camera paths of a tile's samples, one after the other.
#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>

#include "engine/render/camera/camera.h"
#include "engine/render/film/film.h"

namespace lensproof::render {

class TilePaths {
  public:
    TilePaths(const Camera& camera, std::uint64_t seed, PathCarry carry)
        : paths_(camera.paths(seed, carry)), width_(static_cast<std::uint32_t>(camera.sensor().width)) {}

    /// Calls add(paths, path, pixel) for each path of these samples, `path` being its place in the buffer `paths` and
    /// `pixel` its pixel's in the tile; counts rays in the tile.
    ///
    /// `begin(paths)`: of each buffer before its paths.
    template <class Begin, class Add>
    void for_each(const TileSamples& samples, FilmTile& tile, const Begin& begin, const Add& add) {
        const PixelRect& rect = samples.rect;
        const std::int64_t started_before = paths_.started();
        const auto columns = static_cast<std::uint32_t>(rect.width);
        const std::uint32_t first_pixel =
            static_cast<std::uint32_t>(rect.y) * width_ + static_cast<std::uint32_t>(rect.x);
        paths_.start({.first_pixel = first_pixel,
                      .pixels = columns,
                      .first_sample = samples.first,
                      .samples = samples.end - samples.first,
                      .rows = static_cast<std::uint32_t>(rect.height),
                      .beside_row = width_ - columns});
        std::uint32_t film_pixel = first_pixel;  // of the path before: most have the same
        std::size_t tile_pixel = 0;
        while (paths_.fill(buffer_)) {
            begin(std::as_const(buffer_));
            for (std::size_t i = 0; i < static_cast<std::size_t>(buffer_.size); ++i) {
                if (buffer_.pixel[i] != film_pixel) {
                    film_pixel = buffer_.pixel[i];
                    const std::uint32_t from_first = film_pixel - first_pixel;
                    const std::uint32_t row = from_first / width_;
                    tile_pixel = std::size_t{row} * columns + (from_first - row * width_);
                }
                add(buffer_, i, tile_pixel);
            }
        }
        tile.count_rays(static_cast<std::uint64_t>(paths_.started() - started_before));
    }

    template <class Add>
    void for_each(const TileSamples& samples, FilmTile& tile, const Add& add) {
        for_each(
            samples, tile, [](const CameraPathBuffer& /*paths*/) {}, add);
    }

  private:
    CameraPaths paths_;
    CameraPathBuffer buffer_{512};  // few enough for a core's own caches
    std::uint32_t width_;
};

}  // namespace lensproof::render
