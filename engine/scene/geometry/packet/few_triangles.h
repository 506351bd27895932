// engine/scene/geometry/packet/few_triangles.h — a scene's few triangles, met one and all by a ray, or by several in
// step.
//
// Each stands for itself by affine functions of a point in the world: its height over the plane, mm, and the
// barycentric coordinates of the second and third vertex (Baldwin and Weber, "Fast ray-triangle intersections by
// coordinate transformation", JCGT 5, 2016).
#pragma once
#include <array>
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
template <class T>
struct AffineFunction {
    Vec3<T> gradient;
    T at_origin{};

    [[nodiscard]] T along(const Vec3<T>& direction) const { return dot(gradient, direction); }
    [[nodiscard]] T at(const Vec3<T>& point) const { return dot(gradient, point) + at_origin; }
};

/// Where a ray meets a plane on its stretch.
template <class T>
struct PlaneMeeting {
    MaskOf<T> is_met{};
    T at{};
    Vec3<T> point;
};

template <class T>
PlaneMeeting<T> meet_plane(const AffineFunction<T>& height, const Stretch<T>& ray) {
    const T at = -height.at(ray.origin) / height.along(ray.direction);
    return {.is_met = at > ray.from && at < ray.to, .at = at, .point = ray.origin + at * ray.direction};
}

/// A triangle's place in its plane. A slope: the length of the gradient, per mm.
template <class T>
struct TriangleInPlane {
    AffineFunction<T> b1;
    AffineFunction<T> b2;
    T b1_slope{};
    T b2_slope{};
};

/// Triangles grown by more than rounding does to the coordinates of a meeting, 16 roundings of `reach_mm`, which is
/// that of the ray's origin and theirs: a ray at the edge of two, or at a vertex of many, so meets one of them. (Of a
/// million aimed to the last bit hundreds are lost with half a rounding, none with four.) `ray_origin` moves rays
/// farther off the surface that they leave than its neighbours are grown.
template <class T>
Crossing<T> meet_in_plane(const TriangleInPlane<T>& triangle, const PlaneMeeting<T>& plane, const T& reach_mm) {
    const T b1 = triangle.b1.at(plane.point);
    const T b2 = triangle.b2.at(plane.point);
    const T seam = T(16.0 * 0x1p-53) * reach_mm;
    const T seam1 = seam * triangle.b1_slope;
    const T seam2 = seam * triangle.b2_slope;
    return {.is_met = plane.is_met && b1 >= -seam1 && b2 >= -seam2 && b1 + b2 <= T(1.0) + (seam1 + seam2),
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
    AffineFunction<double> height;
    std::size_t end = 0;  // of its triangles, which begin where those of the plane before end
};

/// The same triangles for one ray and for many, which have the same bits.
struct FewTriangles {
    std::vector<TriangleBlock> blocks;
    std::vector<TrianglePlane> planes;
    std::vector<TriangleInPlane<double>> triangles;
    double reach_mm = 0.0;  // of the farthest vertex

    /// Adds a triangle that lies within `reach_mm`.
    void add(const TriangleSides& sides);

    [[nodiscard]] bool is_empty() const { return triangles.empty(); }
};

}  // namespace lensproof::scene
