#include "engine/render/integrators/path_tracer.h"

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"
#include "engine/render/integrators/mis_weight.h"
#include "engine/render/sampling/packet/number_kernels.h"

namespace lensproof::render {

namespace {

/// A path on its way, between one question to the scene's geometry and the next.
class PathWalk {
  public:
    PathWalk(const scene::Scene& scene, const PathSettings& settings, PathStart& start)
        : scene_(&scene), settings_(&settings), start_(&start), ray_(start.ray) {}

    [[nodiscard]] const Ray<double>& ray() const { return ray_; }

    /// The ray has left the scene, and a map shows its direction there.
    void leave_at(const scene::MapPlace& place) { ahead_ = place; }

    [[nodiscard]] PathSampler& sampler() { return start_->numbers; }
    using Numbers = std::array<double, PathSampler::kNumbers>;
    /// Takes the numbers for a surface that the ray has met: the next set of its sampler's, and the one after for
    /// lights, of which it returns where they lie.
    scene::LightNumbers* take_numbers(const Numbers& numbers, const Numbers& for_lights) {
        numbers_ = numbers;
        light_numbers_ = {for_lights[0], {for_lights[1], for_lights[2]}};
        return &light_numbers_;
    }

    /// Goes on at what the ray has met. Whether the path has another ray.
    bool arrive(const std::optional<scene::SurfaceHit>& hit) {
        sampled_.reset();
        ++result_.rays;
        if (bounce_ == 0 && start_->drawn != nullptr) {
            enter(hit ? LightOrigin{hit->point, false} : LightOrigin{-1.0 * ray_.direction, true});
        }
        if (hit) {
            return turn_at(*hit);
        }
        leave_scene();
        return false;
    }

    /// What has to be free for a light to be seen from where the path has arrived. Nothing: it sees none.
    [[nodiscard]] const scene::Segment* to_light() const { return sampled_ ? &sampled_->segment : nullptr; }
    void see_light() { add(scene::light_of(sampled_->light, sampled_->place, start_->path), sampled_->is_hero_alone); }

    [[nodiscard]] const PathRadiance& result() const { return result_; }

  private:
    [[nodiscard]] bool is_mirror_wanted() const { return bounce_ == 0 && settings_->begins_at_mirror; }
    [[nodiscard]] bool counts() const { return bounce_ >= settings_->min_bounces; }

    void leave_scene() {
        if (counts() || settings_->takes_sky_by_camera) {
            scene_->lights.visit_infinity(
                ray_.direction, start_->path,
                [&](scene::Lights::Emission light) {
                    if (light.is_sun && bounce_ == 0 && settings_->leaves_suns_out) {
                        return;
                    }
                    light.radiance = scene::scaled(light.radiance, counts() ? 1.0 : sky_by_camera(light.start_pdf));
                    add_found(light, 1.0);
                },
                ahead_);
        }
    }

    bool turn_at(const scene::SurfaceHit& hit) {
        throughput_ *= body_transmittance(*scene_, hit, ray_.direction, start_->path);
        if (counts()) {
            add_found(scene_->lights.emitted(hit, from_, ray_.direction, start_->path),
                      std::abs(dot(hit.geometric_normal, ray_.direction)));
        }
        if (bounce_ == settings_->max_bounces && bounce_ > 0) {
            return false;
        }
        const Vec3d backwards = -1.0 * ray_.direction;
        const PathVertex vertex(hit, backwards, *scene_, start_->path);
        if (bounce_ == 0) {
            note_first(vertex);
        }
        if (bounce_ == settings_->max_bounces || !vertex.is_consistent(backwards, vertex.wo)) {
            return false;
        }
        if (!scene::is_delta(vertex.bsdf)) {
            start_->numbers.skip();
            if (!is_mirror_wanted()) {
                sample_light(vertex);
            }
        }
        return turn(vertex);
    }

    bool turn(const PathVertex& vertex) {
        const auto turn = vertex.turn(numbers_, scene::Transport::radiance);
        if (!turn || (is_mirror_wanted() && !turn->bsdf.is_delta)) {
            return false;
        }
        throughput_ *= turn->bsdf.weight;
        if (turn->bsdf.is_dispersed) {
            is_hero_alone_ = true;
            weight_.hero_goes_alone();
        }
        if (!survives_roulette(*settings_, bounce_, numbers_[3], throughput_)) {
            return false;
        }
        weight_.turn(weighed(vertex, *turn));
        from_ = vertex.hit.point;
        ray_ = vertex.ray(turn->onwards);
        ++bounce_;
        return true;
    }

    void add(const spectral::SpectralSample& light, bool is_hero_alone) {
        if (is_hero_alone) {
            result_.hero_radiance += light[0];
        } else {
            result_.radiance += light;
        }
    }

    void enter(const LightOrigin& first) {
        const CameraRay& drawn = *start_->drawn;
        weight_.enter(drawn.camera->entrance_ratio(drawn.camera->pdf(first, drawn.ray, start_->path), drawn.pdf));
    }

    /// Only as much of a turn as weights need.
    [[nodiscard]] PathTurn weighed(const PathVertex& vertex, const PathVertex::Turn& turn) const {
        return turn.bsdf.is_delta ? PathTurn{.is_delta = true,
                                             .is_from_camera_alone = start_->drawn != nullptr &&
                                                                     vertex.as_from(turn.onwards, turn.bsdf.wi).is_bent}
                                  : weighed(vertex, turn.onwards, turn.bsdf.wi, turn.bsdf.pdf);
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

    void sample_light(const PathVertex& vertex) {
        const auto light =
            scene_->lights.sample(vertex.hit.point, start_->path, light_numbers_,
                                  [&](const Vec3d& direction) { return vertex.scattering(direction)[0]; });
        if (!light) {
            return;
        }
        const spectral::SpectralSample scattering = vertex.scattering(light->direction);
        if (spectral::is_black(scattering)) {
            return;
        }
        scene::fetch(light->place);
        ++result_.rays;
        const Vec3d wi = vertex.frame.to_local(light->direction);
        const double to_light =
            light->pdf > 0.0 ? scene::pdf(vertex.bsdf, vertex.wo, wi, scene::Transport::radiance) : 0.0;
        const double weight = weight_.of_sample(*light, weighed(vertex, light->direction, wi, to_light));
        sampled_ = {.segment = {scene::ray_origin(vertex.hit, light->direction), light->end},
                    .light = static_cast<float>(weight) * (throughput_ * scattering * light->value),
                    .place = light->place,
                    .is_hero_alone = is_hero_alone_};
    }

    void note_first(const PathVertex& vertex) {
        const bool is_behind = vertex.wo.z < 0.0;
        result_.first = FirstSurface{.point = vertex.hit.point,
                                     .normal = (is_behind ? -1.0 : 1.0) * vertex.frame.z,
                                     .albedo = scene::normal_albedo(vertex.bsdf)};
    }

    /// Light that reaches the path where it has arrived, if its way is free.
    struct SampledLight {
        scene::Segment segment;
        spectral::SpectralSample light;  // but for what a map has at
        scene::MapPlace place;
        bool is_hero_alone = false;
    };

    const scene::Scene* scene_;
    const PathSettings* settings_;
    PathStart* start_;
    Ray<double> ray_;
    Vec3d from_;  // the surface point that the ray left
    int bounce_ = 0;
    bool is_hero_alone_ = false;
    spectral::SpectralSample throughput_{1.0F};
    CameraMisWeight weight_;
    scene::MapPlace ahead_;
    Numbers numbers_{};
    scene::LightNumbers light_numbers_;
    std::optional<SampledLight> sampled_;
    PathRadiance result_;
};

/// To the walks that have met something.
void give_numbers(const scene::Lights& lights, std::span<PathWalk* const> walks,
                  std::span<const std::optional<scene::SurfaceHit>> hits) {
    constexpr std::size_t kWalks = NumberColumns::kMost / 2;
    NumberColumns columns;
    std::array<scene::LightNumbers*, kWalks> for_lights{};
    for (std::size_t first = 0; first < walks.size(); first += kWalks) {
        const std::size_t end = std::min(walks.size(), first + kWalks);
        columns.size = 0;
        for (std::size_t i = first; i < end; ++i) {
            if (hits[i]) {
                columns.add(walks[i]->sampler(), 1);
                columns.add(walks[i]->sampler(), 2);
            }
        }
        number_kernels().draw(columns);
        std::size_t column = 0;
        for (std::size_t i = first; i < end; ++i) {
            if (hits[i]) {
                walks[i]->sampler().skip();
                for_lights[column / 2] = walks[i]->take_numbers(columns.numbers(column), columns.numbers(column + 1));
                column += 2;
            }
        }
        lights.draw_ahead(std::span(for_lights).first(column / 2));
    }
}

/// Of the walks that have met nothing.
void find_in(const scene::Environment& map, std::span<PathWalk* const> walks,
             std::span<const std::optional<scene::SurfaceHit>> hits) {
    constexpr std::size_t kMost = 64;
    std::array<PathWalk*, kMost> leaving{};
    std::array<Vec3d, kMost> directions;
    std::array<scene::MapPlace, kMost> places;
    for (std::size_t i = 0; i < walks.size();) {
        std::size_t count = 0;
        for (; i < walks.size() && count < kMost; ++i) {
            if (!hits[i]) {
                directions[count] = walks[i]->ray().direction;
                leaving[count++] = walks[i];
            }
        }
        map.find(std::span(directions).first(count), places);
        for (std::size_t k = 0; k < count; ++k) {
            leaving[k]->leave_at(places[k]);
        }
    }
}

}  // namespace

void trace_paths(const scene::Scene& scene, const PathSettings& settings, std::span<PathStart> starts,
                 std::span<PathRadiance> found) {
    std::vector<PathWalk> walks;
    walks.reserve(starts.size());
    std::vector<PathWalk*> going;
    going.reserve(starts.size());
    for (PathStart& start : starts) {
        going.push_back(&walks.emplace_back(scene, settings, start));
    }
    std::vector<Ray<double>> rays;
    std::vector<std::optional<scene::SurfaceHit>> hits(starts.size());
    std::vector<PathWalk*> seeing;
    std::vector<scene::Segment> segments;
    std::vector<std::uint8_t> are_blocked(starts.size());
    while (!going.empty()) {
        rays.clear();
        for (PathWalk* walk : going) {
            rays.push_back(walk->ray());
        }
        scene::intersect(*scene.geometry, rays, hits);
        if (const scene::Environment* map = scene.lights.map()) {
            find_in(*map, going, hits);
        }
        give_numbers(scene.lights, going, hits);
        seeing.clear();
        segments.clear();
        std::size_t still_going = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            PathWalk* walk = going[i];
            if (walk->arrive(hits[i])) {
                going[still_going++] = walk;
            }
            if (const scene::Segment* segment = walk->to_light()) {
                seeing.push_back(walk);
                segments.push_back(*segment);
            }
        }
        going.resize(still_going);
        scene::find_occluded(*scene.geometry, segments, are_blocked);
        for (std::size_t i = 0; i < segments.size(); ++i) {
            if (are_blocked[i] == 0) {
                seeing[i]->see_light();
            }
        }
    }
    std::ranges::transform(walks, found.begin(), [](const PathWalk& walk) { return walk.result(); });
}

PathRadiance trace_path(const scene::Scene& scene, const Ray<double>& ray, const spectral::PathWavelengths& path,
                        const PathSettings& settings, PathSampler& numbers) {
    PathStart start{.ray = ray, .path = path, .numbers = numbers};
    PathWalk walk(scene, settings, start);
    for (bool is_going = true; is_going;) {
        const auto [origin, direction] = walk.ray();
        const auto hit = scene::intersect(*scene.geometry, origin, direction, 0.0, kInfinity);
        if (hit) {
            const PathWalk::Numbers next = walk.sampler().next();
            walk.take_numbers(next, walk.sampler().peek());
        }
        is_going = walk.arrive(hit);
        const scene::Segment* segment = walk.to_light();
        if (segment != nullptr && !scene::is_occluded(*scene.geometry, segment->from, segment->to)) {
            walk.see_light();
        }
    }
    numbers = start.numbers;
    return walk.result();
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
        batch_.push_back(sample_of(paths, path, pixel));
        if (batch_.size() == kPathBatch) {
            add_batch(tile);
        }
    });
    add_batch(tile);
}

PathTracer::Sample PathTracer::sample_of(const CameraPathBuffer& paths, std::size_t path, std::size_t pixel) const {
    return {.pixel = pixel,
            .sample = paths.sample[path],
            .wavelengths = view_.camera->grid().path(paths.wavelength[path]),
            .numbers = PathSampler(view_.seed, paths.pixel[path], paths.sample[path]),
            .weights = paths.weights[path],
            .hero_weight = paths.hero_weight(path),
            .ray = {.camera = view_.camera, .ray = paths.ray(path), .pdf = is_weighed_ ? paths.pdf[path] : PathPdf{}}};
}

void PathTracer::add_batch(FilmTile& tile) {
    starts_.clear();
    for (const Sample& sample : batch_) {
        starts_.push_back({.ray = view_.camera->to_world(sample.ray.ray),
                           .path = sample.wavelengths,
                           .numbers = sample.numbers,
                           .drawn = is_weighed_ ? &sample.ray : nullptr});
    }
    found_.resize(batch_.size());
    trace_paths(view_.scene(), view_.paths, starts_, found_);
    for (std::size_t i = 0; i < batch_.size(); ++i) {
        add(batch_[i], found_[i], tile);
    }
    batch_.clear();
}

void PathTracer::add(const Sample& sample, const PathRadiance& found, FilmTile& tile) const {
    tile.count_rays(found.rays);
    std::array<float, spectral::kWavelengthsPerPath> irradiance = sample.weights;
    for (std::size_t i = 0; i < irradiance.size(); ++i) {
        irradiance[i] *= found.radiance[i];
    }
    irradiance[0] += sample.hero_weight * found.hero_radiance;
    tile.add(sample.pixel, sample.sample, sample.wavelengths.index, irradiance);
    if (view_.has_features && found.first) {
        add_features(sample.pixel, sample.wavelengths, *found.first, tile);
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
