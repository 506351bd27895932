#include "engine/scene/geometry/mesh_normals.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "engine/base/angle.h"

namespace lensproof::scene {

namespace {

/// A triangle's corner: its vertex, its triangle's normal (unit length, or none) and its weight.
struct Corner {
    std::uint32_t vertex = 0;
    Vec3d normal;
    double angle = 0.0;
};

std::vector<Corner> corners_of(const TriangleMesh& mesh) {
    std::vector<Corner> corners;
    corners.reserve(3 * mesh.triangles.size());
    for (const auto& triangle : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto at = [&](std::size_t k) { return converted<double>(mesh.positions[triangle[(i + k) % 3]]); };
            const Vec3d to_next = at(1) - at(0);
            const Vec3d to_last = at(2) - at(0);
            const Vec3d area = cross(to_next, to_last);
            const double size = length(area);
            Corner corner{.vertex = triangle[i]};
            if (size > 0.0) {
                corner.normal = (1.0 / size) * area;
                corner.angle = std::atan2(size, dot(to_next, to_last));
            }
            corners.push_back(corner);
        }
    }
    return corners;
}

/// A place by its floats' bits, which order whatever is there, NaN too; −0 is 0.
std::array<std::uint32_t, 3> key_of(const Vec3<float>& p) {
    return {std::bit_cast<std::uint32_t>(p.x + 0.0F), std::bit_cast<std::uint32_t>(p.y + 0.0F),
            std::bit_cast<std::uint32_t>(p.z + 0.0F)};
}

using PlacedCorner = std::pair<std::array<std::uint32_t, 3>, std::uint32_t>;  // and which corner it is

/// All corners, those at one place next to each other.
std::vector<PlacedCorner> by_place(const TriangleMesh& mesh, const std::vector<Corner>& corners) {
    std::vector<PlacedCorner> order;
    order.reserve(corners.size());
    for (const Corner& corner : corners) {
        order.emplace_back(key_of(mesh.positions[corner.vertex]), static_cast<std::uint32_t>(order.size()));
    }
    std::ranges::sort(order);
    return order;
}

std::vector<Vec3<float>> corner_normals(const TriangleMesh& mesh, const std::vector<Corner>& corners,
                                        double crease_deg) {
    constexpr std::size_t kMostThatMeet = 1000;
    const double least_cosine = std::cos(radians(crease_deg));
    const std::vector<PlacedCorner> order = by_place(mesh, corners);
    std::vector<Vec3<float>> normals(corners.size());
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        while (end < order.size() && order[end].first == order[begin].first) {
            ++end;
        }
        const bool is_smooth = end - begin <= kMostThatMeet;
        for (std::size_t i = begin; i < end; ++i) {
            const Corner& own = corners[order[i].second];
            Vec3d mean = own.angle * own.normal;
            for (std::size_t k = begin; is_smooth && k < end; ++k) {
                const Corner& other = corners[order[k].second];
                if (k != i && dot(own.normal, other.normal) > least_cosine) {
                    mean = mean + other.angle * other.normal;
                }
            }
            if (length(mean) > 0.0) {
                normals[order[i].second] = converted<float>(normalized(mean));
            }
        }
    }
    return normals;
}

}  // namespace

TriangleMesh with_smooth_normals(const TriangleMesh& mesh, double crease_deg) {
    const std::vector<Corner> corners = corners_of(mesh);
    const std::vector<Vec3<float>> normals = corner_normals(mesh, corners, crease_deg);
    TriangleMesh result{.name = mesh.name};
    result.triangles.resize(mesh.triangles.size());
    std::map<std::tuple<std::uint32_t, float, float, float>, std::uint32_t> vertices;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3<float>& n = normals[i];
        const std::uint32_t old = corners[i].vertex;
        const auto next = static_cast<std::uint32_t>(result.positions.size());
        const auto [place, is_new] = vertices.try_emplace({old, n.x, n.y, n.z}, next);
        if (is_new) {
            result.positions.push_back(mesh.positions[old]);
            result.normals.push_back(n);
            if (!mesh.uvs.empty()) {
                result.uvs.push_back(mesh.uvs[old]);
            }
        }
        result.triangles[i / 3][i % 3] = place->second;
    }
    return result;
}

}  // namespace lensproof::scene
