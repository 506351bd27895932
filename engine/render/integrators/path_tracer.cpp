#include "engine/render/integrators/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/base/infinity.h"
#include "engine/render/integrators/mis_weight.h"
#include "engine/render/sampling/packet/number_kernels.h"

namespace lensproof::render {

namespace {

class PathWalk;

/// Light that reaches a path where it has arrived, if its way is free.
struct SampledLight {
    PathWalk* path = nullptr;
    spectral::SpectralSample light;  // but for what a map has at
    scene::MapPlace place;
    bool is_hero_alone = false;
};

/// What paths have sampled, and what has to be free for it to reach them.
struct SampledLights {
    std::vector<SampledLight> lights;
    std::vector<scene::Segment> segments;  // as many

    void reserve(std::size_t most) {
        lights.reserve(most);
        segments.reserve(most);
    }
    void clear() {
        lights.clear();
        segments.clear();
    }
};

/// For a surface that a path has met: the next set of its sampler's, and the set after for lights.
struct SurfaceNumbers {
    scene::BsdfNumbers bsdf;
    double roulette = 0.0;
    const scene::LightNumbers* light = nullptr;
};

/// A path on its way, between one question to the scene's geometry and the next.
class PathWalk {
  public:
    /// `result` is what the path brings, once it has ended.
    PathWalk(const scene::Scene& scene, const PathSettings& settings, const PathStart& start, PathRadiance& result)
        : scene_(&scene),
          settings_(&settings),
          start_(&start),
          result_(&result),
          path_(start.path),
          sampler_(start.numbers) {
        result.first.reset();
    }

    [[nodiscard]] PathSampler& sampler() { return sampler_; }

    /// The ray has left the scene, and a map shows its direction there.
    void leave_scene(const Ray<double>& ray, const scene::MapPlace& place) {
        end_ray({-1.0 * ray.direction, true});
        if (counts() || settings_->takes_sky_by_camera) {
            scene_->lights.visit_infinity(
                ray.direction, path_,
                [&](scene::Lights::Emission light) {
                    if (light.is_sun && bounce_ == 0 && settings_->leaves_suns_out) {
                        return;
                    }
                    light.radiance = scene::scaled(light.radiance, counts() ? 1.0 : sky_by_camera(light.start_pdf));
                    add_found(light, 1.0);
                },
                place);
        }
    }

    /// Goes on at what the ray has met. Whether the path has a next ray: `next`, which may be `ray` itself. Adds what
    /// it samples.
    bool arrive(const Ray<double>& ray, const scene::SurfaceHit& hit, const SurfaceNumbers& numbers,
                SampledLights& sampled, Ray<double>& next) {
        end_ray({hit.point, false});
        throughput_ *= body_transmittance(*scene_, hit, ray.direction, path_);
        if (counts()) {
            add_found(scene_->lights.emitted(hit, from_, ray.direction, path_),
                      std::abs(dot(hit.geometric_normal, ray.direction)));
        }
        if (bounce_ == settings_->max_bounces && bounce_ > 0) {
            return false;
        }
        const Vec3d backwards = -1.0 * ray.direction;
        const PathVertex vertex(hit, backwards, *scene_, path_);
        if (bounce_ == 0 && start_->wants_first) {
            note_first(vertex);
        }
        if (bounce_ == settings_->max_bounces || !vertex.is_consistent(backwards, vertex.wo)) {
            return false;
        }
        if (!scene::is_delta(vertex.bsdf)) {
            sampler_.skip();
            if (!is_mirror_wanted()) {
                sample_light(vertex, *numbers.light, sampled);
            }
        }
        return turn(vertex, numbers, next);
    }

    void see(const SampledLight& sampled) {
        add(scene::light_of(sampled.light, sampled.place, path_), sampled.is_hero_alone);
    }

    /// All that it samples is seen.
    void end() const {
        result_->radiance = radiance_;
        result_->hero_radiance = hero_radiance_;
        result_->rays = rays_;
    }

  private:
    [[nodiscard]] bool is_mirror_wanted() const { return bounce_ == 0 && settings_->begins_at_mirror; }
    [[nodiscard]] bool counts() const { return bounce_ >= settings_->min_bounces; }

    void end_ray(const LightOrigin& end) {
        ++rays_;
        if (bounce_ == 0 && start_->drawn != nullptr) {
            const CameraRay& drawn = *start_->drawn;
            weight_.enter(drawn.camera->entrance_ratio(drawn.camera->pdf(end, drawn.ray, path_), drawn.pdf));
        }
    }

    bool turn(const PathVertex& vertex, const SurfaceNumbers& numbers, Ray<double>& next) {
        const auto drawn = scene::sample(vertex.bsdf, vertex.wo, numbers.bsdf, scene::Transport::radiance);
        if (!drawn || (is_mirror_wanted() && !drawn->is_delta)) {
            return false;
        }
        const Vec3d onwards = vertex.frame.to_world(drawn->wi);
        if (!vertex.is_consistent(onwards, drawn->wi)) {
            return false;
        }
        throughput_ *= drawn->weight;
        if (drawn->is_dispersed) {
            is_hero_alone_ = true;
            weight_.hero_goes_alone();
        }
        if (!survives_roulette(*settings_, bounce_, numbers.roulette, throughput_)) {
            return false;
        }
        weight_.turn(weighed(vertex, *drawn, onwards));
        from_ = vertex.hit.point;
        next.origin = scene::ray_origin(vertex.hit, onwards);
        next.direction = onwards;
        ++bounce_;
        return true;
    }

    void add(const spectral::SpectralSample& light, bool is_hero_alone) {
        if (is_hero_alone) {
            hero_radiance_ += light[0];
        } else {
            radiance_ += light;
        }
    }

    /// Only as much of a turn as weights need.
    [[nodiscard]] PathTurn weighed(const PathVertex& vertex, const scene::BsdfSample& drawn,
                                   const Vec3d& onwards) const {
        return drawn.is_delta ? PathTurn{.is_delta = true,
                                         .is_from_camera_alone =
                                             start_->drawn != nullptr && vertex.as_from(onwards, drawn.wi).is_bent}
                              : weighed(vertex, onwards, drawn.wi, drawn.pdf);
    }
    [[nodiscard]] PathTurn weighed(const PathVertex& vertex, const Vec3d& onwards, const Vec3d& wi,
                                   double to_light) const {
        return start_->drawn != nullptr ? camera_turn(vertex, onwards, wi, to_light) : PathTurn{.to_light = to_light};
    }

    /// Light that the path ran into, at `cosine` from its normal.
    void add_found(const scene::Lights::Emission& light, double cosine) {
        if (!spectral::is_black(light.radiance)) {
            add(static_cast<float>(weight_.of_hit(light, cosine)) * (throughput_ * light.radiance), is_hero_alone_);
        }
    }

    void sample_light(const PathVertex& vertex, const scene::LightNumbers& numbers, SampledLights& sampled) {
        const auto light = scene_->lights.sample(
            vertex.hit.point, path_, numbers, [&](const Vec3d& direction) { return vertex.scattering(direction)[0]; });
        if (!light) {
            return;
        }
        const spectral::SpectralSample scattering = vertex.scattering(light->direction);
        if (spectral::is_black(scattering)) {
            return;
        }
        scene::fetch(light->place);
        ++rays_;
        const Vec3d wi = vertex.frame.to_local(light->direction);
        const double to_light =
            light->pdf > 0.0 ? scene::pdf(vertex.bsdf, vertex.wo, wi, scene::Transport::radiance) : 0.0;
        const double weight = weight_.of_sample(*light, weighed(vertex, light->direction, wi, to_light));
        scene::Segment& segment = sampled.segments.emplace_back();
        segment.from = scene::ray_origin(vertex.hit, light->direction);
        segment.to = light->end;
        SampledLight& added = sampled.lights.emplace_back();
        added.path = this;
        added.light = static_cast<float>(weight) * (throughput_ * scattering * light->value);
        added.place = light->place;
        added.is_hero_alone = is_hero_alone_;
    }

    void note_first(const PathVertex& vertex) {
        const bool is_behind = vertex.wo.z < 0.0;
        result_->first = FirstSurface{.point = vertex.hit.point,
                                      .normal = (is_behind ? -1.0 : 1.0) * vertex.frame.z,
                                      .albedo = scene::normal_albedo(vertex.bsdf)};
    }

    const scene::Scene* scene_;
    const PathSettings* settings_;
    const PathStart* start_;
    PathRadiance* result_;
    spectral::PathWavelengths path_;
    PathSampler sampler_;
    Vec3d from_;  // the surface point that the ray left
    int bounce_ = 0;
    bool is_hero_alone_ = false;
    spectral::SpectralSample throughput_{1.0F};
    CameraMisWeight weight_;
    spectral::SpectralSample radiance_;  // as PathRadiance has them
    float hero_radiance_ = 0.0F;
    std::uint32_t rays_ = 0;
};

/// The numbers of some paths, of those that have met something, drawn together.
class ArrivalNumbers {
  public:
    static constexpr std::size_t kMost = NumberColumns::kMost;

    void draw(const scene::Lights& lights, std::span<PathWalk* const> walks,
              std::span<const std::optional<scene::SurfaceHit>> hits) {
        std::array<Vec3d, kMost> points;
        std::size_t count = 0;
        columns_.size = 0;
        for (std::size_t i = 0; i < walks.size(); ++i) {
            if (hits[i]) {
                points[count++] = hits[i]->point;
                columns_.add(walks[i]->sampler());
                walks[i]->sampler().skip();
            }
        }
        number_kernels().draw(columns_);
        for (std::size_t k = 0; k < count; ++k) {
            const auto& u = columns_.after;
            light_[k] = {.of_light = u[0][k], .of_point = {u[1][k], u[2][k]}};
        }
        lights.draw_ahead(std::span(points).first(count), std::span(light_).first(count));
    }

    /// Of the k-th that has met something.
    [[nodiscard]] SurfaceNumbers operator[](std::size_t k) const {
        const auto& u = columns_.next;
        return {
            .bsdf = {u[0][k], u[1][k], u[2][k], columns_.matt_direction(k)}, .roulette = u[3][k], .light = &light_[k]};
    }

  private:
    NumberColumns columns_;
    std::array<scene::LightNumbers, kMost> light_;
};

/// Where it shows the directions of rays that have met nothing.
void find_in(const scene::Environment& map, std::span<const Ray<double>> rays,
             std::span<const std::optional<scene::SurfaceHit>> hits, std::span<scene::MapPlace> places) {
    constexpr std::size_t kMost = 64;
    std::array<std::size_t, kMost> leaving{};
    std::array<Vec3d, kMost> directions;
    std::array<scene::MapPlace, kMost> found;
    for (std::size_t i = 0; i < rays.size();) {
        std::size_t count = 0;
        for (; i < rays.size() && count < kMost; ++i) {
            if (!hits[i]) {
                directions[count] = rays[i].direction;
                leaving[count++] = i;
            }
        }
        map.find(std::span(directions).first(count), found);
        for (std::size_t k = 0; k < count; ++k) {
            places[leaving[k]] = found[k];
        }
    }
}

}  // namespace

void trace_paths(const scene::Scene& scene, const PathSettings& settings, std::span<const PathStart> starts,
                 std::span<PathRadiance> found) {
    // On their way at a time: enough for whole packets and for memory to be asked ahead, few enough for the caches.
    constexpr std::size_t kTogether = 128;
    const std::size_t together = std::min(kTogether, starts.size());
    std::vector<PathWalk> walks;
    walks.reserve(together);
    std::vector<PathWalk*> going;
    going.reserve(together);
    std::vector<Ray<double>> rays;  // theirs
    rays.reserve(together);
    std::size_t begun = 0;
    for (; begun < together; ++begun) {
        going.push_back(&walks.emplace_back(scene, settings, starts[begun], found[begun]));
        rays.push_back(starts[begun].ray);
    }
    std::vector<PathWalk*> ended;
    ended.reserve(together);
    std::vector<std::optional<scene::SurfaceHit>> hits(together);
    std::vector<scene::MapPlace> places(together);
    ArrivalNumbers numbers;
    SampledLights sampled;
    sampled.reserve(together);
    std::vector<std::uint8_t> are_blocked(together);
    while (!going.empty()) {
        scene::intersect(*scene.geometry, rays, hits);
        if (const scene::Environment* map = scene.lights.map()) {
            find_in(*map, rays, hits, places);
        }
        sampled.clear();
        ended.clear();
        std::size_t still_going = 0;
        for (std::size_t first = 0; first < going.size(); first += ArrivalNumbers::kMost) {
            const std::size_t count = std::min(ArrivalNumbers::kMost, going.size() - first);
            numbers.draw(scene.lights, std::span(going).subspan(first, count), std::span(hits).subspan(first, count));
            for (std::size_t i = first, k = 0; i < first + count; ++i) {
                PathWalk* walk = going[i];
                if (!hits[i]) {
                    walk->leave_scene(rays[i], places[i]);
                    ended.push_back(walk);
                } else if (walk->arrive(rays[i], *hits[i], numbers[k++], sampled, rays[still_going])) {
                    going[still_going++] = walk;
                } else {
                    ended.push_back(walk);
                }
            }
        }
        going.resize(still_going);
        rays.resize(still_going);
        scene::find_occluded(*scene.geometry, sampled.segments, are_blocked);
        for (std::size_t i = 0; i < sampled.lights.size(); ++i) {
            if (are_blocked[i] == 0) {
                sampled.lights[i].path->see(sampled.lights[i]);
            }
        }
        for (PathWalk* walk : ended) {
            walk->end();
            if (begun < starts.size()) {
                going.push_back(std::construct_at(walk, scene, settings, starts[begun], found[begun]));
                rays.push_back(starts[begun++].ray);
            }
        }
    }
}

PathRadiance trace_path(const scene::Scene& scene, const Ray<double>& ray, const spectral::PathWavelengths& path,
                        const PathSettings& settings, PathSampler& numbers) {
    const PathStart start{.ray = ray, .path = path, .numbers = numbers};
    PathRadiance found;
    PathWalk walk(scene, settings, start, found);
    Ray<double> next = ray;
    SampledLights sampled;
    for (bool is_going = true; is_going;) {
        const auto hit = scene::intersect(*scene.geometry, next.origin, next.direction, 0.0, kInfinity);
        if (!hit) {
            walk.leave_scene(next, {});
            break;
        }
        const auto u = walk.sampler().next();
        const auto after = walk.sampler().peek();
        const scene::LightNumbers light{.of_light = after[0], .of_point = {after[1], after[2]}};
        is_going = walk.arrive(
            next, *hit, {.bsdf = {u[0], u[1], u[2], cosine_direction(u[1], u[2])}, .roulette = u[3], .light = &light},
            sampled, next);
        for (std::size_t i = 0; i < sampled.lights.size(); ++i) {
            if (!scene::is_occluded(*scene.geometry, sampled.segments[i].from, sampled.segments[i].to)) {
                walk.see(sampled.lights[i]);
            }
        }
        sampled.clear();
    }
    walk.end();
    numbers = walk.sampler();
    return found;
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
        start(paths, path, pixel);
        if (starts_.size() == kBatch) {
            add_batch(tile);
        }
    });
    add_batch(tile);
}

void PathTracer::start(const CameraPathBuffer& paths, std::size_t path, std::size_t pixel) {
    const Ray<double> ray = paths.ray(path);
    samples_.push_back({.pixel = pixel,
                        .sample = paths.sample[path],
                        .weights = paths.weights[path],
                        .hero_weight = paths.hero_weight(path)});
    if (is_weighed_) {
        drawn_.push_back({.camera = view_.camera, .ray = ray, .pdf = paths.pdf[path]});
    }
    starts_.push_back({.ray = view_.camera->to_world(ray),
                       .path = view_.camera->grid().path(paths.wavelength[path]),
                       .numbers = PathSampler(view_.seed, paths.pixel[path], paths.sample[path]),
                       .wants_first = view_.has_features});
}

void PathTracer::add_batch(FilmTile& tile) {
    for (std::size_t i = 0; i < drawn_.size(); ++i) {
        starts_[i].drawn = &drawn_[i];
    }
    found_.resize(starts_.size());
    trace_paths(view_.scene(), view_.paths, starts_, found_);
    for (std::size_t i = 0; i < starts_.size(); ++i) {
        add(i, tile);
    }
    samples_.clear();
    drawn_.clear();
    starts_.clear();
}

void PathTracer::add(std::size_t i, FilmTile& tile) const {
    const Sample& sample = samples_[i];
    const PathRadiance& found = found_[i];
    const spectral::PathWavelengths& path = starts_[i].path;
    tile.count_rays(found.rays);
    std::array<float, spectral::kWavelengthsPerPath> irradiance = sample.weights;
    for (std::size_t m = 0; m < irradiance.size(); ++m) {
        irradiance[m] *= found.radiance[m];
    }
    irradiance[0] += sample.hero_weight * found.hero_radiance;
    tile.add(sample.pixel, sample.sample, path.index, irradiance);
    if (found.first) {
        add_features(sample.pixel, path, *found.first, tile);
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
