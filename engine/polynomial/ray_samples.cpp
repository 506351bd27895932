#include "engine/polynomial/ray_samples.h"

#include <algorithm>
#include <cmath>

namespace lensproof::polynomial {

namespace {

/// The fractions of n over the powers of the root of x⁵ = x + 1: four coordinates that fill the cube evenly (Roberts
/// 2018, after Kronecker).
std::array<double, 4> even_point(std::uint64_t number) {
    constexpr double kRoot = 1.1673039782614187;
    std::array<double, 4> point{};
    double step = 1.0;
    for (double& coordinate : point) {
        step /= kRoot;
        const double at = 0.5 + step * static_cast<double>(number);
        coordinate = at - std::floor(at);
    }
    return point;
}

}  // namespace

std::optional<RaySample> RaySampler::sample(std::uint64_t number) const {
    const std::array<double, 4> xi = even_point(number);
    const auto count = static_cast<int>(lenses_->size());
    const int wavelength = std::min(count - 1, static_cast<int>(xi[3] * count));
    const double band = count > 1 ? wavelength / (count - 1.0) : 0.0;
    const Vec2d film{0.0, film_radius_mm_ * std::sqrt(xi[0])};
    const double u = pupil_->regions().defensive_fraction();
    const pupil::PupilSample drawn = pupil_->sample(film, band, u + (1.0 - u) * xi[1], xi[2]);
    if (!(drawn.pdf > 0.0)) {
        return std::nullopt;
    }
    const optics::TraceLens<double>& at = lens(wavelength);
    const Ray<double> ray =
        optics::reverse_ray(Vec3d{film.x, film.y, at.image_z}, Vec3d{drawn.point.x, drawn.point.y, pupil_->plane_z()});
    RaySample found{.film = film, .pupil = drawn.point, .wavelength = wavelength};
    found.rims.resize(at.surfaces.size());
    const auto traced = optics::trace<optics::Direction::reverse, optics::Rims::follow>(
        at, ray, [&](const optics::SurfaceEvent<double>& event) {
            const Vec3d& point = event.ray.origin;
            const auto surface = static_cast<std::size_t>(event.surface);
            found.rims[surface] = (point.x * point.x + point.y * point.y) / at.surfaces[surface].semi_diameter_squared;
        });
    if (!optics::gets_through(traced.status)) {
        return std::nullopt;
    }
    const optics::Intersection<double> front = optics::intersect(traced.ray, front_curvature_, -1.0);
    if (!front.hit) {
        return std::nullopt;
    }
    const double z = at.image_z - pupil_->plane_z();
    found.exit = exit_point<double>({front.point, traced.ray.direction}, front_curvature_);
    found.transmittance = traced.transmittance;
    found.passes = traced.status == optics::RayStatus::ok;
    found.etendue = std::pow(ray.direction.z, 4) / (z * z * drawn.pdf);
    return found;
}

std::vector<RaySample> RaySampler::samples(std::uint64_t first, int count) const {
    std::vector<RaySample> found;
    const std::uint64_t end = first + 20 * static_cast<std::uint64_t>(count);
    for (std::uint64_t number = first; number < end && static_cast<int>(found.size()) < count; ++number) {
        if (std::optional<RaySample> one = sample(number)) {
            found.push_back(*std::move(one));
        }
    }
    return found;
}

std::optional<Vec2d> RaySampler::landing(const ExitPoint<double>& exit, int wavelength) const {
    const Ray<double> out = exit_ray(exit, front_curvature_);
    const optics::TraceLens<double>& at = lens(wavelength);
    const auto traced = optics::trace<optics::Direction::forward, optics::Rims::follow>(
        at, Ray<double>{out.origin, -1.0 * out.direction});
    if (!optics::gets_through(traced.status)) {
        return std::nullopt;
    }
    const Vec3d film = optics::meet_plane(traced.ray, at.image_z).point;
    return Vec2d{film.x, film.y};
}

std::optional<LandingSlopes> RaySampler::landing_slopes(const RaySample& sample) const {
    constexpr double kStep = 1e-5;  // rad, about; and of the film's radius
    LandingSlopes slopes;
    for (std::size_t i = 0; i < 4; ++i) {
        const bool is_w = i < 2;
        const double step = is_w ? kStep : kStep * film_radius_mm_;
        const Vec2d along = i % 2 == 0 ? Vec2d{step, 0.0} : Vec2d{0.0, step};
        const auto landing_at = [&](double sign) {
            ExitPoint<double> moved = sample.exit;
            (is_w ? moved.w : moved.u) = (is_w ? moved.w : moved.u) + sign * along;
            return landing(moved, sample.wavelength);
        };
        const std::optional<Vec2d> ahead = landing_at(1.0);
        const std::optional<Vec2d> behind = landing_at(-1.0);
        if (!ahead || !behind) {
            return std::nullopt;
        }
        (is_w ? slopes.by_w : slopes.by_u)[i % 2] = 0.5 / step * (*ahead - *behind);
    }
    return slopes;
}

}  // namespace lensproof::polynomial
