#include "engine/render/integrators/energy_audit.h"

#include <algorithm>
#include <cmath>

#include "engine/render/integrators/light_walk.h"

namespace lensproof::render {

const std::array<std::string, kFates>& fate_names() {
    static const std::array<std::string, kFates> names = {"imaged", "ghosts",  "barrel",   "beside",
                                                          "front",  "clipped", "absorbed", "lost"};
    return names;
}

namespace {

/// A film of one tile, some samples at a time: each leaves splats, which wait in the tile.
Film film_of(const Render& render, std::uint32_t samples) {
    constexpr std::uint32_t kAtOnce = 1024;
    Film film(render.film);
    FilmTile tile(render.film);
    for (std::uint32_t first = 0; first < samples; first += kAtOnce) {
        const TileSamples some{.rect = {.width = render.film.width, .height = render.film.height},
                               .first = first,
                               .end = std::min(samples, first + kAtOnce)};
        film.load(some, tile);
        render.renderer(some, tile);
        tile.finish();
        film.store(tile);
    }
    return film;
}

}  // namespace

EnergyAudit energy_audit(const View& view, std::uint32_t paths) {
    FilmLayout layout = view.camera->film();
    layout.width = kFates;
    layout.height = 1;
    layout.filter = {};
    layout.has_splats = true;
    const double per_nm = 1.0 / layout.band_nm;
    layout.rgb_weights.assign(layout.rgb_weights.size(), {per_nm, per_nm, per_nm});
    const Render render{.film = layout,
                        .renderer = LightPaths(view, FateEntrance(*view.camera), 0x5be0cd19137e2179ULL)};
    const Film film = film_of(render, paths / kFates + 1);

    EnergyAudit audit;
    std::array<PixelEstimate, kFates> found;
    double sum = 0.0;
    double variance = 0.0;
    for (int fate = 0; fate < kFates; ++fate) {
        found[static_cast<std::size_t>(fate)] = film.light_estimate(fate, 0);
        sum += found[static_cast<std::size_t>(fate)].rgb.x;
        variance += found[static_cast<std::size_t>(fate)].variance.x;
    }
    const double pitch_m = 1e-3 * view.camera->sensor().pixel_pitch_mm;
    audit.light_in = sum * pitch_m * pitch_m;
    for (std::size_t i = 0; sum > 0.0 && i < found.size(); ++i) {
        // Of x / (x + y): the paths of x and those of the others, y, are not the same ones.
        const double fraction = found[i].rgb.x / sum;
        const double own = found[i].variance.x;
        audit.fractions[i] = {
            fraction,
            std::sqrt((1.0 - fraction) * (1.0 - fraction) * own + fraction * fraction * (variance - own)) / sum};
    }
    return audit;
}

}  // namespace lensproof::render
