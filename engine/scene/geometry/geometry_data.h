// engine/scene/geometry/geometry_data.h — what a SceneGeometry holds, for those who build and ask it.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/scene/geometry/embree.h"
#include "engine/scene/geometry/facet.h"
#include "engine/scene/geometry/geometry.h"
#include "engine/scene/geometry/shape_hit.h"

namespace lensproof::scene {

/// What float's rounding does to a coordinate on its way through Embree, generously: it only costs a few candidates
/// more.
inline constexpr double kFloatRoundings = 64.0 * 0x1p-24;

inline double reach(const Box& box) {
    return std::max(largest_coordinate(box.low), largest_coordinate(box.high));
}

/// An object with all that a hit on it takes.
struct PlacedObject {
    SceneObject object;
    ObjectPlace place;
    const Shape* shape = nullptr;
    Box bounds;
    std::vector<Facet>
        facets;  // of a quad; of each triangle of a mesh, if that is kept (geometry_build.cpp); else none
    bool is_of_few_triangles = false;
};

struct MeshTriangle {
    std::uint32_t object = 0;
    std::uint32_t primitive = 0;
};

struct SceneGeometry::Data {
    std::vector<Shape> shapes;
    std::vector<int> uses;  // of each shape, by objects
    std::vector<PlacedObject> objects;
    std::vector<AnalyticObject> analytic;    // the spheres and quads among them, the primitives of one Embree geometry
    bool tests_analytic_one_by_one = false;  // a handful is sooner tested so than found by Embree
    /// Those of small meshes, so few that each ray is tested against each; Embree does not know of them.
    FewTriangles triangles;
    std::vector<MeshTriangle> triangle_of;  // by its place among these
    bool has_embree_geometry = false;
    std::vector<std::string> remarks;
    Box bounds;
    double mesh_reach_mm = 0.0;  // of the farthest vertex, in the world
    HitPrecision precision = HitPrecision::in_double;
    embree::Device device;
    std::vector<embree::Scene> instanced;  // of a shape that is instanced, by the shape's index
    embree::Scene scene;

    /// What Embree does not know of, but for the triangles.
    [[nodiscard]] std::span<const AnalyticObject> one_by_one() const {
        return tests_analytic_one_by_one ? std::span(analytic) : std::span<const AnalyticObject>();
    }
    [[nodiscard]] const TriangleMesh& mesh(std::uint32_t object) const {
        return std::get<TriangleMesh>(*objects[object].shape);
    }
};

// What Embree calls back. The first two for a triangle, in double, or for a sphere or quad whose box Embree's ray has
// met.
void judge_triangle(const RTCFilterFunctionNArguments* arguments);
void intersect_analytic(const RTCIntersectFunctionNArguments* arguments);
void occlude_analytic(const RTCOccludedFunctionNArguments* arguments);
/// An object's box in floats, wide enough for what rounding does to Embree's ray from within some ten times the scene's
/// reach; from farther away an object's rim frays by a few floats.
void bound_analytic(const RTCBoundsFunctionArguments* arguments);

}  // namespace lensproof::scene
