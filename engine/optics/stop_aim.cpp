#include "engine/optics/stop_aim.h"

#include <algorithm>
#include <cmath>

#include "engine/base/basis.h"

namespace lensproof::optics {

namespace {

TraceLens<double> part_of(const TraceLens<double>& lens, std::size_t from, std::size_t end) {
    const auto at = [](const auto& of, std::size_t index) { return of.begin() + static_cast<std::ptrdiff_t>(index); };
    TraceLens<double> part{.surfaces = {at(lens.surfaces, from), at(lens.surfaces, end)},
                           .image_z = lens.image_z,
                           .specials = lens.specials};
    if (!lens.attenuation.empty()) {
        part.attenuation = {at(lens.attenuation, from), at(lens.attenuation, end + 1)};
    }
    return part;
}

Vec3d with_z(const Vec2d& cosines) {
    return {cosines.x, cosines.y, std::sqrt(1.0 - dot(cosines, cosines))};
}

}  // namespace

/// A ray outwards against where it should go, at a pair of direction cosines at the stop.
struct StopAim::Outside {
    Ray<double> ray;
    Vec3d towards;           // of unit length
    double distance2 = 1.0;  // to the origin, mm²; of far light 1
};

StopAim::StopAim(const TraceLens<double>& lens, int stop_index)
    : front_(part_of(lens, 0, static_cast<std::size_t>(stop_index))),
      rear_(part_of(lens, static_cast<std::size_t>(stop_index) + 1, lens.surfaces.size())) {
    const TraceSurface<double>& stop = lens.surfaces[static_cast<std::size_t>(stop_index)];
    if (stop.special >= 0) {
        frame_ = lens.specials[static_cast<std::size_t>(stop.special)];
    }
    middle_ = {frame_.vertex.x, frame_.vertex.y, stop.vertex_z};
    semi_diameter_ = std::sqrt(stop.semi_diameter_squared);
    index_ = stop.index_before;

    constexpr int kAngles = 128;
    for (int i = 0; i < kAngles; ++i) {
        const double sine = static_cast<double>(i) / kAngles;
        const auto ray = outwards({}, {0.0, sine});
        const double angle = ray ? std::acos(std::clamp(-ray->direction.z, -1.0, 1.0)) : -1.0;
        if (!chiefs_.empty() && !(angle > chiefs_.back().field_angle)) {
            break;
        }
        chiefs_.push_back({angle, sine});
    }
    const double small = 1e-4 * semi_diameter_;
    const auto by_place = outwards({0.0, small}, {});
    const auto by_angle = outwards({}, {0.0, 1e-4});
    const auto middle = outwards({}, {});
    if (by_place && by_angle && middle) {
        cosine_per_mm_ = -(by_place->direction.y - middle->direction.y) / small /
                         ((by_angle->direction.y - middle->direction.y) / 1e-4);
    }
}

Vec3d StopAim::in_lens(const Vec3d& own) const {
    return frame_.from_own(own);
}

std::optional<Ray<double>> StopAim::outwards(const Vec2d& point, const Vec2d& cosines) const {
    if (!(dot(cosines, cosines) < 1.0)) {
        return std::nullopt;
    }
    const auto traced = trace<Direction::reverse, Rims::follow>(
        front_, {middle_ + in_lens({point.x, point.y, 0.0}), -1.0 * in_lens(with_z(cosines))});
    const bool is_through = traced.status == RayStatus::ok || traced.status == RayStatus::clipped;
    return is_through ? std::optional(traced.ray) : std::nullopt;
}

std::optional<StopAim::Outside> StopAim::outside(const RayOrigin& origin, const Vec2d& point,
                                                 const Vec2d& cosines) const {
    const auto ray = outwards(point, cosines);
    if (!ray) {
        return std::nullopt;
    }
    if (origin.is_far) {
        return Outside{.ray = *ray, .towards = -1.0 * origin.at};
    }
    const Vec3d reach = origin.at - ray->origin;
    const double distance2 = dot(reach, reach);
    return Outside{.ray = *ray, .towards = (1.0 / std::sqrt(distance2)) * reach, .distance2 = distance2};
}

Vec2d StopAim::first_guess(const RayOrigin& origin, const Vec2d& point) const {
    const Vec3d light = origin.is_far ? origin.at : normalized(-1.0 * origin.at);
    const double angle = std::acos(std::clamp(light.z, -1.0, 1.0));
    const auto next = std::ranges::lower_bound(chiefs_, angle, {}, &Chief::field_angle);
    double sine = 0.0;
    if (next == chiefs_.end()) {
        sine = chiefs_.back().sine;
    } else if (next != chiefs_.begin()) {
        const Chief& last = *std::prev(next);
        sine = std::lerp(last.sine, next->sine, (angle - last.field_angle) / (next->field_angle - last.field_angle));
    }
    const double across = std::hypot(light.x, light.y);
    const Vec2d azimuth = across > 0.0 ? Vec2d{light.x / across, light.y / across} : Vec2d{};
    return sine * azimuth + cosine_per_mm_ * point;
}

std::optional<AimedRay> StopAim::aim(const RayOrigin& origin, const Vec2d& point, const Vec3d* near) const {
    constexpr double kPrecision = 1e-9;
    constexpr double kStep = 1e-6;
    Vec2d cosines = near != nullptr ? Vec2d{near->x, near->y} : first_guess(origin, point);
    auto here = outside(origin, point, cosines);
    if (!here) {  // the edge's ray may end where the chief ray does not
        cosines = first_guess(origin, {});
        here = outside(origin, point, cosines);
    }
    for (int iteration = 0; here && iteration < 30; ++iteration) {
        const Basis basis(here->towards);
        const auto miss = [&](const Outside& at) {
            const Vec3d apart = at.ray.direction - at.towards;
            return Vec2d{dot(apart, basis.x), dot(apart, basis.y)};
        };
        const auto x = outside(origin, point, cosines + Vec2d{kStep, 0.0});
        const auto y = outside(origin, point, cosines + Vec2d{0.0, kStep});
        if (!x || !y) {
            return std::nullopt;
        }
        const Vec2d missed = miss(*here);
        const Vec2d by_x = (miss(*x) - missed) / kStep;
        const Vec2d by_y = (miss(*y) - missed) / kStep;
        const double determinant = cross(by_x, by_y);
        const double error = length(here->ray.direction - here->towards);
        if (error < kPrecision) {
            const Vec3d own = with_z(cosines);
            const auto traced =
                trace<Direction::reverse>(front_, {middle_ + in_lens({point.x, point.y, 0.0}), -1.0 * in_lens(own)});
            if (traced.status != RayStatus::ok || determinant == 0.0) {
                return std::nullopt;
            }
            return AimedRay{.front = {traced.ray.origin, -1.0 * traced.ray.direction},
                            .direction = own,
                            .transmittance = traced.transmittance,
                            .optical_path = traced.optical_path + (origin.is_far ? dot(origin.at, traced.ray.origin)
                                                                                 : std::sqrt(here->distance2)),
                            .beam_per_mm2 = index_ * index_ / (std::abs(determinant) * here->distance2)};
        }
        // The whole step, or a part of it that comes nearer.
        const Vec2d step{-cross(missed, by_y) / determinant, -cross(by_x, missed) / determinant};
        std::optional<Outside> there;
        double fraction = 1.0;
        for (; fraction > 1e-3; fraction *= 0.5) {
            there = outside(origin, point, cosines + fraction * step);
            if (there && length(there->ray.direction - there->towards) < error) {
                break;
            }
            there.reset();
        }
        cosines = cosines + fraction * step;
        here = there;
    }
    return std::nullopt;
}

std::optional<RayAtStop> StopAim::to_stop(const Ray<double>& ray) const {
    std::optional<Vec3d> front;
    const auto traced =
        trace(front_, ray, [&](const SurfaceEvent<double>& event) { front = front.value_or(event.ray.origin); });
    const Vec3d start = frame_.to_own(traced.ray.origin - middle_);
    const Vec3d direction = frame_.to_own(traced.ray.direction);
    if (traced.status != RayStatus::ok || !(direction.z > 0.0)) {
        return std::nullopt;
    }
    const Vec3d point = start - (start.z / direction.z) * direction;
    return RayAtStop{.front = front.value_or(middle_ + in_lens(point)),
                     .point = {point.x, point.y},
                     .direction = direction,
                     .transmittance = traced.transmittance};
}

TracedRay<double> StopAim::onwards(const Vec2d& point, const Vec3d& direction) const {
    return trace(rear_, {middle_ + in_lens({point.x, point.y, 0.0}), in_lens(direction)});
}

bool has_plane_stop(const TraceLens<double>& lens, int stop_index) {
    const TraceSurface<double>& stop = lens.surfaces[static_cast<std::size_t>(stop_index)];
    const SpecialSurface<double>* special =
        stop.special < 0 ? nullptr : &lens.specials[static_cast<std::size_t>(stop.special)];
    const bool is_plane =
        stop.curvature == 0.0 && (special == nullptr || (!special->has_shape && special->thin.kind == ThinKind::none));
    return is_plane && stop.index_before == stop.index_after;
}

}  // namespace lensproof::optics
