#include "engine/render/integrators/ghost_paths.h"

#include <algorithm>
#include <utility>

#include "engine/render/integrators/path_tracer.h"

namespace lensproof::render {

bool has_mirrors(const scene::Scene& scene) {
    const spectral::PathWavelengths path = scene.grid.path(0);
    return std::ranges::any_of(scene.materials, [&](const scene::Material& material) {
        return scene::has_delta(scene::bsdf_at(material, {0.5, 0.5}, path));
    });
}

MirroredGhostPaths::MirroredGhostPaths(const View& view, std::vector<optics::GhostPath> ghosts, std::uint64_t salt)
    : view_(view),
      film_(*view.camera),
      from_film_(std::move(ghosts)),
      // Another's than those of the light paths beside them.
      seed_(sampler_detail::mixed(~(view.seed ^ salt))) {
    for (optics::GhostPath& ghost : from_film_) {
        std::ranges::reverse(ghost);
    }
    view_.paths.min_bounces = 1;
    view_.paths.begins_at_mirror = true;
}

void MirroredGhostPaths::operator()(const TileSamples& samples, FilmTile& tile) const {
    if (from_film_.empty()) {
        return;
    }
    add_stray_samples(view_, seed_, samples, tile, [&](Vec2d pixel, const auto& path, PathSampler& numbers, auto& to) {
        return irradiance(pixel, path, numbers, to);
    });
}

float MirroredGhostPaths::irradiance(Vec2d pixel, const spectral::PathWavelengths& path, PathSampler& numbers,
                                     FilmTile& tile) const {
    const CameraFront& front = film_.front();
    const optics::TraceLens<double>& lens = front.lens().at(path.index[0]);
    const auto u = numbers.next();
    const StrayFilm::Start start = film_.start(pixel, lens.image_z, {u[0], u[1], u[2], u[3]});
    const auto ghosts = static_cast<double>(from_film_.size());
    const optics::GhostPath& ghost = from_film_[static_cast<std::size_t>(u[4] * ghosts)];
    tile.count_rays(1);
    const optics::TracedRay<double> out =
        optics::trace_ghost<optics::Direction::reverse>(lens, ghost, start.ray, front.camera().settings().mirrors);
    if (out.status != optics::RayStatus::ok) {
        return 0.0F;
    }
    const PathRadiance found = trace_path(view_.scene(), front.camera().to_world(out.ray), path, view_.paths, numbers);
    tile.count_rays(found.rays);
    const double brought = out.transmittance * front.clear(out.ray.origin) * (found.radiance[0] + found.hero_radiance);
    return static_cast<float>(ghosts * start.weight * brought);
}

}  // namespace lensproof::render
