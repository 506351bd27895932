#include "engine/render/path_tracer.h"

#include <cmath>
#include <limits>

#include "engine/render/path_weight.h"

namespace lensproof::render {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class PathWalk {
  public:
    PathWalk(const scene::Scene& scene, const spectral::PathWavelengths& path, const PathSettings& settings,
             PathSampler& numbers, const DrawnByCamera* drawn)
        : scene_(scene), path_(path), settings_(settings), numbers_(numbers), drawn_(drawn) {}

    PathRadiance walk(Ray<double> ray) {
        spectral::SpectralSample throughput(1.0F);
        for (int bounce = 0;; ++bounce) {
            const auto hit = scene::intersect(*scene_.geometry, ray.origin, ray.direction, 0.0, kInfinity);
            ++result_.rays;
            if (bounce == 0 && drawn_ != nullptr) {
                enter(hit ? LightOrigin{hit->point, false} : LightOrigin{-1.0 * ray.direction, true});
            }
            if (!hit) {
                scene_.lights.visit_infinity(ray.direction, path_, [&](const scene::Lights::Emission& light) {
                    add_found(throughput, light, 1.0);
                });
                break;
            }
            throughput *= passes_body(scene_, *hit, ray.direction, path_);
            add_found(throughput, scene_.lights.emitted(*hit, from_, ray.direction, path_),
                      std::abs(dot(hit->geometric_normal, ray.direction)));
            if (bounce == settings_.max_bounces && bounce > 0) {
                break;
            }
            const PathVertex vertex(*hit, -1.0 * ray.direction, scene_, path_);
            if (bounce == 0) {
                note_first(vertex);
            }
            if (bounce == settings_.max_bounces || !vertex.is_consistent(-1.0 * ray.direction, vertex.wo)) {
                break;
            }
            const auto numbers = numbers_.next();
            if (!scene::is_delta(vertex.bsdf)) {
                add_from_lights(vertex, throughput);
            }
            const auto scattered =
                scene::sample(vertex.bsdf, vertex.wo, numbers[0], numbers[1], numbers[2], scene::Transport::radiance);
            if (!scattered) {
                break;
            }
            const Vec3d onwards = vertex.frame.to_world(scattered->wi);
            if (!vertex.is_consistent(onwards, scattered->wi)) {
                break;
            }
            throughput *= scattered->weight;
            if (scattered->is_dispersed) {
                is_hero_alone_ = true;
                weight_.hero_goes_alone();
            }
            if (!survives_roulette(settings_, bounce, numbers[3], throughput)) {
                break;
            }
            weight_.turn(turn_of(vertex, onwards, *scattered));
            from_ = hit->point;
            ray = {scene::ray_origin(*hit, onwards), onwards};
        }
        return result_;
    }

  private:
    void add(const spectral::SpectralSample& light) {
        if (is_hero_alone_) {
            result_.hero_radiance += light[0];
        } else {
            result_.radiance += light;
        }
    }

    void enter(const LightOrigin& first) {
        weight_.enter(drawn_->end->ratio(drawn_->end->density(first, drawn_->ray, path_), drawn_->density));
    }

    /// Only as much of a turn as weights need.
    [[nodiscard]] PathTurn turn_of(const PathVertex& vertex, const Vec3d& onwards,
                                   const scene::BsdfSample& scattered) const {
        if (scattered.is_delta) {
            return {.is_delta = true};
        }
        return drawn_ != nullptr ? camera_turn(vertex, onwards, scattered.wi, scattered.density)
                                 : PathTurn{.to_light = scattered.density};
    }

    /// Light that the path ran into, at `cosine` from its normal.
    void add_found(const spectral::SpectralSample& throughput, const scene::Lights::Emission& light, double cosine) {
        if (!spectral::is_black(light.radiance)) {
            add(static_cast<float>(weight_.of_hit(light, cosine)) * (throughput * light.radiance));
        }
    }

    void add_from_lights(const PathVertex& vertex, const spectral::SpectralSample& throughput) {
        const auto numbers = numbers_.next();
        const auto light = scene_.lights.sample(vertex.hit.point, path_, numbers[0], numbers[1], numbers[2]);
        if (!light) {
            return;
        }
        const Vec3d wi = vertex.frame.to_local(light->direction);
        if (!vertex.is_consistent(light->direction, wi)) {
            return;
        }
        const spectral::SpectralSample scattering =
            scene::evaluate(vertex.bsdf, vertex.wo, wi, scene::Transport::radiance);
        if (spectral::is_black(scattering)) {
            return;
        }
        ++result_.rays;
        if (scene::is_occluded(*scene_.geometry, scene::ray_origin(vertex.hit, light->direction), light->end)) {
            return;
        }
        const double to_light =
            light->density > 0.0 ? scene::density(vertex.bsdf, vertex.wo, wi, scene::Transport::radiance) : 0.0;
        const PathTurn turn =
            drawn_ != nullptr ? camera_turn(vertex, light->direction, wi, to_light) : PathTurn{.to_light = to_light};
        add(static_cast<float>(weight_.of_sample(*light, turn)) * (throughput * scattering * light->value));
    }

    void note_first(const PathVertex& vertex) {
        const bool is_behind = vertex.wo.z < 0.0;
        result_.first = FirstSurface{.point = vertex.hit.point,
                                     .normal = (is_behind ? -1.0 : 1.0) * vertex.frame.z,
                                     .albedo = scene::normal_albedo(vertex.bsdf)};
    }

    const scene::Scene& scene_;
    const spectral::PathWavelengths& path_;
    const PathSettings& settings_;
    PathSampler& numbers_;
    PathRadiance result_;
    bool is_hero_alone_ = false;
    Vec3d from_;  // the surface point that the ray left
    CameraPathWeight weight_;
    const DrawnByCamera* drawn_;
};

}  // namespace

PathRadiance trace_path(const scene::Scene& scene, const Ray<double>& ray, const spectral::PathWavelengths& path,
                        const PathSettings& settings, PathSampler& numbers, const DrawnByCamera* drawn) {
    return PathWalk(scene, path, settings, numbers, drawn).walk(ray);
}

}  // namespace lensproof::render
