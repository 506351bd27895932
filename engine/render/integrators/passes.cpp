#include "engine/render/integrators/passes.h"

#include <algorithm>
#include <stdexcept>

#include "engine/render/integrators/light_walk.h"
#include "engine/render/stray/barrel_entrance.h"
#include "engine/render/stray/ghost_entrance.h"

namespace lensproof::render {

namespace {

Render imaged(const View& view, const Integrator& integrator) {
    View scattered = view;
    scattered.paths.min_bounces = 1;
    return integrator.render(scattered);
}

Render direct(const View& view, const Integrator& integrator) {
    View seen = view;
    seen.paths.max_bounces = 0;
    seen.has_features = false;
    return integrator.render(seen);
}

/// By light paths from all that shines on the camera.
template <class Entrance>
Render astray(const View& view, Entrance entrance, std::uint64_t salt) {
    Render render{
        .film = view.camera->film(), .renderer = LightPaths(view, std::move(entrance), salt), .lands_anywhere = true};
    render.film.has_splats = true;
    return render;
}

Render ghosts(const View& view, const Integrator& /*integrator*/) {
    return astray(view, GhostEntrance(*view.camera, Reflections::ghosts), 0x3c6ef372fe94f82bULL);
}

Render barrel(const View& view, const Integrator& /*integrator*/) {
    return astray(view, BarrelEntrance(*view.camera, Walls::met), 0x1f83d9abfb41bd6bULL);
}

Render everything(const View& view, const Integrator& /*integrator*/) {
    constexpr std::uint64_t kChance = 0xa54ff53a5f1d36f1ULL;
    const bool has_walls = view.camera->lens() && !view.camera->lens()->barrel.is_black();
    return has_walls ? astray(view, BarrelEntrance(*view.camera, Walls::met_or_not), kChance)
                     : astray(view, GhostEntrance(*view.camera, Reflections::anything), kChance);
}

}  // namespace

const std::vector<Pass>& passes() {
    static const std::vector<Pass> all = {
        {"imaged", "the scene through the lens", imaged},
        {"direct", "lights as they are seen", direct},
        {"ghosts", "light that surfaces of the lens reflect", ghosts},
        {"barrel", "light that the inside of the lens scatters", barrel},
        {"everything", "all of these at once, by chance: slow, and a judge of the others", everything},
    };
    return all;
}

const Pass& pass_named(const std::string& name) {
    const auto found = std::ranges::find(passes(), name, &Pass::name);
    if (found == passes().end()) {
        throw std::out_of_range("no pass is called " + name);
    }
    return *found;
}

}  // namespace lensproof::render
