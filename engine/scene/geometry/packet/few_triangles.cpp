#include "engine/scene/geometry/packet/few_triangles.h"

#include <algorithm>
#include <cmath>

namespace lensproof::scene {

namespace {

/// `gradient` · (point − zero).
template <template <class> class Vector>
AffineFunction<Vector, double> function_of(const Vector<double>& gradient, const Vector<double>& zero) {
    return {.gradient = gradient, .at_origin = -dot(gradient, zero)};
}

/// The coordinates other than the one that `normal` is longest along.
std::array<std::size_t, 2> across(const Vec3d& normal) {
    const Vec3d size{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
    if (size.x > size.y && size.x > size.z) {
        return {1, 2};
    }
    return size.y > size.z ? std::array<std::size_t, 2>{0, 2} : std::array<std::size_t, 2>{0, 1};
}

void set_lane(TriangleBlock::Function& block, std::size_t lane, const AffineFunction<Vec3, double>& function) {
    block.x[lane] = function.gradient.x;
    block.y[lane] = function.gradient.y;
    block.z[lane] = function.gradient.z;
    block.at_origin[lane] = function.at_origin;
}

/// By all three coordinates.
AffineFunction<Vec3, double> in_world(const AffineFunction<Vec2, double>& function, const TrianglePlane& plane) {
    std::array<double, 3> gradient{};
    gradient[plane.across[0]] = function.gradient.x;
    gradient[plane.across[1]] = function.gradient.y;
    return {.gradient = {gradient[0], gradient[1], gradient[2]}, .at_origin = function.at_origin};
}

}  // namespace

void FewTriangles::add(const TriangleSides& sides) {
    const Vec3d area = cross(sides.to_second, sides.to_third);
    const double per_area2 = 1.0 / dot(area, area);
    // No farther from the plane before than rounding puts a plane off its own triangle.
    const double rounding = 4.0 * 0x1p-53 * reach_mm;
    const auto is_in = [&](const TrianglePlane& plane) {
        return std::ranges::all_of(std::array{sides.first, sides.first + sides.to_second, sides.first + sides.to_third},
                                   [&](const Vec3d& vertex) { return std::abs(plane.height.at(vertex)) <= rounding; });
    };
    if (planes.empty() || !is_in(planes.back())) {
        planes.push_back(
            {.height = function_of<Vec3>(std::sqrt(per_area2) * area, sides.first), .across = across(area)});
    }
    TrianglePlane& plane = planes.back();
    const auto in_plane = [&](const Vec3d& v) {
        const std::array<double, 3> coordinates{v.x, v.y, v.z};
        return Vec2d{coordinates[plane.across[0]], coordinates[plane.across[1]]};
    };
    const Vec2d first = in_plane(sides.first);
    const Vec2d second = in_plane(sides.to_second);
    const Vec2d third = in_plane(sides.to_third);
    const double per_area = 1.0 / (second.x * third.y - second.y * third.x);
    const Vec2d b1 = per_area * Vec2d{third.y, -third.x};
    const Vec2d b2 = per_area * Vec2d{-second.y, second.x};
    const double b1_slope = length(b1);
    const double b2_slope = length(b2);
    triangles.push_back({.in_plane = {.b1 = function_of<Vec2>(b1, first), .b2 = function_of<Vec2>(b2, first)},
                         .b1_slope = b1_slope,
                         .b2_slope = b2_slope,
                         .near_rim = grown_rim(b1_slope, b2_slope, near_reach())});
    plane.end = triangles.size();

    const std::size_t lane = (triangles.size() - 1) % TriangleBlock::kLanes;
    if (lane == 0) {
        blocks.emplace_back();
    }
    TriangleBlock& block = blocks.back();
    set_lane(block.height, lane, plane.height);
    set_lane(block.b1, lane, in_world(triangles.back().in_plane.b1, plane));
    set_lane(block.b2, lane, in_world(triangles.back().in_plane.b2, plane));
    block.b1_slope[lane] = b1_slope;
    block.b2_slope[lane] = b2_slope;
}

}  // namespace lensproof::scene
