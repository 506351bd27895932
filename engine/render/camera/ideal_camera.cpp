#include "engine/render/camera/ideal_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/disc.h"

namespace lensproof::render {

namespace {

double pupil_area(const GaussianOptics& optics) {
    return std::numbers::pi * optics.pupil_radius_mm * optics.pupil_radius_mm;
}

/// Of the disc that paths cross.
double crossed_radius(const GaussianOptics& optics) {
    return optics.is_pinhole ? 0.0 : optics.pupil_radius_mm;
}

/// The pupil's point that (u, v) in the unit square maps to.
Vec2d pupil_point(const GaussianOptics& optics, double u, double v) {
    return warped_onto_disc(crossed_radius(optics), u, v);
}

IdealOpticsColumns in_columns(const std::vector<GaussianOptics>& at) {
    IdealOpticsColumns columns;
    for (const GaussianOptics& optics : at) {
        columns.to_pupil_z.push_back(optics.pupil_z - optics.film_z);
        columns.pupil_radius.push_back(crossed_radius(optics));
        columns.pupil_area.push_back(pupil_area(optics));
        columns.object_z.push_back(optics.object_z);
        columns.h_h.push_back(optics.h_h);
        columns.h_s.push_back(optics.h_s);
        columns.s_h.push_back(optics.s_h);
        columns.s_s.push_back(optics.s_s);
        columns.transmittance.push_back(optics.transmittance);
    }
    return columns;
}

double determinant(const GaussianOptics& optics) {
    return optics.h_h * optics.s_s - optics.h_s * optics.s_h;
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

FrontRay front_ray(const GaussianOptics& optics, const Ray<double>& ray) {
    const Vec2d slope{ray.direction.x / ray.direction.z, ray.direction.y / ray.direction.z};
    const double depth = optics.object_z - ray.origin.z;
    return {.height = {ray.origin.x + depth * slope.x, ray.origin.y + depth * slope.y}, .slope = slope};
}

/// The ray of an origin that crosses the pupil at h; nothing where there is none.
std::optional<FrontRay> ray_through(const GaussianOptics& optics, const LightOrigin& from, Vec2d h) {
    const double behind = from.is_far ? 0.0 : from.at.z - optics.object_z;
    const double per_slope = from.is_far ? optics.s_s : optics.h_s + behind * optics.s_s;
    const double per_height = from.is_far ? optics.s_h : optics.h_h + behind * optics.s_h;
    const Vec2d fixed = from.is_far ? Vec2d{from.at.x / from.at.z, from.at.y / from.at.z} : Vec2d{from.at.x, from.at.y};
    if (per_slope == 0.0) {
        return {};
    }
    const Vec2d s{(fixed.x - per_height * h.x) / per_slope, (fixed.y - per_height * h.y) / per_slope};
    return FrontRay{.height = {optics.h_h * h.x + optics.h_s * s.x, optics.h_h * h.y + optics.h_s * s.y},
                    .slope = {optics.s_h * h.x + optics.s_s * s.x, optics.s_h * h.y + optics.s_s * s.y}};
}

/// Before the camera, on the path to it.
bool is_before(const GaussianOptics& optics, const LightOrigin& from) {
    return from.is_far ? from.at.z > 0.0 : from.at.z < optics.object_z;
}

/// Height and slope at the pupil of a ray that comes from the front.
FrontRay pupil_ray(const GaussianOptics& optics, const FrontRay& ray) {
    const double d = determinant(optics);
    const auto height = [&](double h, double s) { return (optics.s_s * h - optics.h_s * s) / d; };
    const auto slope = [&](double h, double s) { return (optics.h_h * s - optics.s_h * h) / d; };
    return {.height = {height(ray.height.x, ray.slope.x), height(ray.height.y, ray.slope.y)},
            .slope = {slope(ray.height.x, ray.slope.x), slope(ray.height.y, ray.slope.y)}};
}

/// The hero's ray passes by its making, to which rounding has nothing to say, and a pinhole's crosses its centre.
bool passes_pupil(const GaussianOptics& optics, const FrontRay& at_pupil, bool is_hero) {
    return is_hero || optics.is_pinhole ||
           squared(at_pupil.height.x) + squared(at_pupil.height.y) <= squared(optics.pupil_radius_mm);
}

PathPdf pupil_pdf(const std::vector<GaussianOptics>& at, const LightOrigin& from, const FrontRay& ray,
                  const spectral::PathWavelengths& path) {
    return over_heroes([&](std::size_t i) {
        const GaussianOptics& optics = at[path.index[i]];
        if (!passes_pupil(optics, pupil_ray(optics, ray), i == 0)) {
            return 0.0;
        }
        const double per_slope = from.is_far ? optics.s_s : optics.h_s + (from.at.z - optics.object_z) * optics.s_s;
        const double cos2 = ray.cos2();
        const double cos = std::sqrt(cos2);
        return squared(per_slope / determinant(optics)) / (pupil_area(optics) * (from.is_far ? cos : cos * cos2));
    });
}

}  // namespace

IdealCamera::Paths::Paths(const IdealCamera& camera, const FilmSampling& film, const spectral::SpectralGrid& grid,
                          PathCarry carry)
    : samples_(film, static_cast<int>(camera.at_.size())),
      camera_(&camera),
      optics_(in_columns(camera.at_)),
      kernels_(&path_kernels({})),
      rays_(kPathChunk),
      sensor_(film.sensor),
      grid_(grid),
      carry_(carry),
      is_achromatic_(std::ranges::all_of(camera.at_, [&](GaussianOptics like) {
          like.transmittance = camera.at_.front().transmittance;
          return like == camera.at_.front();
      })) {}

bool IdealCamera::Paths::fill(CameraPathBuffer& buffer) {
    const bool is_filled = samples_.fill(buffer, [&](PathStarts& starts) {
        kernels_->leave_ideal_camera(optics_, starts, rays_);
        buffer.append(starts, rays_, starts.size,
                      [&](const auto* from, auto* to) { std::copy_n(from, starts.size, to); });
        started_ += starts.size;
    });
    if (carry_ != PathCarry::hero) {
        weigh(buffer);
    }
    return is_filled;
}

/// A path's weight is its hero's; the others pass the camera by their own transmittance.
void IdealCamera::Paths::weigh(CameraPathBuffer& buffer) const {
    buffer.leave_heroes_alone();
    buffer.pdf.resize(buffer.weights.size());
    for (std::size_t path = 0; path < buffer.weights.size(); ++path) {
        const spectral::PathWavelengths strata = grid_.path(buffer.wavelength[path]);
        if (is_achromatic_) {
            const double per_transmittance = buffer.weight[path] / camera_->at_[strata.index[0]].transmittance;
            for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
                buffer.weights[path][i] =
                    static_cast<float>(per_transmittance * camera_->at_[strata.index[i]].transmittance);
            }
        }
        if (carry_ == PathCarry::wavelengths_and_pdfs) {
            const Ray<double> out = buffer.ray(path);
            const FilmImportance film = camera_->importance(sensor_, {out.origin, -1.0 * out.direction}, strata);
            buffer.pdf[path] = {.shared = film.shared_pdf(0), .hero = film.pdf[0]};
        }
    }
}

FilmImportance IdealCamera::importance(const Sensor& sensor, const Ray<double>& ray,
                                       const spectral::PathWavelengths& path) const {
    FilmImportance found;
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        const GaussianOptics& optics = at_[path.index[i]];
        const FrontRay front = front_ray(optics, ray);
        const FrontRay inside = pupil_ray(optics, front);
        if (!passes_pupil(optics, inside, i == 0)) {
            continue;
        }
        const double z = optics.pupil_z - optics.film_z;
        found.at_px[i] = sensor.pixel({inside.height.x - z * inside.slope.x, inside.height.y - z * inside.slope.y});
        const double etendue = squared(determinant(optics) * front.cos2());  // of dh ds
        found.transmittance[i] = optics.transmittance * squared(inside.cos2()) / etendue;
        found.pdf[i] = squared(z) / (etendue * pupil_area(optics));
    }
    return found;
}

std::optional<LensSample> IdealCamera::sample(const LightOrigin& from, const spectral::PathWavelengths& path, double u,
                                              double v) const {
    const GaussianOptics& optics = at_[path.index[0]];
    if (!is_before(optics, from)) {
        return {};
    }
    const auto ray = ray_through(optics, from, pupil_point(optics, u, v));
    if (!ray) {
        return {};
    }
    const Vec3d origin{ray->height.x, ray->height.y, optics.object_z};
    const Vec3d direction = normalized(Vec3d{ray->slope.x, ray->slope.y, 1.0});
    return LensSample{
        .ray = {origin, direction}, .direction = direction, .end = origin, .pdf = pupil_pdf(at_, from, *ray, path)};
}

PathPdf IdealCamera::pdf(const LightOrigin& from, const Ray<double>& outwards,
                         const spectral::PathWavelengths& path) const {
    const GaussianOptics& optics = at_[path.index[0]];
    return is_before(optics, from) ? pupil_pdf(at_, from, front_ray(optics, outwards), path) : PathPdf{};
}

}  // namespace lensproof::render
