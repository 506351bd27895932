#include "engine/render/integrators/stray_paths.h"

#include <cmath>

#include "engine/base/angle.h"
#include "engine/render/integrators/path_tracer.h"
#include "engine/render/stray/walk_numbers.h"

namespace lensproof::render {

StrayCameraPaths::StrayCameraPaths(const View& view, Ways ways, std::uint64_t salt)
    : view_(view),
      front_(*view.camera),
      ways_(ways),
      barrel_(std::make_shared<const optics::Barrel>(view.camera->lens().value())),
      disc_(pupil::rear_disc(front_.middle(), front_.film_radius_mm())),
      // Another's than those of the light paths beside them.
      seed_(sampler_detail::mixed(~(view.seed ^ salt))) {
    view_.paths.min_bounces = 1;
    view_.paths.shares_sky = true;
}

void StrayCameraPaths::operator()(const TileSamples& samples, FilmTile& tile) const {
    if (is_dark(ways_, *barrel_)) {
        return;
    }
    const PixelRect& rect = samples.rect;
    const spectral::SpectralGrid& grid = view_.camera->grid();
    for (int y = rect.y; y < rect.y + rect.height; ++y) {
        for (int x = rect.x; x < rect.x + rect.width; ++x) {
            const auto pixel = static_cast<std::uint32_t>(y * view_.camera->sensor().width + x);
            for (std::uint32_t sample = samples.first; sample < samples.end; ++sample) {
                PathSampler numbers(seed_, pixel, sample);
                const spectral::PathWavelengths path = grid.path(static_cast<int>(numbers.next()[0] * grid.size()));
                const float found = irradiance({static_cast<double>(x), static_cast<double>(y)}, path, numbers, tile);
                if (found != 0.0F) {
                    constexpr auto kWavelengths = static_cast<float>(spectral::kWavelengthsPerPath);
                    tile.add(tile.pixel(x, y), sample, path.index, std::array{kWavelengths * found, 0.0F, 0.0F, 0.0F});
                }
            }
        }
    }
}

double StrayCameraPaths::shining_on(const Ray<double>& dust, const spectral::PathWavelengths& path,
                                    PathSampler& numbers) const {
    const scene::Scene& scene = view_.scene();
    const Ray<double> grain = front_.camera().to_world(dust);
    const auto u = numbers.next();
    const auto light = scene.lights.sample(grain.origin, path, u[0], u[1], u[2]);
    const double cosine = light ? dot(grain.direction, light->direction) : 0.0;
    if (!(cosine > 0.0) || scene::is_occluded(*scene.geometry, grain.origin, light->end)) {
        return 0.0;
    }
    return cosine / kPi * scene::light_of(light->value, light->place, path)[0];
}

float StrayCameraPaths::irradiance(Vec2d pixel, const spectral::PathWavelengths& path, PathSampler& numbers,
                                   FilmTile& tile) const {
    const Camera& camera = front_.camera();
    const auto place = numbers.next();
    const auto aim = numbers.next();
    const PixelFilter& filter = camera.film().filter;
    const PixelFilter::Draw across = filter.draw(place[0]);
    const PixelFilter::Draw down = filter.draw(place[1]);
    const Vec2d at = camera.sensor().position(pixel.x + across.offset_px, pixel.y + down.offset_px);

    const optics::TraceLens<double>& lens = front_.lens().at(path.index[0]);
    const Vec2d through = disc_.warped(aim[0], aim[1]);
    const Vec3d film{at.x, at.y, lens.image_z};
    const Vec3d to_disc = Vec3d{through.x, through.y, disc_.plane_z} - film;
    const double distance2 = dot(to_disc, to_disc);
    optics::StrayLight light{.ray = {film, normalized(to_disc)}};
    WalkNumbers walk_numbers(aim);
    optics::StrayWalk walk(lens, *barrel_, camera.settings().mirrors, walk_numbers);
    tile.count_rays(1);
    const auto unheard = [](const optics::StrayLight&) {};
    double brought = 0.0;  // radiance
    const auto end_at = [&](optics::StrayEnd end, const optics::StrayLight& out) {
        if (end == optics::StrayEnd::front && counts(ways_, out)) {
            PathSettings onwards = view_.paths;
            onwards.shares_sky = !out.dust_normal;  // all that shines on dust itself is asked for here
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
        ways_ == Ways::walls ? walk.follow_to_wall(light, false, unheard) : walk.follow(light, false, unheard);
    if (end == optics::StrayEnd::wall) {
        // Few ways from a wall lead out, so it pays to try several.
        constexpr int kWaysFromWall = 8;
        light.weight /= kWaysFromWall;
        for (int way = 0; way < kWaysFromWall; ++way) {
            optics::StrayWalk branch = walk;
            optics::StrayLight onwards = light;
            end_at(branch.leave_first_wall(onwards, unheard), onwards);
        }
        tile.count_rays(kWaysFromWall);
    } else {
        end_at(end, light);
    }
    const double cosine2 = to_disc.z * to_disc.z / distance2;
    const double steradians = disc_.area() * cosine2 / distance2;  // the film's cosine and the disc's
    return static_cast<float>(across.weight * down.weight * steradians * brought);
}

}  // namespace lensproof::render
