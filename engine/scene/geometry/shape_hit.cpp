#include "engine/scene/geometry/shape_hit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/elementary.h"

namespace lensproof::scene {

namespace {

/// `v` without its part along the unit vector `normal`, of unit length; any direction at right angles where none is
/// left (Duff et al., "Building an orthonormal basis, revisited", JCGT 6, 2017).
Vec3d tangent_along(const Vec3d& v, const Vec3d& normal) {
    const Vec3d across = v - dot(v, normal) * normal;
    const double squared = dot(across, across);
    if (squared > 1e-16 * dot(v, v)) {
        return (1.0 / std::sqrt(squared)) * across;
    }
    const double sign = std::copysign(1.0, normal.z);
    const double a = -1.0 / (sign + normal.z);
    return {1.0 + sign * normal.x * normal.x * a, sign * normal.x * normal.y * a, -sign * normal.x};
}

/// The derivative of the point by u where the triangle has uvs that allow one, else its first edge.
Vec3d u_direction(const std::array<Vec3d, 3>& p, const std::array<Vec2<float>, 3>& uv) {
    const Vec2d a{double(uv[1].x) - uv[0].x, double(uv[1].y) - uv[0].y};
    const Vec2d b{double(uv[2].x) - uv[0].x, double(uv[2].y) - uv[0].y};
    const double area = a.x * b.y - a.y * b.x;
    const Vec3d along = b.y * (p[1] - p[0]) - a.y * (p[2] - p[0]);
    return area == 0.0 || !(dot(along, along) > 0.0) ? p[1] - p[0] : std::copysign(1.0, area) * along;
}

/// Longitude and latitude of a direction from the centre.
Vec2d uv_on_sphere(const Vec3d& n) {
    const double turn = turns_of(n.x, n.y);
    // From the pole's distance as well: an arc sine alone loses half its digits there.
    const double elevation = 2.0 * turns_of(std::sqrt(n.x * n.x + n.y * n.y), n.z);
    return {turn < 0.0 ? turn + 1.0 : turn, 0.5 + elevation};
}

}  // namespace

std::optional<Meeting<double>> meet(const TriangleSides& triangle, double float_b1, double float_b2, double near,
                                    const Stretch<double>& ray) {
    // Möller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997.
    const auto& [first, e1, e2] = triangle;
    const Vec3d from_first = ray.origin - first;
    const Vec3d across = cross(ray.direction, e2);
    const Vec3d q = cross(from_first, e1);
    const double scale = 1.0 / dot(e1, across);
    Meeting<double> meeting{
        .at = scale * dot(e2, q), .b1 = scale * dot(from_first, across), .b2 = scale * dot(ray.direction, q)};
    if (!(meeting.b1 >= 0.0 && meeting.b2 >= 0.0 && meeting.b1 + meeting.b2 <= 1.0)) {
        const double b1 = std::max(float_b1, 0.0);
        const double b2 = std::max(float_b2, 0.0);
        const double sum = std::max(b1 + b2, 1.0);
        meeting.b1 = b1 / sum;
        meeting.b2 = b2 / sum;
        meeting.at =
            dot(meeting.b1 * e1 + meeting.b2 * e2 - from_first, ray.direction) / dot(ray.direction, ray.direction);
        if (!(meeting.at > near)) {
            return std::nullopt;
        }
    }
    return meeting.at > ray.from && meeting.at < ray.to ? std::optional(meeting) : std::nullopt;
}

std::array<Vec3d, 3> corners(const TriangleMesh& mesh, std::uint32_t triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    return {converted<double>(mesh.positions[a]), converted<double>(mesh.positions[b]),
            converted<double>(mesh.positions[c])};
}

TriangleSides sides(const TriangleMesh& mesh, std::uint32_t triangle) {
    const auto [a, b, c] = corners(mesh, triangle);
    return {a, b - a, c - a};
}

ShapePoint shape_point(const TriangleMesh& mesh, std::uint32_t triangle, double b1, double b2) {
    const std::array<Vec3d, 3> p = corners(mesh, triangle);
    const auto& [i0, i1, i2] = mesh.triangles[triangle];
    const Vec3d e1 = p[1] - p[0];
    const Vec3d e2 = p[2] - p[0];
    const Vec3d area = cross(e1, e2);
    const double per_area2 = 1.0 / dot(area, area);
    ShapePoint at{.point = p[0] + b1 * e1 + b2 * e2, .geometric_normal = std::sqrt(per_area2) * area, .uv = {b1, b2}};
    at.shading_normal = at.geometric_normal;
    at.sharpness = std::sqrt(dot(e1, e1) * dot(e2, e2) * per_area2);
    const double b0 = 1.0 - b1 - b2;
    if (!mesh.normals.empty()) {
        const Vec3d mean = b0 * converted<double>(mesh.normals[i0]) + b1 * converted<double>(mesh.normals[i1]) +
                           b2 * converted<double>(mesh.normals[i2]);
        if (dot(mean, at.geometric_normal) > 0.0) {
            at.shading_normal = normalized(mean);
        }
    }
    Vec3d along = e1;
    if (!mesh.uvs.empty()) {
        const std::array<Vec2<float>, 3> uv = {mesh.uvs[i0], mesh.uvs[i1], mesh.uvs[i2]};
        at.uv = {b0 * uv[0].x + b1 * uv[1].x + b2 * uv[2].x, b0 * uv[0].y + b1 * uv[1].y + b2 * uv[2].y};
        along = u_direction(p, uv);
    }
    at.tangent = tangent_along(along, at.shading_normal);
    return at;
}

ShapePoint shape_point(const Sphere& sphere, const Vec3d& towards, bool wants_uv) {
    const Vec3d n = normalized(towards);
    return {.point = sphere.radius_mm * n,
            .geometric_normal = n,
            .shading_normal = n,
            .tangent = tangent_along({-n.y, n.x, 0.0}, n),
            .uv = wants_uv ? uv_on_sphere(n) : Vec2d{}};
}

ShapePoint shape_point(const Quad& quad, double x, double y) {
    const double inside_x = std::clamp(x, -0.5 * quad.width_mm, 0.5 * quad.width_mm);
    const double inside_y = std::clamp(y, -0.5 * quad.height_mm, 0.5 * quad.height_mm);
    return {.point = {inside_x, inside_y, 0.0},
            .geometric_normal = {0, 0, 1},
            .shading_normal = {0, 0, 1},
            .tangent = {1, 0, 0},
            .uv = {inside_x / quad.width_mm + 0.5, inside_y / quad.height_mm + 0.5}};
}

SurfaceHit world_hit(const ObjectPlace& place, const ShapePoint& at) {
    SurfaceHit hit{.point = map_point(place.to_world, at.point), .uv = at.uv};
    const Matrix3& ahead = place.to_world.linear;
    const Matrix3& back = place.to_local.linear;  // normals are carried by its transpose
    const auto carried = [&](const Vec3d& normal) {
        return place.is_rigid ? ahead * normal : normalized(transposed_times(back, normal));
    };
    hit.geometric_normal = carried(at.geometric_normal);
    const bool is_flat = at.shading_normal == at.geometric_normal;
    hit.shading_normal = is_flat ? hit.geometric_normal : carried(at.shading_normal);
    hit.tangent = place.is_rigid ? ahead * at.tangent : tangent_along(ahead * at.tangent, hit.shading_normal);
    // A point passes some ten operations on its way into the shape's frame and back, each with the rounding of the
    // largest number involved; a map that stretches unevenly carries an error along one direction to another.
    constexpr double kRoundings = 32.0;
    hit.error_mm = kRoundings * place.epsilon * at.sharpness * place.rounding_growth *
                   (largest_coordinate(hit.point) + place.reach_mm);
    return hit;
}

}  // namespace lensproof::scene
