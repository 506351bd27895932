// engine/scene/geometry/geometry.h — a scene's surfaces, and what a ray meets of them.
//
// Embree finds candidates in float, along a ray that starts a little behind its origin; every candidate is judged in
// double by the true ray. So a hit on a quad or a sphere is exact to double's rounding up to its edges, one on a
// triangle to double's rounding of the plane through its (float) vertices, and a ray that leaves a surface has to be
// moved off it by double's rounding alone. Which of two triangles a ray meets at their common edge is Embree's word, in
// float: closed meshes are tight at their edges (at a vertex Embree's robust mode is not to the last bit of float), and
// a ray that skims along a mesh at less than 1e-3 rad may take the edge next to it for either side. The smallest
// meshes, which stand in the scene once and have few triangles together, are met in double alone, tight at their
// vertices too.
//
// In float (HitPrecision) Embree's word is taken for the first triangle, without a judge. Of surfaces that are nearer
// to each other than 2^-17 of how far they reach from the world's origin it may take either, and rays leave such a mesh
// by twice as much and do not see what is nearer to it. The rest is as in double.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/affine.h"
#include "engine/base/ray.h"
#include "engine/scene/geometry/shapes.h"

namespace lensproof::scene {

/// A shape, placed in the scene.
struct SceneObject {
    std::uint32_t shape = 0;  // an index
    AffineMap to_world;
    std::uint32_t material = 0;
    bool reads_uv = true;  // what it is made of, or its light; else hits on a sphere do not find their uv
};

/// Where a ray meets a surface. World frame, mm; normals and tangent of unit length.
struct SurfaceHit {
    double distance_mm = 0.0;
    Vec3d point;
    Vec3d geometric_normal;  // on the outward side, wherever the ray comes from
    Vec3d shading_normal;    // on the same side, interpolated between a mesh's vertices
    Vec3d tangent;           // along +u, at right angles to the shading normal
    Vec2d uv;  // as `shapes.h` says; of a mesh without uvs, two barycentric coordinates; (0, 0) where none is wanted
    std::uint32_t material = 0;
    std::uint32_t object = 0;
    std::uint32_t primitive = 0;  // the triangle of a mesh, else 0
    double error_mm = 0.0;        // a bound on how far rounding has moved `point` off its surface
};

struct Box {
    Vec3d low;
    Vec3d high;
};

/// Who says which triangle of Embree's a ray meets first.
enum class HitPrecision : std::uint8_t {
    in_double,  // the true ray, of all that come into question
    in_float,   // Embree; where the ray meets it is found in double
};

/// "double", "float", in the order of the enumeration; and which has a name.
const std::vector<std::string>& hit_precision_names();
const std::string& name_of(HitPrecision precision);
HitPrecision hit_precision_named(const std::string& name);

class SceneGeometry {
  public:
    /// Meshes are repaired; one that stands in the scene once is moved into world coordinates, one that stands there
    /// more often is kept once and instanced. Throws InputError for what `repair` refuses, for an object without a
    /// shape, with a singular map or farther than 1e12 mm away, and for a shape without a size.
    SceneGeometry(std::vector<Shape> shapes, std::vector<SceneObject> objects,
                  HitPrecision precision = HitPrecision::in_double);
    ~SceneGeometry();
    SceneGeometry(SceneGeometry&&) noexcept;
    SceneGeometry& operator=(SceneGeometry&&) noexcept;

    [[nodiscard]] std::size_t object_count() const;
    /// The object and its shape as they are kept: those of a mesh may be in world coordinates by now.
    [[nodiscard]] const SceneObject& object(std::uint32_t index) const;
    [[nodiscard]] const Shape& shape(std::uint32_t object) const;
    /// Encloses every object; nothing but zeros without objects.
    [[nodiscard]] const Box& bounds() const;
    /// What was repaired, a sentence each.
    [[nodiscard]] const std::vector<std::string>& remarks() const;

    struct Data;
    [[nodiscard]] const Data& data() const { return *data_; }

  private:
    std::unique_ptr<const Data> data_;
};

/// The first surface along a ray between `from_mm` and `to_mm` (may be infinite), both excluded; from either side.
/// `direction` has unit length. Where two surfaces are equally far, the one with the lower object index. A ray that is
/// not finite, or starts farther than 1e15 mm from the origin, meets nothing. Safe to call from any number of threads.
std::optional<SurfaceHit> intersect(const SceneGeometry& scene, const Vec3d& origin, const Vec3d& direction,
                                    double from_mm, double to_mm);

/// The same of many rays, from their origins on without end; `hits` has room for as many.
void intersect(const SceneGeometry& scene, std::span<const Ray<double>> rays,
               std::span<std::optional<SurfaceHit>> hits);

/// The way between two points.
struct Segment {
    Vec3d from;
    Vec3d to;
};

/// Whether anything stands between two points; the same for either order. What lies within double's rounding of an end
/// does not count, so that points on surfaces may be asked for; from them `ray_origin` is still the better end, since
/// it holds at grazing angles too.
bool is_occluded(const SceneGeometry& scene, const Vec3d& from, const Vec3d& to);

/// The same of many ways: 1 where anything stands in one, else 0; `are_occluded` has room for as many.
void find_occluded(const SceneGeometry& scene, std::span<const Segment> segments, std::span<std::uint8_t> are_occluded);

/// Where a ray begins that leaves `point` on a surface in `direction`: moved along the normal, to the direction's side,
/// by twice the bound `error_mm` of the point's rounding. The sphere, quad or triangle, which then lies behind, is not
/// met again, at any angle and scale. (Wächter and Binder, "A fast and robust method for avoiding self-intersection",
/// Ray Tracing Gems, ch. 6, 2019, with double's rounding instead of float's.)
inline Vec3d ray_origin(const Vec3d& point, const Vec3d& normal, double error_mm, const Vec3d& direction) {
    return point + std::copysign(2.0 * error_mm, dot(normal, direction)) * normal;
}
inline Vec3d ray_origin(const SurfaceHit& hit, const Vec3d& direction) {
    return ray_origin(hit.point, hit.geometric_normal, hit.error_mm, direction);
}

}  // namespace lensproof::scene
