#include "engine/render/light_tracer.h"

#include <cmath>
#include <limits>

#include "engine/render/path_weight.h"

namespace lensproof::render {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSquareMetresPerSquareMm = 1e-6;

class LightWalk {
  public:
    LightWalk(const scene::Scene& scene, const CameraEnd& camera, const spectral::PathWavelengths& path,
              const PathSettings& settings, PathSampler& numbers, FilmTile& tile, LightPaths paths)
        : scene_(scene),
          camera_(camera),
          path_(path),
          settings_(settings),
          numbers_(numbers),
          tile_(tile),
          is_weighed_(paths == LightPaths::with_camera_paths) {}

    std::uint32_t walk() {
        const auto begin = numbers_.next();
        const scene::LightStart start = scene_.lights.start(path_, begin[0], begin[1], begin[2]);
        if (!start.is_point()) {
            join_from_light(start);
        }
        if (settings_.max_bounces > 0) {
            const auto onwards = numbers_.next();
            scatter(start, scene_.lights.leave(start, onwards[0], onwards[1]));
        }
        return rays_;
    }

  private:
    /// Carries on from surface to surface, and joins the camera from each.
    void scatter(const scene::LightStart& start, const scene::EmittedRay& light) {
        Ray<double> ray = light.ray;
        spectral::SpectralSample throughput(1.0F);
        for (int bounce = 1; spectral::max_value(light.power) > 0.0F; ++bounce) {
            const auto hit = scene::intersect(*scene_.geometry, ray.origin, ray.direction, 0.0, kInfinity);
            ++rays_;
            if (!hit) {
                return;
            }
            throughput *= passes_body(scene_, *hit, ray.direction, path_);
            const PathVertex vertex(*hit, -1.0 * ray.direction, scene_, path_);
            if (!vertex.is_consistent(-1.0 * ray.direction, vertex.wo)) {
                return;
            }
            if (bounce == 1 && is_weighed_) {
                weight_.leave(scene_.lights.way(start, hit->point));
            }
            if (!scene::is_delta(vertex.bsdf)) {
                join_from_surface(vertex, light.power * throughput);
            }
            if (bounce == settings_.max_bounces) {
                return;
            }
            const auto numbers = numbers_.next();
            const auto scattered =
                scene::sample(vertex.bsdf, vertex.wo, numbers[0], numbers[1], numbers[2], scene::Transport::importance);
            if (!scattered) {
                return;
            }
            const Vec3d onwards = vertex.frame.to_world(scattered->wi);
            if (!vertex.is_consistent(onwards, scattered->wi)) {
                return;
            }
            throughput *=
                scattered->weight * spectral::SpectralSample(shading_correction(vertex, onwards, scattered->wi));
            if (scattered->is_dispersed && !is_hero_alone_) {
                throughput = static_cast<float>(spectral::kWavelengthsPerPath) * spectral::hero_alone(throughput);
                is_hero_alone_ = true;
            }
            if (is_weighed_) {
                weight_.turn(scattered->is_delta ? PathTurn{.is_delta = true}
                                                 : light_turn(vertex, onwards, scattered->wi, scattered->density));
            }
            if (!survives_roulette(settings_, bounce, numbers[3], throughput)) {
                return;
            }
            ray = {scene::ray_origin(*hit, onwards), onwards};
        }
    }

    /// Light carries |cos| about the geometric normal where its paths' weights have that about the shading normal
    /// (Veach 1997, eq. 5.17).
    static float shading_correction(const PathVertex& vertex, const Vec3d& wi_world, const Vec3d& wi) {
        const double before =
            std::abs(vertex.wo.z) / std::abs(dot(vertex.frame.to_world(vertex.wo), vertex.hit.geometric_normal));
        const double after = std::abs(dot(wi_world, vertex.hit.geometric_normal)) / std::abs(wi.z);
        return static_cast<float>(before * after);
    }

    void join_from_light(const scene::LightStart& start) {
        const LightOrigin from{start.is_at_infinity ? start.direction : start.point, start.is_at_infinity};
        join(from, [&](const RayIn& in) {
            if (start.is_at_infinity) {
                return Carried{.light = is_blocked(in.end - scene_.lights.beyond_mm(in.end) * start.direction, in.end)
                                            ? spectral::SpectralSample()
                                            : start.value,
                               .others = LightPathWeight::others(start, 1.0)};
            }
            const spectral::SpectralSample intensity = scene_.lights.intensity(start, in.direction);
            const Vec3d origin = scene::ray_origin(start.point, start.normal, start.error_mm, in.direction);
            return Carried{.light = spectral::is_black(intensity) || is_blocked(origin, in.end)
                                        ? spectral::SpectralSample()
                                        : intensity,
                           .others = LightPathWeight::others(start, std::abs(dot(start.normal, in.direction)))};
        });
    }

    void join_from_surface(const PathVertex& vertex, const spectral::SpectralSample& power) {
        join({vertex.hit.point, false}, [&](const RayIn& in) -> Carried {
            const Vec3d wi = vertex.frame.to_local(in.direction);
            if (!vertex.is_consistent(in.direction, wi)) {
                return {};
            }
            const spectral::SpectralSample scattered =
                scene::evaluate(vertex.bsdf, vertex.wo, wi, scene::Transport::importance);
            if (spectral::is_black(scattered) || is_blocked(scene::ray_origin(vertex.hit, in.direction), in.end)) {
                return {};
            }
            return {.light = power * scattered * spectral::SpectralSample(shading_correction(vertex, in.direction, wi)),
                    .others = is_weighed_ ? weight_.others(light_turn(vertex, in.direction, wi, 0.0)) : 0.0};
        });
    }

    /// What goes along a ray into the camera: an intensity from a point, from far off an irradiance; and what other
    /// ways to make the path weigh (LightPathWeight).
    struct Carried {
        spectral::SpectralSample light;
        double others = 0.0;
    };

    /// Draws a ray into the camera and brings its light to the film.
    template <class CarriedBy>
    void join(const LightOrigin& from, const CarriedBy& carried_by) {
        const auto u = numbers_.next();
        const auto in = camera_.draw(from, path_, u[0], u[1]);
        if (!in) {
            return;
        }
        const FilmArrival film = camera_.arrive(in->ray, path_);
        rays_ += spectral::kWavelengthsPerPath;
        if (film.is_dark()) {
            return;
        }
        const Carried carried = carried_by(*in);
        if (spectral::is_black(carried.light)) {
            return;
        }
        const double entrance = is_hero_alone_ ? in->density.hero : in->density.shared;
        const double pitch_m = 1e-3 * camera_.sensor.pixel_pitch_mm;
        const double to_irradiance = (from.is_far ? kSquareMetresPerSquareMm : 1.0) / (entrance * pitch_m * pitch_m);
        std::array<float, spectral::kWavelengthsPerPath> irradiance{};
        for (std::size_t i = 0; i < irradiance.size(); ++i) {
            if (film.share[i] > 0.0) {
                irradiance[i] = static_cast<float>(to_irradiance * film.share[i] * carried.light[i] *
                                                   share_of(film, i, entrance, carried.others));
            }
        }
        tile_.splat(film.at_px, path_.index, irradiance);
    }

    /// What of the path's light at a wavelength this way brings.
    [[nodiscard]] double share_of(const FilmArrival& film, std::size_t wavelength, double entrance,
                                  double others) const {
        if (!is_weighed_) {
            return 1.0;
        }
        const double drawn = is_hero_alone_ ? film.drawn[wavelength] : film.shared_density(wavelength);
        return LightPathWeight::share(others, drawn / (camera_.film_area_mm2() * entrance));
    }

    bool is_blocked(const Vec3d& from, const Vec3d& to) {
        ++rays_;
        return scene::is_occluded(*scene_.geometry, from, to);
    }

    const scene::Scene& scene_;
    const CameraEnd& camera_;
    const spectral::PathWavelengths& path_;
    const PathSettings& settings_;
    PathSampler& numbers_;
    FilmTile& tile_;
    LightPathWeight weight_;
    std::uint32_t rays_ = 0;
    bool is_weighed_;
    bool is_hero_alone_ = false;
};

}  // namespace

std::uint32_t trace_light_path(const scene::Scene& scene, const CameraEnd& camera,
                               const spectral::PathWavelengths& path, const PathSettings& settings,
                               PathSampler& numbers, FilmTile& tile, LightPaths paths) {
    return LightWalk(scene, camera, path, settings, numbers, tile, paths).walk();
}

}  // namespace lensproof::render
