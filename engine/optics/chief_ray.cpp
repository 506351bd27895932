#include "engine/optics/chief_ray.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>

#include "engine/base/angle.h"
#include "engine/base/bisect.h"
#include "engine/base/infinity.h"

namespace lensproof::optics {

namespace {

// Halvings that take an angle of order 1 down to its last bits.
constexpr int kHalvings = 52;

/// Whether a half of a chief ray got through, or was followed past a rim.
bool arrives(RayStatus status, Rims rims) {
    return status == RayStatus::ok || (rims == Rims::follow && status == RayStatus::clipped);
}

template <Direction direction>
TracedRay<double> trace_half(const TraceLens<double>& half, const Ray<double>& ray, Rims rims) {
    return rims == Rims::clip ? trace<direction>(half, ray) : trace<direction, Rims::follow>(half, ray);
}

double field_of(const Vec3d& incoming) {
    return std::atan2(incoming.y, incoming.z);
}

/// The ray of a symmetric lens on the other side of its axis.
ChiefRay mirrored(ChiefRay ray) {
    ray.field_angle = -ray.field_angle;
    ray.image_height = -ray.image_height;
    for (double* y :
         {&ray.front.origin.y, &ray.front.direction.y, &ray.rear.origin.y, &ray.rear.direction.y, &ray.image_point.y}) {
        *y = -*y;
    }
    return ray;
}

}  // namespace

ChiefRays::ChiefRays(const Lens& lens, double wavelength_nm, Rims rims)
    : whole_(at_wavelength<double>(lens, wavelength_nm)), rims_(rims), is_symmetric_(lens.is_rotationally_symmetric) {
    const auto stop = whole_.surfaces.begin() + lens.stop_index();
    front_ = {.surfaces = {whole_.surfaces.begin(), stop}, .image_z = 0.0, .specials = whole_.specials};
    stop_ = {.surfaces = {*stop}, .image_z = 0.0, .specials = whole_.specials};
    rear_ = {.surfaces = {stop + 1, whole_.surfaces.end()}, .image_z = whole_.image_z, .specials = whole_.specials};
    const LensSurface& surface = lens.surfaces[lens.stop_index()];
    stop_centre_ = {surface.vertex.x, surface.vertex.y, surface.vertex_z};
    stop_normal_ = surface.axes[2];
    stop_ratio_ = stop->reverse_ratio;
    is_thin_stop_ = surface.is_thin_element();
    stop_heading_ = std::copysign(1.0, stop->index_after);
    largest_stop_angle_ = is_symmetric_ ? end_of_family() : 0.0;
    largest_field_ = find_largest_field();
}

double ChiefRays::end_of_family() const {
    constexpr int kSteps = 64;
    constexpr double kStep = 0.5 * kPi / kSteps;
    constexpr double kNowhere = -kInfinity;
    const auto field = [&](double angle) {
        const std::optional<ChiefRay> ray = from_stop(angle);
        return ray ? ray->field_angle : kNowhere;
    };
    const auto rises = [&](double angle) {
        constexpr double kBehind = 1e-7;
        return field(angle) > field(angle - kBehind);
    };
    int step = 1;
    for (double last = field(0.0); step < kSteps; ++step) {
        const double here = field(step * kStep);
        if (!(here > last)) {
            break;
        }
        last = here;
    }
    const double end = bisected({(step - 1) * kStep, step * kStep}, kHalvings, [&](double angle) {
                           return field(angle) > kNowhere;
                       }).inside;
    // Where it turns back before it ends, that is in the last step, or, if it has just done so, in the one before.
    return rises(end) ? end : bisected({std::max(0, step - 2) * kStep, end}, kHalvings, rises).inside;
}

double ChiefRays::find_largest_field() const {
    if (is_symmetric_) {
        const std::optional<ChiefRay> last = from_stop(largest_stop_angle_);
        return last ? last->field_angle : 0.0;
    }
    return bisected({0.0, kPi}, kHalvings, [&](double field) { return at_field(field).has_value(); }).inside;
}

std::optional<Vec3d> ChiefRays::outwards_from_stop(const Vec3d& direction) const {
    const double cosine = dot(direction, stop_normal_);
    if (!(cosine > 0.0)) {
        return std::nullopt;
    }
    if (is_thin_stop_) {
        const auto bent = trace<Direction::reverse, Rims::follow>(stop_, {stop_centre_, -1.0 * direction});
        return gets_through(bent.status) ? std::optional(bent.ray.direction) : std::nullopt;
    }
    const Refraction<double> bent = refract(-1.0 * direction, -1.0 * stop_normal_, cosine, stop_ratio_);
    return bent.transmitted ? std::optional(bent.direction) : std::nullopt;
}

std::optional<ChiefRay> ChiefRays::through_stop(const Vec3d& direction, Rims rims) const {
    const std::optional<Vec3d> outwards = outwards_from_stop(direction);
    if (!outwards) {
        return std::nullopt;
    }
    const auto front = trace_half<Direction::reverse>(front_, {stop_centre_, *outwards}, rims);
    const auto rear = trace_half<Direction::forward>(rear_, {stop_centre_, direction}, rims);
    if (!arrives(front.status, rims) || !arrives(rear.status, rims) || !(rear.ray.direction.z > 0.0)) {
        return std::nullopt;
    }
    const Vec3d incoming = -1.0 * front.ray.direction;
    const Vec3d image = meet_plane(rear.ray, rear_.image_z).point;
    ChiefRay chief{.field_angle = field_of(incoming),
                   .front = {front.ray.origin, incoming},
                   .image_height = image.y,
                   .rear = rear.ray,
                   .image_point = {image.x, image.y}};
    if (front.status != RayStatus::ok || rear.status != RayStatus::ok) {
        const TracedRay<double> from_scene = trace<Direction::forward, Rims::follow>(whole_, chief.front);
        chief.status = from_scene.status;
        chief.surface = from_scene.surface;
    }
    return chief;
}

std::optional<ChiefRay> ChiefRays::from_stop(double stop_angle) const {
    return through_stop({0.0, stop_heading_ * std::sin(stop_angle), std::cos(stop_angle)}, rims_);
}

/// The ray of the symmetric family where `residual`, which rises with the stop angle, is 0.
template <class Residual>
std::optional<ChiefRay> ChiefRays::solve(const Residual& residual) const {
    const std::optional<ChiefRay> first = from_stop(0.0);
    const std::optional<ChiefRay> last = from_stop(largest_stop_angle_);
    if (!first || !last) {
        return std::nullopt;
    }
    const double at_first = residual(*first);
    const double at_last = residual(*last);
    if (at_first == 0.0) {
        return first;
    }
    if (at_first > 0.0 || at_last < 0.0) {
        return std::nullopt;
    }
    bool is_family = true;
    const auto at = [&](double angle) {
        const std::optional<ChiefRay> ray = from_stop(angle);
        is_family = is_family && ray.has_value();
        return ray ? residual(*ray) : 0.0;
    };
    const auto is_exact = [](double a, double b) { return b - a <= 2e-16 * b; };
    std::uintmax_t steps = 120;  // never needed: each takes a digit or more
    const auto [low, high] =
        boost::math::tools::toms748_solve(at, 0.0, largest_stop_angle_, at_first, at_last, is_exact, steps);
    return is_family ? from_stop(high) : std::nullopt;
}

/// The ray whose `residual` (two small angles) is 0. The path starts at the ray along the stop's axis and takes its
/// residual down in steps; within each, Newton's method with differences over `kDifference`, which are linear to 1e-6,
/// so that three steps do.
template <class Residual>
std::optional<ChiefRay> ChiefRays::aim(const Residual& residual) const {
    struct Aim {
        Vec2d angles;
        ChiefRay ray;
        Vec2d residual;
    };
    const auto shoot = [&](Vec2d angles) -> std::optional<Aim> {
        const Vec3d direction{std::sin(angles.x), std::cos(angles.x) * std::sin(angles.y),
                              std::cos(angles.x) * std::cos(angles.y)};
        const std::optional<ChiefRay> ray = through_stop(direction, Rims::follow);
        return ray ? std::optional(Aim{angles, *ray, residual(*ray)}) : std::nullopt;
    };
    std::optional<Aim> best = shoot({std::asin(stop_normal_.x), std::atan2(stop_normal_.y, stop_normal_.z)});
    if (!best) {
        return std::nullopt;
    }
    constexpr double kDifference = 1e-6;
    constexpr double kStride = 0.05;
    constexpr int kMostSteps = 20;
    const Vec2d start = best->residual;
    const int strides = 1 + static_cast<int>(length(start) / kStride);
    for (int stride = strides - 1; stride >= 0; --stride) {
        const Vec2d goal = 1.0 * stride * start / (1.0 * strides);
        const auto miss = [&](const Aim& aim) { return length(aim.residual - goal); };
        for (int step = 0; step < kMostSteps && miss(*best) > 0.0; ++step) {
            const std::optional<Aim> in_x = shoot(best->angles + Vec2d{kDifference, 0.0});
            const std::optional<Aim> in_y = shoot(best->angles + Vec2d{0.0, kDifference});
            if (!in_x || !in_y) {
                break;
            }
            const Vec2d by_x = in_x->residual - best->residual;
            const Vec2d by_y = in_y->residual - best->residual;
            const Vec2d left = goal - best->residual;
            const Vec2d move = kDifference * Vec2d{cross(left, by_y), cross(by_x, left)} / cross(by_x, by_y);
            const std::optional<Aim> next = shoot(best->angles + move);
            if (!next || !(miss(*next) < miss(*best))) {
                break;
            }
            best = next;
        }
    }
    constexpr double kAimed = 1e-12;
    const bool is_aimed = length(best->residual) <= kAimed;
    const bool passes = rims_ == Rims::follow || best->ray.status == RayStatus::ok;
    return is_aimed && passes ? std::optional(best->ray) : std::nullopt;
}

std::optional<ChiefRay> ChiefRays::at_field(double field_angle) const {
    if (!is_symmetric_) {
        return aim([&](const ChiefRay& ray) { return Vec2d{ray.front.direction.x, ray.field_angle - field_angle}; });
    }
    if (field_angle < 0.0) {
        const std::optional<ChiefRay> ray = at_field(-field_angle);
        return ray ? std::optional(mirrored(*ray)) : std::nullopt;
    }
    return solve([&](const ChiefRay& ray) { return ray.field_angle - field_angle; });
}

std::optional<ChiefRay> ChiefRays::from_point(const Vec3d& object) const {
    if (!is_symmetric_) {
        return aim([&](const ChiefRay& ray) {
            const Vec3d wanted = normalized(ray.front.origin - object);
            const Vec3d& found = ray.front.direction;
            return Vec2d{found.x - wanted.x, std::remainder(field_of(found) - field_of(wanted), 2.0 * kPi)};
        });
    }
    if (object.y > 0.0) {
        const std::optional<ChiefRay> ray = from_point({object.x, -object.y, object.z});
        return ray ? std::optional(mirrored(*ray)) : std::nullopt;
    }
    // The signed distance of the object point from the ray: positive once the ray passes below it.
    return solve([&](const ChiefRay& ray) {
        const Vec3d to_object = object - ray.front.origin;
        return ray.front.direction.z * to_object.y - ray.front.direction.y * to_object.z;
    });
}

}  // namespace lensproof::optics
