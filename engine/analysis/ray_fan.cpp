#include "engine/analysis/ray_fan.h"

#include <algorithm>
#include <cmath>

#include "engine/optics/rim_margin.h"

namespace lensproof::analysis {

namespace {

/// The offsets along the fan between which rays pass, lower first; nothing where none is known to.
struct Extent {
    double lower;
    double upper;
};

std::optional<Extent> fan_extent(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle,
                                 const optics::RegionOutline& outline, FanPlane plane) {
    const optics::Region region = [&](Vec2d offset) {
        return optics::rim_margin(lens, bundle.ray(offset), optics::Direction::forward);
    };
    const bool is_tangential = plane == FanPlane::tangential;
    double inside = 0.0;
    if (!(region({}).margin < 0.0)) {
        if (!is_tangential || outline.centre.x != 0.0 || outline.is_empty()) {
            return std::nullopt;
        }
        inside = outline.centre.y;
    }
    // As far as a disc of the beam's area reaches.
    const double hint = std::sqrt(outline.area);
    const auto reach = [&](double sign) {
        const Vec2d from = is_tangential ? Vec2d{0.0, inside} : Vec2d{inside, 0.0};
        const Vec2d along = is_tangential ? Vec2d{0.0, sign} : Vec2d{sign, 0.0};
        return inside + sign * optics::region_edge(region, from, along, hint).distance;
    };
    return Extent{reach(-1.0), reach(1.0)};
}

}  // namespace

std::optional<Vec2d> transverse_error(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle,
                                      Vec2d offset, Vec2d reference) {
    const auto traced = optics::trace_past_rims(lens, bundle.ray(offset));
    if (!optics::gets_through(traced.status) || !(traced.ray.direction.z > 0.0)) {
        return std::nullopt;
    }
    const Vec3d point = optics::meet_plane(traced.ray, lens.image_z).point;
    return Vec2d{point.x, point.y} - reference;
}

std::vector<FanPoint> ray_fan(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle,
                              const optics::RegionOutline& outline, FanPlane plane, Vec2d reference, int count) {
    const std::optional<Extent> extent = fan_extent(lens, bundle, outline, plane);
    if (!extent) {
        return {};
    }
    const double farther = std::max(std::abs(extent->lower), std::abs(extent->upper));
    std::vector<FanPoint> fan;
    for (int i = 0; i < count; ++i) {
        const double t = static_cast<double>(i) / (count - 1);
        const double offset = (1.0 - t) * extent->lower + t * extent->upper;
        const Vec2d at = plane == FanPlane::tangential ? Vec2d{0.0, offset} : Vec2d{offset, 0.0};
        if (const std::optional<Vec2d> error = transverse_error(lens, bundle, at, reference)) {
            fan.push_back({.pupil = offset / farther, .offset = offset, .error = *error});
        }
    }
    return fan;
}

}  // namespace lensproof::analysis
