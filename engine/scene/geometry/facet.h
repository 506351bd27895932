// engine/scene/geometry/facet.h — flat pieces of surfaces with all that is the same over them, found ahead.
#pragma once
#include <cstdint>

#include "engine/scene/geometry/shape_hit.h"

namespace lensproof::scene {

/// A quad, or a triangle of a mesh, in the world: the point of sides' parts (a, b), each from 0 to 1, is corner +
/// a along_a + b along_b; of a triangle they are the barycentric coordinates of its second and third vertex.
struct Facet {
    Vec3d corner;
    Vec3d along_a;
    Vec3d along_b;
    Vec3d normal;  // geometric, outward
    Vec3d tangent;
    Vec2d uv;
    Vec2d uv_along_a;
    Vec2d uv_along_b;
    double error_mm = 0.0;  // of any of its points, as in SurfaceHit

    [[nodiscard]] Vec3d point(double a, double b) const { return corner + a * along_a + b * along_b; }
    [[nodiscard]] Vec2d uv_at(double a, double b) const { return uv + a * uv_along_a + b * uv_along_b; }
    /// A hit without a distance, material, object and primitive, shaded flat.
    [[nodiscard]] SurfaceHit hit(double a, double b) const {
        return {.point = point(a, b),
                .geometric_normal = normal,
                .shading_normal = normal,
                .tangent = tangent,
                .uv = uv_at(a, b),
                .error_mm = error_mm};
    }
};

Facet facet_of(const Quad& quad, const ObjectPlace& place);
Facet facet_of(const TriangleMesh& mesh, std::uint32_t triangle, const ObjectPlace& place);

}  // namespace lensproof::scene
