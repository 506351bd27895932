#include "engine/render/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/scene/basis.h"

namespace lensproof {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A surface point on a path, with its scattering.
struct Vertex {
    SurfaceHit hit;
    Basis frame;  // z: the shading normal
    Vec3d wo;     // local, towards where the path comes from
    Bsdf bsdf;
};

/// Whether a direction lies on the same side of the surface by its shading normal as by its geometry: where they differ
/// light would leak through.
bool is_consistent(const Vertex& vertex, const Vec3d& world, const Vec3d& local) {
    return dot(world, vertex.hit.geometric_normal) * local.z > 0.0;
}

class PathWalk {
  public:
    PathWalk(const Scene& scene, const PathWavelengths& path, const PathSettings& settings, PathSampler& numbers)
        : scene_(scene), path_(path), settings_(settings), numbers_(numbers) {}

    PathRadiance walk(Ray<double> ray, SpectralSample throughput) {
        const float starts_with = max_value(throughput);
        bool carries_all = !is_black(throughput - hero_alone(throughput));
        for (int bounce = 0;; ++bounce) {
            const auto hit = intersect(*scene_.geometry, ray.origin, ray.direction, 0.0, kInfinity);
            ++result_.rays;
            if (!hit) {
                scene_.lights.visit_infinity(ray.direction, path_,
                                             [&](const Lights::Emission& light) { add_found(throughput, light); });
                break;
            }
            add_found(throughput, scene_.lights.emitted(*hit, from_, ray.direction, path_));
            if (bounce == settings_.max_bounces && bounce > 0) {
                break;
            }
            const Basis frame(hit->shading_normal, hit->tangent);
            const Vertex vertex{.hit = *hit,
                                .frame = frame,
                                .wo = frame.to_local(-1.0 * ray.direction),
                                .bsdf = bsdf_at(scene_.materials[hit->material], hit->uv, path_)};
            if (bounce == 0) {
                note_first(vertex);
            }
            if (bounce == settings_.max_bounces || !is_consistent(vertex, -1.0 * ray.direction, vertex.wo)) {
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
            if (!is_consistent(vertex, onwards, scattered->wi)) {
                break;
            }
            throughput *= scattered->weight;
            if (scattered->is_dispersed && carries_all) {
                throughput = static_cast<float>(kWavelengthsPerPath) * hero_alone(throughput);
                carries_all = false;
            }
            if (!survives_roulette(bounce, starts_with, numbers[3], throughput)) {
                break;
            }
            scattering_density_ = scattered->is_delta ? 0.0 : scattered->density;
            from_ = hit->point;
            ray = {ray_origin(*hit, onwards), onwards};
        }
        return result_;
    }

  private:
    /// Light that the path ran into. Sampling lights would have found it from the surface before, unless that is a
    /// mirror or the camera.
    void add_found(const SpectralSample& throughput, const Lights::Emission& light) {
        if (is_black(light.radiance)) {
            return;
        }
        const double weight =
            scattering_density_ > 0.0 ? scattering_density_ / (scattering_density_ + light.density) : 1.0;
        result_.radiance += static_cast<float>(weight) * (throughput * light.radiance);
    }

    void add_from_lights(const Vertex& vertex, const SpectralSample& throughput) {
        const auto numbers = numbers_.next();
        const auto light = scene_.lights.sample(vertex.hit.point, path_, numbers[0], numbers[1], numbers[2]);
        if (!light) {
            return;
        }
        const Vec3d wi = vertex.frame.to_local(light->direction);
        if (!is_consistent(vertex, light->direction, wi)) {
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
        result_.radiance += static_cast<float>(weight) * (throughput * scattering * light->value);
    }

    /// Scales what goes on.
    bool survives_roulette(int bounce, float starts_with, double number, SpectralSample& throughput) const {
        const float carries = max_value(throughput) / starts_with;
        if (!(carries > 0.0F)) {
            return false;
        }
        if (bounce < settings_.roulette_from || carries >= 1.0F) {
            return true;
        }
        const float survival = std::max(carries, 0.05F);
        throughput *= 1.0F / survival;
        return number < survival;
    }

    void note_first(const Vertex& vertex) {
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
    Vec3d from_;                       // the surface point that the ray left
    double scattering_density_ = 0.0;  // with which its direction was drawn; 0: no light sample could stand for it
};

}  // namespace

PathRadiance trace_path(const Scene& scene, const Ray<double>& ray, const PathWavelengths& path,
                        const SpectralSample& throughput, const PathSettings& settings, PathSampler& numbers) {
    return PathWalk(scene, path, settings, numbers).walk(ray, throughput);
}

}  // namespace lensproof
