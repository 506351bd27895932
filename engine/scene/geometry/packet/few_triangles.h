// engine/scene/geometry/packet/few_triangles.h — a scene's few triangles, met one and all by a ray, or by several in
// step.
//
// Each stands for itself by affine functions: of a point in the world its height over the plane, mm, and of two of the
// coordinates of a point in the plane, all but the one that the normal is longest along, the barycentric coordinates of
// the second and third vertex (Baldwin and Weber, "Fast ray-triangle intersections by coordinate transformation", JCGT
// 5, 2016).
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/base/select.h"
#include "engine/scene/geometry/packet/analytic_meeting.h"

namespace lensproof::scene {

/// A triangle's first vertex, and the ways from there to the others.
struct TriangleSides {
    Vec3d first;
    Vec3d to_second;
    Vec3d to_third;
};

/// gradient · point + at_origin.
template <template <class> class Vector, class T>
struct AffineFunction {
    Vector<T> gradient;
    T at_origin{};

    [[nodiscard]] T along(const Vector<T>& direction) const { return dot(gradient, direction); }
    [[nodiscard]] T at(const Vector<T>& point) const { return dot(gradient, point) + at_origin; }
};

/// Where a ray meets a plane on its stretch.
template <class T>
struct PlaneMeeting {
    MaskOf<T> is_met{};
    T at{};
};

template <class T>
PlaneMeeting<T> meet_plane(const AffineFunction<Vec3, T>& height, const Stretch<T>& ray) {
    const T at = -height.at(ray.origin) / height.along(ray.direction);
    return {.is_met = at > ray.from && at < ray.to, .at = at};
}

/// A triangle's place in its plane: of the two coordinates, or of all three, the third with a slope of 0.
template <template <class> class Vector, class T>
struct TriangleInPlane {
    AffineFunction<Vector, T> b1;
    AffineFunction<Vector, T> b2;
};

/// Where a triangle ends.
template <class T>
struct TriangleRim {
    T least_b1{};
    T least_b2{};
    T most_sum{};
};

/// That of a triangle grown by more than rounding does to the coordinates of a meeting, 16 roundings of `reach_mm`: a
/// ray at the edge of two, or at a vertex of many, so meets one of them. (Of a million aimed to the last bit tens are
/// lost with half a rounding, none with one.) A slope is the length of a gradient, per mm. `ray_origin` moves rays
/// farther off the surface that they leave than its neighbours are grown.
template <class T>
TriangleRim<T> grown_rim(const T& b1_slope, const T& b2_slope, const T& reach_mm) {
    const T seam = T(16.0 * 0x1p-53) * reach_mm;
    const T seam1 = seam * b1_slope;
    const T seam2 = seam * b2_slope;
    return {.least_b1 = -seam1, .least_b2 = -seam2, .most_sum = T(1.0) + (seam1 + seam2)};
}

template <template <class> class Vector, class T>
Crossing<T> meet_in_plane(const TriangleInPlane<Vector, T>& triangle, const TriangleRim<T>& rim,
                          const PlaneMeeting<T>& plane, const Vector<T>& point) {
    const T b1 = triangle.b1.at(point);
    const T b2 = triangle.b2.at(point);
    return {.is_met = plane.is_met && b1 >= rim.least_b1 && b2 >= rim.least_b2 && b1 + b2 <= rim.most_sum,
            .meeting = {.at = plane.at, .b1 = b1, .b2 = b2}};
}

/// Triangles side by side, for one ray. A lane of zeros is met by nothing.
struct alignas(64) TriangleBlock {
    static constexpr std::size_t kLanes = 8;
    using Column = std::array<double, kLanes>;
    struct Function {
        Column x, y, z, at_origin;
    };
    Function height;
    Function b1, b2;
    Column b1_slope, b2_slope;
};

/// Triangles that lie next to each other in the list and in one plane, whose meeting many rays then share.
struct TrianglePlane {
    AffineFunction<Vec3, double> height;
    std::array<std::size_t, 2> across{};  // the coordinates that its triangles count by: 0 x, 1 y, 2 z
    std::size_t end = 0;                  // of its triangles, which begin where those of the plane before end
};

struct FlatTriangle {
    TriangleInPlane<Vec2, double> in_plane;
    double b1_slope = 0.0;
    double b2_slope = 0.0;
    TriangleRim<double> near_rim;  // for rays from within the triangles' reach
};

/// The same triangles for one ray and for many, which have the same bits.
struct FewTriangles {
    std::vector<TriangleBlock> blocks;
    std::vector<TrianglePlane> planes;
    std::vector<FlatTriangle> triangles;
    double reach_mm = 0.0;  // of the farthest vertex

    /// Adds a triangle that lies within `reach_mm`.
    void add(const TriangleSides& sides);

    [[nodiscard]] bool is_empty() const { return triangles.empty(); }

    /// What roundings are taken of, for a ray from there: how far it and the triangles are from the world's origin.
    template <class T>
    [[nodiscard]] T reach_from(const Vec3<T>& origin) const {
        using std::abs;
        const auto larger = [](const T& a, const T& b) { return select(a < b, b, a); };
        return larger(larger(larger(abs(origin.x), abs(origin.y)), abs(origin.z)), T(reach_mm)) + T(reach_mm);
    }
    [[nodiscard]] double near_reach() const { return reach_mm + reach_mm; }
};

}  // namespace lensproof::scene
