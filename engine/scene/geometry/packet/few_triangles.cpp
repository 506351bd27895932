#include "engine/scene/geometry/packet/few_triangles.h"

#include <algorithm>
#include <cmath>

namespace lensproof::scene {

namespace {

/// `gradient` · (point − zero).
AffineFunction<double> function_of(const Vec3d& gradient, const Vec3d& zero) {
    return {.gradient = gradient, .at_origin = -dot(gradient, zero)};
}

void set_lane(TriangleBlock::Function& block, std::size_t lane, const AffineFunction<double>& function) {
    block.x[lane] = function.gradient.x;
    block.y[lane] = function.gradient.y;
    block.z[lane] = function.gradient.z;
    block.at_origin[lane] = function.at_origin;
}

}  // namespace

void FewTriangles::add(const TriangleSides& sides) {
    const Vec3d area = cross(sides.to_second, sides.to_third);
    const double per_area2 = 1.0 / dot(area, area);
    const Vec3d b1 = per_area2 * cross(sides.to_third, area);
    const Vec3d b2 = per_area2 * cross(area, sides.to_second);
    // No farther from the plane before than rounding puts a plane off its own triangle.
    const double rounding = 4.0 * 0x1p-53 * reach_mm;
    const auto is_in = [&](const TrianglePlane& plane) {
        return std::ranges::all_of(std::array{sides.first, sides.first + sides.to_second, sides.first + sides.to_third},
                                   [&](const Vec3d& vertex) { return std::abs(plane.height.at(vertex)) <= rounding; });
    };
    if (planes.empty() || !is_in(planes.back())) {
        planes.push_back({.height = function_of(std::sqrt(per_area2) * area, sides.first)});
    }
    triangles.push_back({.b1 = function_of(b1, sides.first),
                         .b2 = function_of(b2, sides.first),
                         .b1_slope = length(b1),
                         .b2_slope = length(b2)});
    planes.back().end = triangles.size();

    const std::size_t lane = (triangles.size() - 1) % TriangleBlock::kLanes;
    if (lane == 0) {
        blocks.emplace_back();
    }
    TriangleBlock& block = blocks.back();
    set_lane(block.height, lane, planes.back().height);
    set_lane(block.b1, lane, triangles.back().b1);
    set_lane(block.b2, lane, triangles.back().b2);
    block.b1_slope[lane] = triangles.back().b1_slope;
    block.b2_slope[lane] = triangles.back().b2_slope;
}

}  // namespace lensproof::scene
