// engine/pupil/polygon.h — sides and corners of closed polygons in a plane.
#pragma once
#include <optional>
#include <span>

#include "engine/base/vec.h"

namespace lensproof::pupil {

/// The lowest and the highest y that a closed polygon has at x; nothing beside it.
struct Span {
    double lower;
    double upper;
};
std::optional<Span> span_at(std::span<const Vec2d> polygon, double x);

/// The triangle over the side p q, on its right, in which the sides next to it, drawn on, meet: a convex curve through
/// the four points in this order, turning left, stays inside it between p and q. `area` is infinite where they do not
/// meet, 0 where the curve is not convex.
struct Apex {
    Vec2d point;
    double area = 0.0;
    bool exists = false;
};
Apex apex_over(Vec2d before, Vec2d p, Vec2d q, Vec2d after);

}  // namespace lensproof::pupil
