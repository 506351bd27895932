// engine/scene/geometry/shape_hit.h — single shapes met by a ray, in double.
#pragma once
#include <cstdint>
#include <limits>
#include <optional>

#include "engine/base/affine.h"
#include "engine/scene/geometry/geometry.h"
#include "engine/scene/geometry/packet/analytic_meeting.h"
#include "engine/scene/geometry/packet/few_triangles.h"
#include "engine/scene/geometry/shapes.h"

namespace lensproof::scene {

/// The triangle that Embree's float ray has met at barycentric coordinates (float_b1, float_b2).
///
/// Its plane is met again in double. Where that lies outside the triangle, the true ray has gone by its edge within
/// float's rounding, and Embree has found this triangle instead of its neighbour: the point that Embree names is taken,
/// so that closed meshes stay closed; but not within float's rounding of the origin, `near`, where it could be the
/// surface that the ray is just leaving.
std::optional<Meeting<double>> meet(const TriangleSides& triangle, double float_b1, double float_b2, double near,
                                    const Stretch<double>& ray);

/// The triangle's vertices, and its sides.
std::array<Vec3d, 3> corners(const TriangleMesh& mesh, std::uint32_t triangle);
TriangleSides sides(const TriangleMesh& mesh, std::uint32_t triangle);

/// A surface's point with all that belongs to it, in the shape's own frame; `uv`, normals and tangent as in
/// `SurfaceHit`.
struct ShapePoint {
    Vec3d point;
    Vec3d geometric_normal;
    Vec3d shading_normal;
    Vec3d tangent;
    Vec2d uv;
    double sharpness = 1.0;  // of a triangle: how much more than its size rounding moves its plane, 1 / sin of a corner
};

ShapePoint shape_point(const TriangleMesh& mesh, std::uint32_t triangle, double b1, double b2);
/// `towards` is any point but the centre: its radius leads to the one meant. uv is (0, 0) unless it is wanted.
ShapePoint shape_point(const Sphere& sphere, const Vec3d& towards, bool wants_uv);
/// (x, y) on the quad, mm.
ShapePoint shape_point(const Quad& quad, double x, double y);

/// Where an object stands: its map, the one back, and what rounding does on both.
struct ObjectPlace {
    AffineMap to_world;
    AffineMap to_local;
    double rounding_growth = 1.0;  // on the way through both maps, which may carry it from one axis to another
    bool is_rigid = true;          // `to_world` keeps lengths and angles, to rounding
    double reach_mm = 0.0;  // of a coordinate that the map handles: the shape's, in the world, and the translation
    double epsilon = std::numeric_limits<double>::epsilon();  // of the numbers in which rays meet it
};

/// The point in the world, a hit without a distance, material, object and primitive.
SurfaceHit world_hit(const ObjectPlace& place, const ShapePoint& at);

}  // namespace lensproof::scene
