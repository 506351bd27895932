// engine/scene/geometry/shapes.h — the surfaces that a scene is made of, each in its own frame; mm.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "engine/base/vec.h"

namespace lensproof::scene {

/// Triangles with shared vertices. Their outward side is the one from which their vertices run counter-clockwise.
/// Coordinates are floats, and those floats are the surface: what is found on it is computed from them in double.
struct TriangleMesh {
    std::string name;  // of the file, for messages
    std::vector<Vec3<float>> positions;
    std::vector<Vec3<float>> normals;  // one for each position and of unit length, or none: flat
    std::vector<Vec2<float>> uvs;      // one for each position, v upwards, or none
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Centred at the origin. uv: u runs around z from +x over +y, v from 0 at the pole −z to 1 at +z.
struct Sphere {
    double radius_mm = 0.0;
};

/// A rectangle in the plane z = 0, centred at the origin. Its front is +z; seen from there x runs to the right, y up,
/// and uv from (0, 0) at the lower left to (1, 1).
struct Quad {
    double width_mm = 0.0;
    double height_mm = 0.0;
};

using Shape = std::variant<TriangleMesh, Sphere, Quad>;

template <class To, class From>
Vec3<To> converted(const Vec3<From>& v) {
    return {static_cast<To>(v.x), static_cast<To>(v.y), static_cast<To>(v.z)};
}

/// Makes a mesh fit to be traced, and says what was done, a sentence each:
/// - triangles without an area are dropped (their vertices coincide or lie on a line, exactly);
/// - triangles that stand against their vertices' normals are turned round, so that both have one outward side;
/// - normals of no length or with numbers that are not finite are left out, all of them: the mesh is flat then.
/// Throws InputError naming the mesh and the vertex or triangle: a coordinate that is not finite or beyond 1e12 mm, an
/// index without a vertex, as many normals or uvs as there are no positions; and a mesh without any triangle.
std::vector<std::string> repair(TriangleMesh& mesh);

}  // namespace lensproof::scene
