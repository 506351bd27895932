// engine/scene/geometry/facet.h — flat pieces of surfaces with all that is the same over them, found ahead.
#pragma once
#include <cstdint>

#include "engine/scene/geometry/shape_hit.h"

namespace lensproof::scene {

/// A quad, or a triangle of a mesh, in the world: a point of it lies so far, from 0 to 1, along two of its sides, which
/// of a triangle are the barycentric coordinates of its second and third vertex.
struct Facet {
    TriangleSides sides;
    Vec3d normal;  // geometric, outward
    Vec3d tangent;
    Vec2d uv;
    Vec2d uv_along_a;
    Vec2d uv_along_b;
    double error_mm = 0.0;  // of any of its points, as in SurfaceHit

    [[nodiscard]] Vec3d point(double a, double b) const {
        return sides.first + a * sides.to_second + b * sides.to_third;
    }
    [[nodiscard]] Vec2d uv_at(double a, double b) const { return uv + a * uv_along_a + b * uv_along_b; }
    /// Puts into `hit` what belongs to a point, shaded flat: all but its distance, material, object and primitive.
    void describe(double a, double b, SurfaceHit& hit) const {
        hit.point = point(a, b);
        hit.geometric_normal = normal;
        hit.shading_normal = normal;
        hit.tangent = tangent;
        hit.uv = uv_at(a, b);
        hit.error_mm = error_mm;
    }
};

Facet facet_of(const Quad& quad, const ObjectPlace& place);
Facet facet_of(const TriangleMesh& mesh, std::uint32_t triangle, const ObjectPlace& place);

}  // namespace lensproof::scene
