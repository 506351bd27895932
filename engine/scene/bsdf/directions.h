// engine/scene/bsdf/directions.h — directions about a surface, whose normal is z.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/base/disc.h"
#include "engine/base/vec.h"

namespace lensproof::scene {

/// Whether both point to the same side of the surface; neither lies in it.
inline bool on_same_side(const Vec3d& a, const Vec3d& b) {
    return a.z * b.z > 0.0;
}

/// `w`, or its mirror image in the surface where it points below.
inline Vec3d upwards(const Vec3d& w) {
    return {w.x, w.y, std::abs(w.z)};
}

/// `upward`, or its mirror image where `side` points below the surface.
inline Vec3d on_side_of(const Vec3d& side, const Vec3d& upward) {
    return {upward.x, upward.y, std::copysign(upward.z, side.z)};
}

/// A direction of z > 0 with the pdf z / π per solid angle, from u1, u2 in (0, 1): a point of the unit disc, lifted
/// onto the hemisphere (Malley).
inline Vec3d cosine_direction(double u1, double u2) {
    const Vec2d at = Disc{1.0}.warped(u1, u2);
    return {at.x, at.y, std::sqrt(std::max(0.0, 1.0 - dot(at, at)))};
}

}  // namespace lensproof::scene
