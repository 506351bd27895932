#include "engine/render/path_tracer.h"

#include <cmath>
#include <limits>

namespace lensproof {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class PathWalk {
  public:
    PathWalk(const Scene& scene, const PathWavelengths& path, const PathSettings& settings, PathSampler& numbers)
        : scene_(scene), path_(path), settings_(settings), numbers_(numbers) {}

    PathRadiance walk(Ray<double> ray) {
        SpectralSample throughput(1.0F);
        for (int bounce = 0;; ++bounce) {
            const auto hit = intersect(*scene_.geometry, ray.origin, ray.direction, 0.0, kInfinity);
            ++result_.rays;
            if (!hit) {
                scene_.lights.visit_infinity(ray.direction, path_,
                                             [&](const Lights::Emission& light) { add_found(throughput, light); });
                break;
            }
            throughput *= passes_body(scene_, *hit, ray.direction, path_);
            add_found(throughput, scene_.lights.emitted(*hit, from_, ray.direction, path_));
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
            if (!is_delta(vertex.bsdf)) {
                add_from_lights(vertex, throughput);
            }
            const auto scattered =
                sample(vertex.bsdf, vertex.wo, numbers[0], numbers[1], numbers[2], Transport::radiance);
            if (!scattered) {
                break;
            }
            const Vec3d onwards = vertex.frame.to_world(scattered->wi);
            if (!vertex.is_consistent(onwards, scattered->wi)) {
                break;
            }
            throughput *= scattered->weight;
            is_hero_alone_ = is_hero_alone_ || scattered->is_dispersed;
            if (!survives_roulette(settings_, bounce, numbers[3], throughput)) {
                break;
            }
            scattering_density_ = scattered->is_delta ? 0.0 : scattered->density;
            from_ = hit->point;
            ray = {ray_origin(*hit, onwards), onwards};
        }
        return result_;
    }

  private:
    void add(const SpectralSample& light) {
        if (is_hero_alone_) {
            result_.hero_radiance += light[0];
        } else {
            result_.radiance += light;
        }
    }

    /// Light that the path ran into. Sampling lights would have found it from the surface before, unless that is a
    /// mirror or the camera.
    void add_found(const SpectralSample& throughput, const Lights::Emission& light) {
        if (is_black(light.radiance)) {
            return;
        }
        const double weight =
            scattering_density_ > 0.0 ? scattering_density_ / (scattering_density_ + light.density) : 1.0;
        add(static_cast<float>(weight) * (throughput * light.radiance));
    }

    void add_from_lights(const PathVertex& vertex, const SpectralSample& throughput) {
        const auto numbers = numbers_.next();
        const auto light = scene_.lights.sample(vertex.hit.point, path_, numbers[0], numbers[1], numbers[2]);
        if (!light) {
            return;
        }
        const Vec3d wi = vertex.frame.to_local(light->direction);
        if (!vertex.is_consistent(light->direction, wi)) {
            return;
        }
        const SpectralSample scattering = evaluate(vertex.bsdf, vertex.wo, wi, Transport::radiance);
        if (is_black(scattering)) {
            return;
        }
        ++result_.rays;
        if (is_occluded(*scene_.geometry, ray_origin(vertex.hit, light->direction), light->end)) {
            return;
        }
        const double by_scattering =
            light->density > 0.0 ? density(vertex.bsdf, vertex.wo, wi, Transport::radiance) : 0.0;
        const double weight = light->density > 0.0 ? light->density / (light->density + by_scattering) : 1.0;
        add(static_cast<float>(weight) * (throughput * scattering * light->value));
    }

    void note_first(const PathVertex& vertex) {
        const bool is_behind = vertex.wo.z < 0.0;
        result_.first = FirstSurface{.point = vertex.hit.point,
                                     .normal = (is_behind ? -1.0 : 1.0) * vertex.frame.z,
                                     .albedo = normal_albedo(vertex.bsdf)};
    }

    const Scene& scene_;
    const PathWavelengths& path_;
    const PathSettings& settings_;
    PathSampler& numbers_;
    PathRadiance result_;
    bool is_hero_alone_ = false;
    Vec3d from_;                       // the surface point that the ray left
    double scattering_density_ = 0.0;  // with which its direction was drawn; 0: no light sample could stand for it
};

}  // namespace

PathRadiance trace_path(const Scene& scene, const Ray<double>& ray, const PathWavelengths& path,
                        const PathSettings& settings, PathSampler& numbers) {
    return PathWalk(scene, path, settings, numbers).walk(ray);
}

}  // namespace lensproof
