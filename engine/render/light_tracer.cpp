#include "engine/render/light_tracer.h"

#include <cmath>
#include <limits>
#include <optional>

#include "engine/render/path_vertex.h"

namespace lensproof {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSquareMetresPerSquareMm = 1e-6;

class LightWalk {
  public:
    LightWalk(const Scene& scene, const LensEntrance& entrance, const PathWavelengths& path,
              const PathSettings& settings, PathSampler& numbers, FilmTile& tile)
        : scene_(scene), entrance_(entrance), path_(path), settings_(settings), numbers_(numbers), tile_(tile) {}

    std::uint32_t walk() {
        const auto begin = numbers_.next();
        const LightStart start = scene_.lights.start(path_, begin[0], begin[1], begin[2]);
        join_from_light(start);
        if (settings_.max_bounces > 0) {
            const auto onwards = numbers_.next();
            scatter(scene_.lights.leave(start, onwards[0], onwards[1]));
        }
        return rays_;
    }

  private:
    /// Carries on from surface to surface, and joins the lens from each.
    void scatter(EmittedRay light) {
        Ray<double> ray = light.ray;
        SpectralSample throughput(1.0F);
        for (int bounce = 1; max_value(light.power) > 0.0F; ++bounce) {
            const auto hit = intersect(*scene_.geometry, ray.origin, ray.direction, 0.0, kInfinity);
            ++rays_;
            if (!hit) {
                return;
            }
            throughput *= passes_body(scene_, *hit, ray.direction, path_);
            const PathVertex vertex(*hit, -1.0 * ray.direction, scene_, path_);
            if (!vertex.is_consistent(-1.0 * ray.direction, vertex.wo)) {
                return;
            }
            if (!is_delta(vertex.bsdf)) {
                join_from_surface(vertex, light.power * throughput);
            }
            if (bounce == settings_.max_bounces) {
                return;
            }
            const auto numbers = numbers_.next();
            const auto scattered =
                sample(vertex.bsdf, vertex.wo, numbers[0], numbers[1], numbers[2], Transport::importance);
            if (!scattered) {
                return;
            }
            const Vec3d onwards = vertex.frame.to_world(scattered->wi);
            if (!vertex.is_consistent(onwards, scattered->wi)) {
                return;
            }
            throughput *= scattered->weight * SpectralSample(shading_correction(vertex, onwards, scattered->wi));
            if (scattered->is_dispersed && !is_hero_alone_) {
                throughput = static_cast<float>(kWavelengthsPerPath) * hero_alone(throughput);
                is_hero_alone_ = true;
            }
            if (!survives_roulette(settings_, bounce, numbers[3], throughput)) {
                return;
            }
            ray = {ray_origin(*hit, onwards), onwards};
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

    void join_from_light(const LightStart& start) {
        const auto u = numbers_.next();
        if (start.is_at_infinity) {
            const EntranceBeam beam = beam_along(entrance_.front, to_lens(start.direction));
            join(beam, u[0], u[1], [&](const Ray<double>& ray, double) {
                const Vec3d end = from_lens(ray.origin);
                return is_blocked(end - scene_.lights.beyond_mm(end) * start.direction, end) ? SpectralSample()
                                                                                             : start.value;
            });
            return;
        }
        const auto beam = beam_from(entrance_.front, to_lens_point(start.point));
        if (beam) {
            join(*beam, u[0], u[1], [&](const Ray<double>& ray, double distance) {
                const Vec3d direction = direction_from_lens(ray.direction);
                const SpectralSample intensity = scene_.lights.intensity(start, direction);
                const Vec3d from = ray_origin(start.point, start.normal, start.error_mm, direction);
                return is_black(intensity) || is_blocked(from, start.point + distance * direction) ? SpectralSample()
                                                                                                   : intensity;
            });
        }
    }

    void join_from_surface(const PathVertex& vertex, const SpectralSample& power) {
        const auto u = numbers_.next();
        const auto beam = beam_from(entrance_.front, to_lens_point(vertex.hit.point));
        if (!beam) {
            return;
        }
        join(*beam, u[0], u[1], [&](const Ray<double>& ray, double distance) {
            const Vec3d direction = direction_from_lens(ray.direction);
            const Vec3d wi = vertex.frame.to_local(direction);
            if (!vertex.is_consistent(direction, wi)) {
                return SpectralSample();
            }
            const SpectralSample scattered = evaluate(vertex.bsdf, vertex.wo, wi, Transport::importance);
            if (is_black(scattered) ||
                is_blocked(ray_origin(vertex.hit, direction), vertex.hit.point + distance * direction)) {
                return SpectralSample();
            }
            return power * scattered * SpectralSample(shading_correction(vertex, direction, wi));
        });
    }

    /// Draws a ray of the beam and brings its light to the film; `light(ray, distance)` is what it carries: an
    /// intensity from a point, from far off an irradiance. `distance` is that from the point to the beam's plane.
    template <class LightOf>
    void join(const EntranceBeam& beam, double u, double v, const LightOf& light) {
        if (!(beam.axis.direction.z > -1.0)) {
            return;  // from straight behind, where beams have no frame
        }
        const EntranceBeam far_beam = entrance_.map->beam(beam.axis.direction);
        const EntranceSample drawn = entrance_.map->sample(far_beam, band_position(0), u, v);
        if (!(drawn.density > 0.0)) {
            return;
        }
        const Ray<double> ray = beam.ray(drawn.offset);
        const bool is_far = !std::isfinite(beam.distance);
        const double per_mm2 = is_far ? kSquareMetresPerSquareMm : beam.solid_angle_per_mm2(drawn.offset);
        std::array<std::optional<Vec2d>, kWavelengthsPerPath> film;
        std::array<double, kWavelengthsPerPath> share{};
        bool arrives = false;
        for (std::size_t i = 0; i < film.size(); ++i) {
            const TraceLens<double>& lens = entrance_.lens->at(path_.index[i]);
            const TracedRay<double> traced = trace<Direction::forward>(lens, ray);
            ++rays_;
            if (traced.status == RayStatus::ok) {
                film[i] = film_point(traced.ray, lens.image_z);
                share[i] = traced.transmittance;
                arrives = true;
            }
        }
        if (!arrives) {
            return;
        }
        const SpectralSample carried = light(ray, is_far ? 0.0 : std::hypot(beam.distance, length_of(drawn.offset)));
        if (is_black(carried)) {
            return;
        }
        const double pitch_m = 1e-3 * entrance_.sensor.pixel_pitch_mm;
        const double density = is_hero_alone_ ? drawn.density : mean_density(far_beam, drawn.offset);
        const double to_irradiance = per_mm2 / (density * pitch_m * pitch_m);
        std::array<Vec2d, kWavelengthsPerPath> at_px{};
        std::array<float, kWavelengthsPerPath> irradiance{};
        for (std::size_t i = 0; i < film.size(); ++i) {
            if (film[i]) {
                at_px[i] = entrance_.sensor.pixel(*film[i]);
                irradiance[i] = static_cast<float>(to_irradiance * share[i] * carried[i]);
            }
        }
        tile_.splat(at_px, path_.index, irradiance);
    }

    [[nodiscard]] double band_position(std::size_t wavelength) const {
        return static_cast<double>(path_.index[wavelength]) / (scene_.grid.size() - 1);
    }

    /// Each of the wavelengths might have been the hero that drew the ray: the balance heuristic.
    [[nodiscard]] double mean_density(const EntranceBeam& beam, Vec2d offset) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < kWavelengthsPerPath; ++i) {
            sum += entrance_.map->density(beam, band_position(i), offset);
        }
        return sum / kWavelengthsPerPath;
    }

    static double length_of(Vec2d v) { return std::hypot(v.x, v.y); }

    static Vec2d film_point(const Ray<double>& ray, double image_z) {
        const double along = (image_z - ray.origin.z) / ray.direction.z;
        return {ray.origin.x + along * ray.direction.x, ray.origin.y + along * ray.direction.y};
    }

    bool is_blocked(const Vec3d& from, const Vec3d& to) {
        ++rays_;
        return is_occluded(*scene_.geometry, from, to);
    }

    // Between world and lens space.
    [[nodiscard]] Vec3d to_lens(const Vec3d& direction) const {
        return camera_to_lens(rotate_back(entrance_.camera_to_world, direction));
    }
    [[nodiscard]] Vec3d to_lens_point(const Vec3d& point) const {
        return camera_to_lens(moved_back(entrance_.camera_to_world, point));
    }
    [[nodiscard]] Vec3d direction_from_lens(const Vec3d& direction) const {
        return rotate(entrance_.camera_to_world, camera_to_lens(direction));
    }
    [[nodiscard]] Vec3d from_lens(const Vec3d& point) const {
        return moved(entrance_.camera_to_world, camera_to_lens(point));
    }

    const Scene& scene_;
    const LensEntrance& entrance_;
    const PathWavelengths& path_;
    const PathSettings& settings_;
    PathSampler& numbers_;
    FilmTile& tile_;
    std::uint32_t rays_ = 0;
    bool is_hero_alone_ = false;
};

}  // namespace

std::uint32_t trace_light_path(const Scene& scene, const LensEntrance& entrance, const PathWavelengths& path,
                               const PathSettings& settings, PathSampler& numbers, FilmTile& tile) {
    return LightWalk(scene, entrance, path, settings, numbers, tile).walk();
}

}  // namespace lensproof
