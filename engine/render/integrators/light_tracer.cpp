#include "engine/render/integrators/light_tracer.h"

#include <cmath>

#include "engine/base/infinity.h"
#include "engine/render/integrators/mis_weight.h"

namespace lensproof::render {

namespace {

constexpr double kSquareMetresPerSquareMm = 1e-6;

class LightWalk {
  public:
    LightWalk(const View& view, const spectral::PathWavelengths& path, PathSampler& numbers, FilmTile& tile,
              bool is_weighed)
        : scene_(view.scene()),
          camera_(*view.camera),
          path_(path),
          settings_(view.paths),
          numbers_(numbers),
          tile_(tile),
          is_weighed_(is_weighed) {}

    /// Returns how many rays were traced, in the scene and into the camera.
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
            throughput *= body_transmittance(scene_, *hit, ray.direction, path_);
            const PathVertex vertex(*hit, -1.0 * ray.direction, scene_, path_);
            if (!vertex.is_consistent(-1.0 * ray.direction, vertex.wo)) {
                return;
            }
            if (bounce == 1 && is_weighed_) {
                weight_.leave(scene_.lights.first_segment(start, hit->point));
            }
            if (!scene::is_delta(vertex.bsdf)) {
                join_from_surface(vertex, light.power * throughput);
            }
            if (bounce == settings_.max_bounces) {
                return;
            }
            const auto numbers = numbers_.next();
            const auto turn = vertex.turn(numbers, scene::Transport::importance);
            if (!turn) {
                return;
            }
            const auto& [scattered, onwards] = *turn;
            throughput *=
                scattered.weight * spectral::SpectralSample(shading_correction(vertex, onwards, scattered.wi));
            if (scattered.is_dispersed && !is_hero_alone_) {
                throughput = static_cast<float>(spectral::kWavelengthsPerPath) * spectral::hero_alone(throughput);
                is_hero_alone_ = true;
            }
            if (is_weighed_) {
                weight_.turn(scattered.is_delta ? PathTurn{.is_delta = true}
                                                : light_turn(vertex, onwards, scattered.wi, scattered.pdf));
            }
            if (!survives_roulette(settings_, bounce, numbers[3], throughput)) {
                return;
            }
            ray = vertex.ray(onwards);
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
        join(from, [&](const LensSample& in) {
            if (start.is_at_infinity) {
                return Carried{.light = is_blocked(in.end - scene_.lights.beyond_mm(in.end) * start.direction, in.end)
                                            ? spectral::SpectralSample()
                                            : start.value,
                               .others = LightMisWeight::others(start, 1.0)};
            }
            const spectral::SpectralSample intensity = scene_.lights.intensity(start, in.direction);
            const Vec3d origin = scene::ray_origin(start.point, start.normal, start.error_mm, in.direction);
            return Carried{.light = spectral::is_black(intensity) || is_blocked(origin, in.end)
                                        ? spectral::SpectralSample()
                                        : intensity,
                           .others = LightMisWeight::others(start, std::abs(dot(start.normal, in.direction)))};
        });
    }

    void join_from_surface(const PathVertex& vertex, const spectral::SpectralSample& power) {
        join({vertex.hit.point, false}, [&](const LensSample& in) -> Carried {
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

    /// What goes along a ray into the camera: an intensity from a point, from far off an irradiance; and the pdfs of
    /// the other techniques to make the path (LightMisWeight).
    struct Carried {
        spectral::SpectralSample light;
        double others = 0.0;
    };

    /// Draws a ray into the camera and brings its light to the film.
    template <class CarriedBy>
    void join(const LightOrigin& from, const CarriedBy& carried_by) {
        const auto u = numbers_.next();
        const auto in = camera_.sample(from, path_, u[0], u[1]);
        if (!in) {
            return;
        }
        const FilmImportance film = camera_.importance(in->ray, path_);
        rays_ += spectral::kWavelengthsPerPath;
        if (film.is_dark()) {
            return;
        }
        const Carried carried = carried_by(*in);
        if (spectral::is_black(carried.light)) {
            return;
        }
        const double entrance = is_hero_alone_ ? in->pdf.hero : in->pdf.shared;
        const double pitch_m = 1e-3 * camera_.sensor().pixel_pitch_mm;
        const double to_irradiance = (from.is_far ? kSquareMetresPerSquareMm : 1.0) / (entrance * pitch_m * pitch_m);
        std::array<float, spectral::kWavelengthsPerPath> irradiance{};
        for (std::size_t i = 0; i < irradiance.size(); ++i) {
            if (film.transmittance[i] > 0.0) {
                irradiance[i] = static_cast<float>(to_irradiance * film.transmittance[i] * carried.light[i] *
                                                   mis_weight(film, i, entrance, carried.others));
            }
        }
        tile_.splat(film.at_px, path_.index, irradiance);
    }

    /// Of the path at a wavelength, as it comes about here.
    [[nodiscard]] double mis_weight(const FilmImportance& film, std::size_t wavelength, double entrance,
                                    double others) const {
        if (!is_weighed_) {
            return 1.0;
        }
        const double drawn = is_hero_alone_ ? film.pdf[wavelength] : film.shared_pdf(wavelength);
        return LightMisWeight::weight(others, drawn / (camera_.film_area_mm2() * entrance));
    }

    bool is_blocked(const Vec3d& from, const Vec3d& to) {
        ++rays_;
        return scene::is_occluded(*scene_.geometry, from, to);
    }

    const scene::Scene& scene_;
    const Camera& camera_;
    const spectral::PathWavelengths& path_;
    const PathSettings& settings_;
    PathSampler& numbers_;
    FilmTile& tile_;
    LightMisWeight weight_;
    std::uint32_t rays_ = 0;
    bool is_weighed_;
    bool is_hero_alone_ = false;
};

}  // namespace

// Light paths have numbers of their own: those of camera paths of the same sample would go with them.
LightTracer::LightTracer(const View& view, Combination combination)
    : view_(view),
      is_weighed_(combination == Combination::weighed),
      seed_(sampler_detail::mixed(view.seed ^ 0xbb67ae8584caa73bULL)) {}

void LightTracer::operator()(const TileSamples& samples, FilmTile& tile) const {
    const PixelRect& rect = samples.rect;
    const spectral::SpectralGrid& grid = view_.camera->grid();
    for (int y = rect.y; y < rect.y + rect.height; ++y) {
        for (int x = rect.x; x < rect.x + rect.width; ++x) {
            const auto pixel = static_cast<std::uint32_t>(y * view_.camera->sensor().width + x);
            for (std::uint32_t sample = samples.first; sample < samples.end; ++sample) {
                PathSampler numbers(seed_, pixel, sample);
                const spectral::PathWavelengths strata = grid.path(static_cast<int>(numbers.next()[0] * grid.size()));
                tile.begin_light_path();
                tile.count_rays(LightWalk(view_, strata, numbers, tile, is_weighed_).walk());
            }
        }
    }
}

}  // namespace lensproof::render
