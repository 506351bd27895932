// engine/pupil/disc.h — a disc, and how to draw points evenly from it.
#pragma once
#include <numbers>

#include "engine/base/vec.h"

namespace lensproof::pupil {

/// A disc around the origin of its plane, mm.
struct Disc {
    double radius = 0.0;

    [[nodiscard]] double area() const { return std::numbers::pi * radius * radius; }
    [[nodiscard]] bool contains(Vec2d point) const { return dot(point, point) <= radius * radius; }

    /// The point that (u, v) in the unit square maps to, evenly over the disc (Shirley & Chiu, J. Graphics Tools 2(3),
    /// 1997).
    [[nodiscard]] Vec2d warped(double u, double v) const;
};

}  // namespace lensproof::pupil
