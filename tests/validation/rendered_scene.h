// tests/validation/rendered_scene.h — parts of a scene file's picture, rendered a few times over to know their errors.
#pragma once
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "engine/render/prepared_scene.h"

namespace lensproof {

/// The film with these windows of it rendered; no film but this one's has its seed's samples.
inline render::Film rendered(const render::PreparedScene& scene, std::span<const render::PixelRect> windows,
                             std::uint32_t samples, std::uint64_t seed) {
    const render::SceneView view = scene.view(seed, false);
    const render::TileRenderer render = render::scene_renderer(view);
    render::Film film(view.film);
    render::FilmTile tile(film.layout());
    for (const render::PixelRect& window : windows) {
        const render::TileSamples what{.rect = window, .first = 0, .end = samples};
        film.load(what, tile);
        render(what, tile);
        tile.finish();
        film.store(tile);
    }
    return film;
}

/// A number with its standard error.
struct Measured {
    double value = 0.0;
    double error = 0.0;
};

/// Of independent values.
inline Measured mean_of(std::span<const double> values) {
    const auto count = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
    double squares = 0.0;
    for (const double value : values) {
        squares += (value - mean) * (value - mean);
    }
    return {mean, std::sqrt(squares / (count * (count - 1.0)))};
}

}  // namespace lensproof
