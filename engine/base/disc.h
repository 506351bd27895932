// engine/base/disc.h — a disc, and how to draw points evenly from it.
#pragma once
#include <numbers>

#include "engine/base/elementary.h"
#include "engine/base/vec.h"

namespace lensproof {

/// A disc around the origin of its plane, mm.
struct Disc {
    double radius = 0.0;

    [[nodiscard]] constexpr double area() const { return std::numbers::pi * radius * radius; }
    [[nodiscard]] constexpr bool contains(Vec2d point) const { return dot(point, point) <= radius * radius; }

    /// The point that (u, v) in the unit square maps to, evenly over the disc (Shirley & Chiu, J. Graphics Tools 2(3),
    /// 1997).
    [[nodiscard]] constexpr Vec2d warped(double u, double v) const {
        const double a = 2.0 * u - 1.0;
        const double b = 2.0 * v - 1.0;
        if (a == 0.0 && b == 0.0) {
            return {};
        }
        constexpr double kQuarter = 0.25 * std::numbers::pi;
        if (a * a > b * b) {
            const Vec2d turn = cos_sin_within_eighth(kQuarter * b / a);
            return {radius * a * turn.x, radius * a * turn.y};
        }
        const Vec2d turn = cos_sin_within_eighth(kQuarter * a / b);
        return {radius * b * turn.y, radius * b * turn.x};
    }
};

}  // namespace lensproof
