// engine/base/basis.h — an orthonormal frame about a direction.
#pragma once
#include <cmath>

#include "engine/base/vec.h"

namespace lensproof {

/// Three unit vectors at right angles, right-handed, `z` being given.
struct Basis {
    Vec3d x;
    Vec3d y;
    Vec3d z;

    /// Any x and y (Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017).
    explicit Basis(const Vec3d& normal) : z(normal) {
        const double sign = std::copysign(1.0, z.z);
        const double a = -1.0 / (sign + z.z);
        const double b = z.x * z.y * a;
        x = {1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x};
        y = {b, sign + z.y * z.y * a, -z.y};
    }

    /// `tangent`: at right angles to `normal`, of unit length.
    Basis(const Vec3d& normal, const Vec3d& tangent) : x(tangent), y(cross(normal, tangent)), z(normal) {}

    [[nodiscard]] Vec3d to_world(const Vec3d& local) const { return local.x * x + local.y * y + local.z * z; }
    [[nodiscard]] Vec3d to_local(const Vec3d& world) const { return {dot(world, x), dot(world, y), dot(world, z)}; }
};

}  // namespace lensproof
