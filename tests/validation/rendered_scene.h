// tests/validation/rendered_scene.h — parts of a picture, rendered a few times over to know their errors.
#pragma once
#include <span>
#include <vector>

#include "engine/render/integrators/chart_tracer.h"
#include "engine/render/prepared_scene.h"
#include "tests/validation/measured.h"

namespace lensproof {

/// The film with these windows of it rendered.
inline render::Film rendered(const render::Render& render, std::span<const render::PixelRect> windows,
                             std::uint32_t samples) {
    render::Film film(render.film);
    render::FilmTile tile(film.layout());
    for (const render::PixelRect& window : windows) {
        const render::TileSamples what{.rect = window, .first = 0, .end = samples};
        film.load(what, tile);
        render.renderer(what, tile);
        tile.finish();
        film.store(tile);
    }
    return film;
}

/// A chart under even light of 1000 cd/m² as a camera sees it.
struct SeenChart {
    const render::Camera& camera;
    scene::Chart chart;
    scene::Placement placement;
    bool has_features = false;
};
inline render::Film rendered(const SeenChart& seen, const render::SampleRange& range, std::uint64_t seed = 0,
                             int threads = 0) {
    const render::World world = render::even_chart(seen.chart, seen.placement, 1000.0, seen.camera);
    const render::View view{.world = &world, .camera = &seen.camera, .seed = seed, .has_features = seen.has_features};
    return render::render_film(render::integrator_named("chart").render(view), range, threads);
}

}  // namespace lensproof
