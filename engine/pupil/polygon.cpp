#include "engine/pupil/polygon.h"

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"

namespace lensproof::pupil {

std::optional<Span> span_at(std::span<const Vec2d> polygon, double x) {
    std::optional<Span> span;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec2d p = polygon[i];
        const Vec2d q = polygon[(i + 1) % polygon.size()];
        if ((p.x > x && q.x > x) || (p.x < x && q.x < x)) {
            continue;
        }
        const double y = p.y + (x - p.x) / (q.x - p.x) * (q.y - p.y);
        const Span here = p.x == q.x ? Span{std::min(p.y, q.y), std::max(p.y, q.y)} : Span{y, y};
        span = span ? Span{std::min(span->lower, here.lower), std::max(span->upper, here.upper)} : here;
    }
    return span;
}

Apex apex_over(Vec2d before, Vec2d p, Vec2d q, Vec2d after) {
    const Vec2d along = p - before;
    const Vec2d back = q - after;
    const Vec2d side = q - p;
    if (!(cross(along, side) > 0.0 && cross(side, after - q) > 0.0)) {
        return {};  // not convex here: the side itself bounds the region
    }
    // p + s along = q + t back, with s, t > 0 unless the outline turns by more than half a circle.
    const double determinant = cross(along, back);
    const double s = cross(side, back) / determinant;
    if (!(determinant < 0.0 || determinant > 0.0) || !(s > 0.0)) {
        return {.point = {}, .area = kInfinity, .exists = false};
    }
    const Vec2d apex = p + s * along;
    return {.point = apex, .area = 0.5 * std::abs(cross(side, apex - p)), .exists = true};
}

}  // namespace lensproof::pupil
