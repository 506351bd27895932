#include "engine/render/integrators/path_tracer.h"

#include <cmath>

#include "engine/base/infinity.h"
#include "engine/render/integrators/mis_weight.h"

namespace lensproof::render {

namespace {

class PathWalk {
  public:
    PathWalk(const scene::Scene& scene, const spectral::PathWavelengths& path, const PathSettings& settings,
             PathSampler& numbers, const CameraRay* drawn)
        : scene_(scene), path_(path), settings_(settings), numbers_(numbers), drawn_(drawn) {}

    PathRadiance walk(Ray<double> ray) {
        spectral::SpectralSample throughput(1.0F);
        for (int bounce = 0;; ++bounce) {
            // Camera rays mostly meet something, and otherwise look up what their neighbours have.
            const scene::MapPlace ahead = bounce > 0 ? scene_.lights.expect_infinity(ray.direction) : scene::MapPlace{};
            const auto hit = scene::intersect(*scene_.geometry, ray.origin, ray.direction, 0.0, kInfinity);
            ++result_.rays;
            if (bounce == 0 && drawn_ != nullptr) {
                enter(hit ? LightOrigin{hit->point, false} : LightOrigin{-1.0 * ray.direction, true});
            }
            const bool counts = bounce >= settings_.min_bounces;
            if (!hit) {
                if (counts || settings_.shares_sky) {
                    scene_.lights.visit_infinity(
                        ray.direction, path_,
                        [&](scene::Lights::Emission light) {
                            light.radiance =
                                scene::scaled(light.radiance, counts ? 1.0 : sky_by_camera(light.start_pdf));
                            add_found(throughput, light, 1.0);
                        },
                        ahead);
                }
                break;
            }
            const auto numbers = numbers_.next();
            const auto to_light = numbers_.peek();
            scene_.lights.expect_sample(to_light[0], to_light[1], to_light[2]);
            throughput *= body_transmittance(scene_, *hit, ray.direction, path_);
            if (counts) {
                add_found(throughput, scene_.lights.emitted(*hit, from_, ray.direction, path_),
                          std::abs(dot(hit->geometric_normal, ray.direction)));
            }
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
            if (!scene::is_delta(vertex.bsdf)) {
                numbers_.skip();
                add_from_lights(vertex, to_light, throughput);
            }
            const auto turn = vertex.turn(numbers, scene::Transport::radiance);
            if (!turn) {
                break;
            }
            throughput *= turn->bsdf.weight;
            if (turn->bsdf.is_dispersed) {
                is_hero_alone_ = true;
                weight_.hero_goes_alone();
            }
            if (!survives_roulette(settings_, bounce, numbers[3], throughput)) {
                break;
            }
            weight_.turn(turn_at(vertex, *turn));
            from_ = hit->point;
            ray = vertex.ray(turn->onwards);
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
        weight_.enter(drawn_->camera->entrance_ratio(drawn_->camera->pdf(first, drawn_->ray, path_), drawn_->pdf));
    }

    /// Only as much of a turn as weights need.
    [[nodiscard]] PathTurn turn_at(const PathVertex& vertex, const PathVertex::Turn& turn) const {
        return turn.bsdf.is_delta
                   ? PathTurn{.is_delta = true,
                              .is_one_way = drawn_ != nullptr && vertex.as_from(turn.onwards, turn.bsdf.wi).is_bent}
                   : turn_at(vertex, turn.onwards, turn.bsdf.wi, turn.bsdf.pdf);
    }
    [[nodiscard]] PathTurn turn_at(const PathVertex& vertex, const Vec3d& onwards, const Vec3d& wi,
                                   double to_light) const {
        return drawn_ != nullptr ? camera_turn(vertex, onwards, wi, to_light) : PathTurn{.to_light = to_light};
    }

    /// Light that the path ran into, at `cosine` from its normal.
    void add_found(const spectral::SpectralSample& throughput, const scene::Lights::Emission& light, double cosine) {
        if (!spectral::is_black(light.radiance)) {
            add(static_cast<float>(weight_.of_hit(light, cosine)) * (throughput * light.radiance));
        }
    }

    void add_from_lights(const PathVertex& vertex, const std::array<double, PathSampler::kNumbers>& numbers,
                         const spectral::SpectralSample& throughput) {
        const auto light =
            scene_.lights.sample(vertex.hit.point, path_, numbers[0], numbers[1], numbers[2],
                                 [&](const Vec3d& direction) { return vertex.scattering(direction)[0]; });
        if (!light) {
            return;
        }
        const spectral::SpectralSample scattering = vertex.scattering(light->direction);
        if (spectral::is_black(scattering)) {
            return;
        }
        ++result_.rays;
        if (scene::is_occluded(*scene_.geometry, scene::ray_origin(vertex.hit, light->direction), light->end)) {
            return;
        }
        const Vec3d wi = vertex.frame.to_local(light->direction);
        const double to_light =
            light->pdf > 0.0 ? scene::pdf(vertex.bsdf, vertex.wo, wi, scene::Transport::radiance) : 0.0;
        const PathTurn turn = turn_at(vertex, light->direction, wi, to_light);
        const spectral::SpectralSample value = scene::light_of(light->value, light->place, path_);
        add(static_cast<float>(weight_.of_sample(*light, turn)) * (throughput * scattering * value));
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
    CameraMisWeight weight_;
    const CameraRay* drawn_;
};

}  // namespace

PathRadiance trace_path(const scene::Scene& scene, const Ray<double>& ray, const spectral::PathWavelengths& path,
                        const PathSettings& settings, PathSampler& numbers, const CameraRay* drawn) {
    return PathWalk(scene, path, settings, numbers, drawn).walk(ray);
}

PathTracer::PathTracer(const View& view, Combination combination)
    : paths_(*view.camera, view.seed,
             combination == Combination::weighed ? PathCarry::wavelengths_and_pdfs : PathCarry::wavelengths),
      view_(view),
      is_weighed_(combination == Combination::weighed) {
    if (view.has_features) {
        albedo_weights_ = view.camera->albedo_weights();
    }
}

void PathTracer::operator()(const TileSamples& samples, FilmTile& tile) {
    paths_.for_each(samples, tile, [&](const CameraPathBuffer& paths, std::size_t path, std::size_t pixel) {
        add_path(paths, path, pixel, tile);
    });
}

void PathTracer::add_path(const CameraPathBuffer& paths, std::size_t path, std::size_t pixel, FilmTile& tile) const {
    const Camera& camera = *view_.camera;
    const spectral::PathWavelengths strata = camera.grid().path(paths.wavelength[path]);
    PathSampler numbers(view_.seed, paths.pixel[path], paths.sample[path]);
    const CameraRay drawn{.camera = &camera, .ray = paths.ray(path), .pdf = is_weighed_ ? paths.pdf[path] : PathPdf{}};
    const PathRadiance found = trace_path(view_.scene(), camera.to_world(drawn.ray), strata, view_.paths, numbers,
                                          is_weighed_ ? &drawn : nullptr);
    tile.count_rays(found.rays);
    std::array<float, spectral::kWavelengthsPerPath> irradiance = paths.weights[path];
    for (std::size_t i = 0; i < irradiance.size(); ++i) {
        irradiance[i] *= found.radiance[i];
    }
    irradiance[0] += paths.hero_weight(path) * found.hero_radiance;
    tile.add(pixel, paths.sample[path], strata.index, irradiance);
    if (view_.has_features && found.first) {
        add_features(pixel, strata, *found.first, tile);
    }
}

void PathTracer::add_features(std::size_t pixel, const spectral::PathWavelengths& strata, const FirstSurface& first,
                              FilmTile& tile) const {
    Vec3d albedo;
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        albedo = albedo + (first.albedo[i] / double{spectral::kWavelengthsPerPath}) * albedo_weights_[strata.index[i]];
    }
    tile.add_features(pixel, {.depth_mm = point_before(view_.camera->pose(), first.point).z,
                              .albedo_rgb = albedo,
                              .normal = transposed_times(view_.camera->pose().linear, first.normal)});
}

}  // namespace lensproof::render
