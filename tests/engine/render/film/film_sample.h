// tests/engine/render/film/film_sample.h — a film and samples of known statistics for it.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>

#include "engine/render/film/film.h"
#include "engine/render/sampling/sampler.h"

namespace lensproof::render {

/// One stratum a layer, over a band of 1 nm, so that R, G and B are the film irradiance times 1, 2 and 3.
inline FilmLayout plain_film(int width, int height, int layers = 1) {
    FilmLayout layout{.width = width, .height = height, .layer_nm = {}, .rgb_weights = {}, .band_nm = 1.0};
    for (int i = 0; i < layers; ++i) {
        layout.layer_nm.push_back(400.0 + 10.0 * i);
        layout.rgb_weights.push_back({1.0, 2.0, 3.0});
    }
    return layout;
}

/// The same with everything that a film may have.
inline FilmLayout full_film(int width, int height, int layers) {
    FilmLayout layout = plain_film(width, height, layers);
    layout.has_splats = true;
    layout.has_features = true;
    return layout;
}

/// A splat's points, the same at each wavelength.
inline std::array<Vec2d, 4> all_at(double x_px, double y_px) {
    return {{{x_px, y_px}, {x_px, y_px}, {x_px, y_px}, {x_px, y_px}}};
}

/// A number in (0, 1), independent of all others.
inline double even_number(std::uint64_t seed, std::uint32_t pixel, std::uint32_t sample) {
    const std::uint64_t stream = sampler_detail::mixed(seed) ^ (std::uint64_t{pixel} << 32U ^ sample);
    return (static_cast<double>(sampler_detail::mixed(stream) >> 11U) + 0.5) * 0x1p-53;
}

/// Of mean 1 and variance 1, and skewed, as light is.
inline double exponential_number(std::uint64_t seed, std::uint32_t pixel, std::uint32_t sample) {
    return -std::log(even_number(seed, pixel, sample));
}

/// Renders an even field of irradiance 1 by independent exponential samples.
inline TileRenderer exponential_renderer(const FilmLayout& layout, std::uint64_t seed) {
    return [width = layout.width, seed](const TileSamples& samples, FilmTile& tile) {
        const PixelRect& rect = samples.rect;
        for (int y = rect.y; y < rect.y + rect.height; ++y) {
            for (int x = rect.x; x < rect.x + rect.width; ++x) {
                for (std::uint32_t i = samples.first; i < samples.end; ++i) {
                    tile.add(tile.pixel(x, y), i, 0,
                             exponential_number(seed, static_cast<std::uint32_t>(y * width + x), i));
                }
            }
        }
    };
}

/// A film with these samples, which add(tile) takes.
template <class Add>
Film film_of(const FilmLayout& layout, const TileSamples& samples, const Add& add) {
    Film film(layout);
    FilmTile tile(layout);
    film.load(samples, tile);
    add(tile);
    tile.finish();
    film.store(tile);
    return film;
}

/// That field, after samples [first, end) of every pixel.
inline Film exponential_film(int side, std::uint64_t seed, std::uint32_t first, std::uint32_t end) {
    const FilmLayout layout = plain_film(side, side);
    const TileSamples samples{.rect = {0, 0, side, side}, .first = first, .end = end};
    return film_of(layout, samples, [&](FilmTile& tile) { exponential_renderer(layout, seed)(samples, tile); });
}

}  // namespace lensproof::render
