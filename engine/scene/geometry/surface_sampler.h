// engine/scene/geometry/surface_sampler.h — points drawn on an object's surface, as lights need them.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/scene/geometry/geometry.h"

namespace lensproof::scene {

struct Facet;

/// A point on an object, in the world.
struct SurfaceSample {
    Vec3d point;
    Vec3d geometric_normal;  // outward
    Vec2d uv;
    double pdf_per_mm2 = 0.0;  // of having drawn this point
    std::uint32_t primitive = 0;
    double error_mm = 0.0;  // as `SurfaceHit::error_mm`: to be given to `ray_origin`
};

/// Draws points of one object. Even on meshes and quads under any map, and on spheres that stay spheres; on a sphere
/// that its map makes an ellipsoid, even on the sphere, with the pdf that this has on the ellipsoid.
class SurfaceSampler {
  public:
    /// `scene` has to outlive the sampler.
    SurfaceSampler(const SceneGeometry& scene, std::uint32_t object);

    /// From two numbers in [0, 1), which evenly spread points keep spread: of a mesh, the first chooses the triangle by
    /// its area and what is left of it the place.
    [[nodiscard]] SurfaceSample sample(double u1, double u2) const;
    /// The pdf with which `sample` draws a point of this object that a ray has met, per mm².
    [[nodiscard]] double pdf_per_mm2(const SurfaceHit& hit) const;
    [[nodiscard]] double area_mm2() const { return area_mm2_; }

    /// Of a quad its one piece, of a mesh its triangles where they are kept; else none.
    [[nodiscard]] std::span<const Facet> facets() const;
    /// Of a mesh, as `place_on_triangle` has them; else none.
    [[nodiscard]] std::span<const double> areas_to_mm2() const { return areas_to_mm2_; }

  private:
    [[nodiscard]] SurfaceSample drawn(const SurfaceHit& hit) const;
    [[nodiscard]] SurfaceSample drawn(const Facet& facet, double a, double b) const;

    const SceneGeometry* scene_;
    std::uint32_t object_;
    std::vector<double> areas_to_mm2_;
    double area_mm2_ = 0.0;
    double even_pdf_ = 0.0;  // 1 over it
};

}  // namespace lensproof::scene
