#include "engine/analysis/edge_wave.h"

#include <cmath>
#include <numbers>
#include <optional>

#include "engine/base/input_error.h"

namespace lensproof::analysis {

namespace {

/// A ray from the origin through a point of the stop to the film.
struct Through {
    Ray<double> ray;  // from the last surface
    double path = 0.0;
    double transmittance = 0.0;
    double beam_per_mm2 = 0.0;
};

std::optional<Through> through(const optics::StopAim& lens, const optics::RayOrigin& origin, const Vec2d& point) {
    const auto aimed = lens.aim(origin, point);
    if (!aimed) {
        return std::nullopt;
    }
    const auto rear = lens.onwards(point, aimed->direction);
    if (rear.status != optics::RayStatus::ok) {
        return std::nullopt;
    }
    return Through{.ray = rear.ray,
                   .path = aimed->optical_path + rear.optical_path,
                   .transmittance = aimed->transmittance * rear.transmittance,
                   .beam_per_mm2 = aimed->beam_per_mm2};
}

Vec2d on_film(const Ray<double>& ray, double film_z) {
    const double along = (film_z - ray.origin.z) / ray.direction.z;
    return {ray.origin.x + along * ray.direction.x, ray.origin.y + along * ray.direction.y};
}

double sinc(double x) {
    return std::abs(x) < 1e-4 ? 1.0 - x * x / 6.0 : std::sin(x) / x;
}

}  // namespace

EdgeWave::EdgeWave(const optics::StopAim& lens, const optics::StopMask& mask, const optics::RayOrigin& origin,
                   double wavelength_nm, int pieces)
    : wavenumber_(2.0 * std::numbers::pi / (1e-6 * wavelength_nm)) {
    const double film_z = lens.image_z();
    const auto ray_at = [&](const Vec2d& point) {
        const auto found = through(lens, origin, point);
        if (!found) {
            throw InputError("the stop's edge is not all that bounds the beam: its wave is not known");
        }
        return *found;
    };
    const Through chief = ray_at({});
    image_ = on_film(chief.ray, film_z);
    const Vec3d image{image_.x, image_.y, film_z};
    const auto path_of = [&](const Through& ray) { return ray.path + dot(image - ray.ray.origin, ray.ray.direction); };

    const double step = 1e-4 * lens.semi_diameter();
    for (int i = 0; i < pieces; ++i) {
        const Vec2d point = lens.semi_diameter() * mask.edge_at(static_cast<double>(i) / pieces).point;
        const Through here = ray_at(point);
        const auto slope = [&](const Vec2d& by) {
            const Vec3d apart = ray_at(point + by).ray.direction - ray_at(point - by).ray.direction;
            return Vec2d{apart.x / (2.0 * step), apart.y / (2.0 * step)};
        };
        const double cosines_per_mm2 = std::abs(cross(slope({step, 0.0}), slope({0.0, step})));
        nodes_.push_back({.cosines = {here.ray.direction.x, here.ray.direction.y},
                          .aberration = on_film(here.ray, film_z) - image_,
                          .path = path_of(here) - path_of(chief),
                          .amplitude = std::sqrt(here.transmittance * here.beam_per_mm2 / cosines_per_mm2)});
    }
}

double EdgeWave::irradiance(const Vec2d& from_image) const {
    std::complex<double> sum = 0.0;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const Node& a = nodes_[i];
        const Node& b = nodes_[(i + 1) % nodes_.size()];
        const double phase_a = wavenumber_ * (a.path + dot(a.cosines, from_image));
        const double phase_b = wavenumber_ * (b.path + dot(b.cosines, from_image));
        const Vec2d slope = from_image - 0.5 * (a.aberration + b.aberration);
        sum += 0.5 * (a.amplitude + b.amplitude) * cross(slope, b.cosines - a.cosines) / dot(slope, slope) *
               sinc(0.5 * (phase_b - phase_a)) * std::polar(1.0, 0.5 * (phase_a + phase_b));
    }
    return std::norm(sum) / (4.0 * std::numbers::pi * std::numbers::pi);  // (1/k)² / λ²
}

}  // namespace lensproof::analysis
