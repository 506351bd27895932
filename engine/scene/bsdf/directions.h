// engine/scene/bsdf/directions.h — directions about a surface, whose normal is z.
#pragma once
#include <cmath>

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

}  // namespace lensproof::scene
