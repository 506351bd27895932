#include "engine/render/camera_end.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/base/overloaded.h"

namespace lensproof::render {

namespace {

/// The mean over a path's wavelengths: each of them might have been the hero (balance heuristic).
template <class DensityOf>
PathDensity over_heroes(const DensityOf& density_of) {
    PathDensity density{.shared = 0.0, .hero = density_of(std::size_t{0})};
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        density.shared += (i == 0 ? density.hero : density_of(i)) / spectral::kWavelengthsPerPath;
    }
    return density;
}

/// Light from an origin on its way into a camera; lens space.
struct Origin {
    Vec3d at;
    bool is_far = false;
};

// --- A lens ---

/// The beam of an origin; from straight behind the lens beams have no frame.
std::optional<pupil::EntranceBeam> beam_of(const LensEntrance& lens, const Origin& from) {
    const auto beam =
        from.is_far ? std::optional(pupil::beam_along(lens.front, from.at)) : pupil::beam_from(lens.front, from.at);
    return beam && beam->axis.direction.z > -1.0 ? beam : std::nullopt;
}

double band_position(const LensEntrance& lens, std::uint16_t wavelength) {
    return static_cast<double>(wavelength) / (lens.lens->wavelengths() - 1);
}

PathDensity beam_density(const LensEntrance& lens, const pupil::EntranceBeam& beam, Vec2d offset,
                         const spectral::PathWavelengths& path) {
    const pupil::EntranceBeam far_beam = lens.map->beam(beam.axis.direction);
    const double mm2 = std::isfinite(beam.distance) ? 1.0 / beam.solid_angle_per_mm2(offset) : 1.0;
    return over_heroes(
        [&](std::size_t i) { return mm2 * lens.map->pdf(far_beam, band_position(lens, path.index[i]), offset); });
}

std::optional<RayIn> draw_in(const LensEntrance& lens, const Origin& from, const spectral::PathWavelengths& path,
                             double u, double v) {
    const auto beam = beam_of(lens, from);
    if (!beam) {
        return {};
    }
    const pupil::EntranceSample drawn =
        lens.map->sample(lens.map->beam(beam->axis.direction), band_position(lens, path.index[0]), u, v);
    if (!(drawn.pdf > 0.0)) {
        return {};
    }
    const Ray<double> ray = beam->ray(drawn.offset);
    const double way = beam->distance;
    RayIn in{
        .ray = ray,
        .direction = ray.direction,
        .end = from.is_far ? ray.origin : from.at + std::hypot(way, drawn.offset.x, drawn.offset.y) * ray.direction,
        .density = beam_density(lens, *beam, drawn.offset, path)};
    return in.density.hero > 0.0 ? std::optional(in) : std::nullopt;
}

PathDensity density_in(const LensEntrance& lens, const Origin& from, const Ray<double>& outwards,
                       const spectral::PathWavelengths& path) {
    const auto beam = beam_of(lens, from);
    if (!beam) {
        return {};
    }
    // Where the ray crosses the beam's plane, from its end at the lens, which is near.
    const Vec3d start = outwards.origin - lens.front.centre;
    const double along = dot(start, beam->axis.direction) / dot(outwards.direction, beam->axis.direction);
    const Vec3d crossing = start - along * outwards.direction;
    return beam_density(lens, *beam, {dot(crossing, beam->across[0]), dot(crossing, beam->across[1])}, path);
}

FilmArrival arrive_at(const LensEntrance& lens, const Sensor& sensor, const Ray<double>& ray,
                      const spectral::PathWavelengths& path) {
    FilmArrival arrival;
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        const optics::TraceLens<double>& at = lens.lens->at(path.index[i]);
        const optics::TracedRay<double> traced = optics::trace<optics::Direction::forward>(at, ray);
        if (traced.status == optics::RayStatus::ok) {
            const FilmMeeting film = meet_film(*lens.pupil, at.image_z, band_position(lens, path.index[i]), traced.ray);
            arrival.at_px[i] = sensor.pixel(film.point);
            arrival.share[i] = traced.transmittance;
            arrival.drawn[i] = film.density;
        }
    }
    return arrival;
}

// --- Ideal cameras ---

double pupil_area(const GaussianCamera& camera) {
    return std::numbers::pi * camera.pupil_radius_mm * camera.pupil_radius_mm;
}

double determinant(const GaussianCamera& camera) {
    return camera.h_h * camera.s_s - camera.h_s * camera.s_h;
}

double squared(double x) {
    return x * x;
}

/// A ray before an ideal camera: where it crosses z = object_z, and its slopes.
struct FrontRay {
    Vec2d height;
    Vec2d slope;

    /// cos² of its angle with the axis.
    [[nodiscard]] double cos2() const { return 1.0 / (1.0 + slope.x * slope.x + slope.y * slope.y); }
};

FrontRay front_ray(const GaussianCamera& camera, const Ray<double>& ray) {
    const Vec2d slope{ray.direction.x / ray.direction.z, ray.direction.y / ray.direction.z};
    const double way = camera.object_z - ray.origin.z;
    return {.height = {ray.origin.x + way * slope.x, ray.origin.y + way * slope.y}, .slope = slope};
}

/// The ray of an origin that crosses the pupil at h; nothing where there is none.
std::optional<FrontRay> ray_through(const GaussianCamera& camera, const Origin& from, Vec2d h) {
    const double behind = from.is_far ? 0.0 : from.at.z - camera.object_z;
    const double per_slope = from.is_far ? camera.s_s : camera.h_s + behind * camera.s_s;
    const double per_height = from.is_far ? camera.s_h : camera.h_h + behind * camera.s_h;
    const Vec2d fixed = from.is_far ? Vec2d{from.at.x / from.at.z, from.at.y / from.at.z} : Vec2d{from.at.x, from.at.y};
    if (per_slope == 0.0) {
        return {};
    }
    const Vec2d s{(fixed.x - per_height * h.x) / per_slope, (fixed.y - per_height * h.y) / per_slope};
    return FrontRay{.height = {camera.h_h * h.x + camera.h_s * s.x, camera.h_h * h.y + camera.h_s * s.y},
                    .slope = {camera.s_h * h.x + camera.s_s * s.x, camera.s_h * h.y + camera.s_s * s.y}};
}

/// Before the camera, on the way to it.
bool is_before(const GaussianCamera& camera, const Origin& from) {
    return from.is_far ? from.at.z > 0.0 : from.at.z < camera.object_z;
}

/// Height and slope at the pupil of a ray that comes from the front.
FrontRay pupil_ray(const GaussianCamera& camera, const FrontRay& ray) {
    const double d = determinant(camera);
    const auto height = [&](double h, double s) { return (camera.s_s * h - camera.h_s * s) / d; };
    const auto slope = [&](double h, double s) { return (camera.h_h * s - camera.s_h * h) / d; };
    return {.height = {height(ray.height.x, ray.slope.x), height(ray.height.y, ray.slope.y)},
            .slope = {slope(ray.height.x, ray.slope.x), slope(ray.height.y, ray.slope.y)}};
}

/// The hero's ray passes by its making, to which rounding has nothing to say, and a pinhole's crosses its centre.
bool passes_pupil(const GaussianCamera& camera, const FrontRay& at_pupil, bool is_hero) {
    return is_hero || camera.is_pinhole ||
           squared(at_pupil.height.x) + squared(at_pupil.height.y) <= squared(camera.pupil_radius_mm);
}

PathDensity pupil_density(const IdealEntrance& ideal, const Origin& from, const FrontRay& ray,
                          const spectral::PathWavelengths& path) {
    return over_heroes([&](std::size_t i) {
        const GaussianCamera& camera = (*ideal.at)[path.index[i]];
        if (!passes_pupil(camera, pupil_ray(camera, ray), i == 0)) {
            return 0.0;
        }
        const double per_slope = from.is_far ? camera.s_s : camera.h_s + (from.at.z - camera.object_z) * camera.s_s;
        const double cos2 = ray.cos2();
        const double cos = std::sqrt(cos2);
        return squared(per_slope / determinant(camera)) / (pupil_area(camera) * (from.is_far ? cos : cos * cos2));
    });
}

std::optional<RayIn> draw_in(const IdealEntrance& ideal, const Origin& from, const spectral::PathWavelengths& path,
                             double u, double v) {
    const GaussianCamera& camera = (*ideal.at)[path.index[0]];
    if (!is_before(camera, from)) {
        return {};
    }
    const double radius = camera.is_pinhole ? 0.0 : camera.pupil_radius_mm * std::sqrt(u);
    const double angle = 2.0 * std::numbers::pi * v;
    const auto ray = ray_through(camera, from, {radius * std::cos(angle), radius * std::sin(angle)});
    if (!ray) {
        return {};
    }
    const Vec3d origin{ray->height.x, ray->height.y, camera.object_z};
    const Vec3d direction = normalized(Vec3d{ray->slope.x, ray->slope.y, 1.0});
    return RayIn{.ray = {origin, direction},
                 .direction = direction,
                 .end = origin,
                 .density = pupil_density(ideal, from, *ray, path)};
}

PathDensity density_in(const IdealEntrance& ideal, const Origin& from, const Ray<double>& outwards,
                       const spectral::PathWavelengths& path) {
    const GaussianCamera& camera = (*ideal.at)[path.index[0]];
    return is_before(camera, from) ? pupil_density(ideal, from, front_ray(camera, outwards), path) : PathDensity{};
}

FilmArrival arrive_at(const IdealEntrance& ideal, const Sensor& sensor, const Ray<double>& ray,
                      const spectral::PathWavelengths& path) {
    FilmArrival arrival;
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        const GaussianCamera& camera = (*ideal.at)[path.index[i]];
        const FrontRay front = front_ray(camera, ray);
        const FrontRay inside = pupil_ray(camera, front);
        if (!passes_pupil(camera, inside, i == 0)) {
            continue;
        }
        const double way = camera.pupil_z - camera.film_z;
        arrival.at_px[i] =
            sensor.pixel({inside.height.x - way * inside.slope.x, inside.height.y - way * inside.slope.y});
        // Of dh ds; see CameraEnd.
        const double etendue = squared(determinant(camera) * front.cos2());
        arrival.share[i] = camera.transmittance * squared(inside.cos2()) / etendue;
        arrival.drawn[i] = squared(way) / (etendue * pupil_area(camera));
    }
    return arrival;
}

}  // namespace

bool FilmArrival::is_dark() const {
    return std::ranges::all_of(share, [](double of) { return of == 0.0; });
}

double FilmArrival::shared_density(std::size_t wavelength) const {
    const auto pixel = [&](std::size_t i) { return Vec2d{std::floor(at_px[i].x + 0.5), std::floor(at_px[i].y + 0.5)}; };
    double sum = 0.0;
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        if (share[i] > 0.0 && (i == wavelength || pixel(i) == pixel(wavelength))) {
            sum += drawn[i] / spectral::kWavelengthsPerPath;
        }
    }
    return sum;
}

std::optional<RayIn> CameraEnd::draw(const LightOrigin& from, const spectral::PathWavelengths& path, double u,
                                     double v) const {
    const Origin origin{scene::camera_to_lens(from.is_far ? scene::rotate_back(camera_to_world, from.at)
                                                          : scene::moved_back(camera_to_world, from.at)),
                        from.is_far};
    auto in = std::visit([&](const auto& camera) { return draw_in(camera, origin, path, u, v); }, entrance);
    if (in) {
        in->direction = scene::rotate(camera_to_world, scene::camera_to_lens(in->direction));
        in->end = scene::moved(camera_to_world, scene::camera_to_lens(in->end));
    }
    return in;
}

PathDensity CameraEnd::density(const LightOrigin& from, const Ray<double>& outwards,
                               const spectral::PathWavelengths& path) const {
    const Origin origin{scene::camera_to_lens(from.is_far ? scene::rotate_back(camera_to_world, from.at)
                                                          : scene::moved_back(camera_to_world, from.at)),
                        from.is_far};
    return std::visit([&](const auto& camera) { return density_in(camera, origin, outwards, path); }, entrance);
}

FilmArrival CameraEnd::arrive(const Ray<double>& ray, const spectral::PathWavelengths& path) const {
    return std::visit([&](const auto& camera) { return arrive_at(camera, sensor, ray, path); }, entrance);
}

double CameraEnd::film_area_mm2() const {
    return sensor.width * sensor.pixel_pitch_mm * sensor.height * sensor.pixel_pitch_mm;
}

EntranceRatio CameraEnd::ratio(const PathDensity& entering, const PathDensity& drawn) const {
    const auto of = [&](double in, double out) { return out > 0.0 ? film_area_mm2() * in / out : 0.0; };
    return {.shared = of(entering.shared, drawn.shared), .hero = of(entering.hero, drawn.hero)};
}

}  // namespace lensproof::render
