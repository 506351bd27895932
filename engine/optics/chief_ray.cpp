#include "engine/optics/chief_ray.h"

#include <cmath>
#include <numbers>

namespace lensproof {

namespace {

// Halvings that take an angle of order 1 down to the last bit.
constexpr int kHalvings = 60;

/// Whether a half of a chief ray got through, or was followed past a rim.
bool arrives(RayStatus status, Rims rims) {
    return status == RayStatus::ok || (rims == Rims::follow && status == RayStatus::clipped);
}

}  // namespace

ChiefRays::ChiefRays(const Lens& lens, double wavelength_nm, Rims rims)
    : whole_(at_wavelength<double>(lens, wavelength_nm)), rims_(rims) {
    const auto stop = whole_.surfaces.begin() + lens.stop_index();
    front_ = {.surfaces = {whole_.surfaces.begin(), stop}, .image_z = 0.0, .specials = whole_.specials};
    rear_ = {.surfaces = {stop + 1, whole_.surfaces.end()}, .image_z = whole_.image_z, .specials = whole_.specials};
    stop_z_ = stop->vertex_z;
    stop_ratio_ = stop->reverse_ratio;

    double passing = 0.0;
    double blocked = 0.5 * std::numbers::pi;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (passing + blocked);
        (from_stop(middle) ? passing : blocked) = middle;
    }
    largest_stop_angle_ = passing;
    largest_field_ = from_stop(passing).value_or(ChiefRay{}).field_angle;
}

std::optional<ChiefRay> ChiefRays::from_stop(double stop_angle) const {
    const Vec3d direction{0.0, std::sin(stop_angle), std::cos(stop_angle)};
    // Where the stop is a glass surface, the ray bends at its vertex.
    const double sine = stop_ratio_ * direction.y;
    if (!(sine < 1.0)) {
        return std::nullopt;
    }
    const Ray<double> outwards{{0.0, 0.0, stop_z_}, {0.0, -sine, -std::sqrt(1.0 - sine * sine)}};
    const Ray<double> inwards{{0.0, 0.0, stop_z_}, direction};
    const bool clips = rims_ == Rims::clip;
    const auto front =
        clips ? trace<Direction::reverse>(front_, outwards) : trace<Direction::reverse, Rims::follow>(front_, outwards);
    const auto rear =
        clips ? trace<Direction::forward>(rear_, inwards) : trace<Direction::forward, Rims::follow>(rear_, inwards);
    if (!arrives(front.status, rims_) || !arrives(rear.status, rims_) || !(rear.ray.direction.z > 0.0)) {
        return std::nullopt;
    }
    const Vec3d incoming = -1.0 * front.ray.direction;
    ChiefRay chief{.field_angle = std::atan2(incoming.y, incoming.z),
                   .front = {front.ray.origin, incoming},
                   .image_height = meet_plane(rear.ray, rear_.image_z).point.y};
    if (front.status != RayStatus::ok || rear.status != RayStatus::ok) {
        const TracedRay<double> from_scene = trace<Direction::forward, Rims::follow>(whole_, chief.front);
        chief.status = from_scene.status;
        chief.surface = from_scene.surface;
    }
    return chief;
}

template <class Residual>
std::optional<ChiefRay> ChiefRays::solve(const Residual& residual) const {
    double low = 0.0;
    double high = largest_stop_angle_;
    const std::optional<ChiefRay> end = from_stop(high);
    if (!end || residual(*end) < 0.0) {
        return std::nullopt;
    }
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        const std::optional<ChiefRay> ray = from_stop(middle);
        if (!ray) {
            return std::nullopt;
        }
        (residual(*ray) < 0.0 ? low : high) = middle;
    }
    return from_stop(high);
}

std::optional<ChiefRay> ChiefRays::at_field(double field_angle) const {
    return solve([&](const ChiefRay& ray) { return ray.field_angle - field_angle; });
}

std::optional<ChiefRay> ChiefRays::from_point(double y, double z) const {
    // The signed distance of the object point from the ray: positive once the ray passes below it.
    return solve([&](const ChiefRay& ray) {
        const double dy = y - ray.front.origin.y;
        const double dz = z - ray.front.origin.z;
        return ray.front.direction.z * dy - ray.front.direction.y * dz;
    });
}

}  // namespace lensproof
