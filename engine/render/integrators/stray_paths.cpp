#include "engine/render/integrators/stray_paths.h"

#include <cmath>

#include "engine/base/angle.h"
#include "engine/render/integrators/path_tracer.h"
#include "engine/render/stray/walk_numbers.h"

namespace lensproof::render {

StrayFilm::StrayFilm(const Camera& camera)
    : front_(camera), disc_(pupil::rear_disc(front_.middle(), front_.film_radius_mm())) {}

StrayFilm::Start StrayFilm::start(Vec2d pixel, double image_z, const std::array<double, 4>& numbers) const {
    const Camera& camera = front_.camera();
    const PixelFilter& filter = camera.film().filter;
    const PixelFilter::Draw across = filter.draw(numbers[0]);
    const PixelFilter::Draw down = filter.draw(numbers[1]);
    const Vec2d at = camera.sensor().position(pixel.x + across.offset_px, pixel.y + down.offset_px);
    const Vec2d through = disc_.warped(numbers[2], numbers[3]);
    const Vec3d film{at.x, at.y, image_z};
    const Vec3d to_disc = Vec3d{through.x, through.y, disc_.plane_z} - film;
    const double distance2 = dot(to_disc, to_disc);
    const double cosine2 = to_disc.z * to_disc.z / distance2;
    const double steradians = disc_.area() * cosine2 / distance2;  // the film's cosine and the disc's
    return {.ray = {film, normalized(to_disc)}, .weight = across.weight * down.weight * steradians};
}

StrayCameraPaths::StrayCameraPaths(const View& view, StrayClass wanted, std::uint64_t salt)
    : view_(view),
      film_(*view.camera),
      wanted_(wanted),
      barrel_(std::make_shared<const optics::Barrel>(view.camera->lens().value())),
      // Another's than those of the light paths beside them.
      seed_(sampler_detail::mixed(~(view.seed ^ salt))) {
    view_.paths.min_bounces = 1;
    view_.paths.takes_sky_by_camera = true;
}

void StrayCameraPaths::operator()(const TileSamples& samples, FilmTile& tile) const {
    if (is_dark(wanted_, *barrel_)) {
        return;
    }
    add_stray_samples(view_, seed_, samples, tile, [&](Vec2d pixel, const auto& path, PathSampler& numbers, auto& to) {
        return irradiance(pixel, path, numbers, to);
    });
}

double StrayCameraPaths::shining_on(const Ray<double>& dust, const spectral::PathWavelengths& path,
                                    PathSampler& numbers) const {
    const scene::Scene& scene = view_.scene();
    const Ray<double> grain = film_.front().camera().to_world(dust);
    const auto u = numbers.next();
    const auto light = scene.lights.sample(grain.origin, path, {u[0], {u[1], u[2]}});
    const double cosine = light ? dot(grain.direction, light->direction) : 0.0;
    if (!(cosine > 0.0) || scene::is_occluded(*scene.geometry, grain.origin, light->end)) {
        return 0.0;
    }
    return cosine / kPi * scene::light_of(light->value, light->place, path)[0];
}

float StrayCameraPaths::irradiance(Vec2d pixel, const spectral::PathWavelengths& path, PathSampler& numbers,
                                   FilmTile& tile) const {
    const Camera& camera = film_.front().camera();
    const auto place = numbers.next();
    const auto aim = numbers.next();
    const optics::TraceLens<double>& lens = film_.front().lens().at(path.index[0]);
    const StrayFilm::Start start = film_.start(pixel, lens.image_z, {place[0], place[1], aim[0], aim[1]});
    optics::StrayLight light{.ray = start.ray};
    WalkNumbers walk_numbers(aim);
    optics::StrayWalk walk(lens, *barrel_, camera.settings().mirrors, walk_numbers);
    tile.count_rays(1);
    const auto unheard = [](const optics::StrayLight&) {};
    double brought = 0.0;  // radiance
    const auto end_at = [&](optics::StrayEnd end, const optics::StrayLight& out) {
        if (end == optics::StrayEnd::front && counts(wanted_, out)) {
            PathSettings onwards = view_.paths;
            onwards.takes_sky_by_camera = !out.dust_normal;  // all that shines on dust itself is asked for here
            const PathRadiance found = trace_path(view_.scene(), camera.to_world(out.ray), path, onwards, numbers);
            tile.count_rays(found.rays);
            brought += out.weight * (found.radiance[0] + found.hero_radiance);
            if (out.dust_normal) {
                tile.count_rays(1);
                brought += out.weight * shining_on({out.ray.origin, *out.dust_normal}, path, numbers);
            }
        }
    };
    const optics::StrayEnd end =
        wanted_ == StrayClass::walls ? walk.follow_to_wall(light, false, unheard) : walk.follow(light, false, unheard);
    if (end == optics::StrayEnd::wall) {
        // Few ways from a wall lead out, so it pays to try several.
        constexpr int kTriesFromWall = 8;
        light.weight /= kTriesFromWall;
        for (int i = 0; i < kTriesFromWall; ++i) {
            optics::StrayWalk branch = walk;
            optics::StrayLight onwards = light;
            end_at(branch.leave_first_wall(onwards, unheard), onwards);
        }
        tile.count_rays(kTriesFromWall);
    } else {
        end_at(end, light);
    }
    return static_cast<float>(start.weight * brought);
}

}  // namespace lensproof::render
