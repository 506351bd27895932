// tests/engine/scene/scene_shapes.h — shapes and maps that several tests of scenes use.
#pragma once
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "engine/scene/geometry/geometry.h"

namespace lensproof::scene::test {

inline Vec3d random_direction(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    return normalized(Vec3d{normal(random), normal(random), normal(random)});
}

inline double uniform(std::mt19937_64& random, double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
}

inline AffineMap at(const Vec3d& translation, const Matrix3& linear = kIdentity3) {
    return {.linear = linear, .translation = translation};
}

inline Matrix3 scaled(double x, double y, double z) {
    return {Vec3d{x, 0, 0}, Vec3d{0, y, 0}, Vec3d{0, 0, z}};
}

/// A scene of one object.
inline SceneGeometry scene_of(Shape shape, const AffineMap& to_world = {},
                              HitPrecision precision = HitPrecision::in_double) {
    return {{std::move(shape)}, {{.shape = 0, .to_world = to_world}}, precision};
}

/// An icosahedron with its triangles cut into four `levels` times, all vertices on a sphere; closed, 20·4^levels
/// triangles that share their vertices.
inline TriangleMesh icosphere(double radius_mm, int levels) {
    const double t = 0.5 * (1.0 + std::sqrt(5.0));
    std::vector<Vec3d> points = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                                 {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
    std::vector<std::array<std::uint32_t, 3>> faces = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                                       {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                                       {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                                       {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), points.size());
            if (is_new) {
                points.push_back(points[a] + points[b]);
            }
            return place->second;
        };
        for (Vec3d& point : points) {
            point = normalized(point);
        }
        std::vector<std::array<std::uint32_t, 3>> finer;
        for (const auto& [a, b, c] : faces) {
            const std::uint32_t ab = middle(a, b);
            const std::uint32_t bc = middle(b, c);
            const std::uint32_t ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        faces = std::move(finer);
    }
    TriangleMesh mesh{.name = "icosphere", .triangles = faces};
    for (const Vec3d& point : points) {
        mesh.positions.push_back(converted<float>(radius_mm * normalized(point)));
    }
    return mesh;
}

/// A closed box of twelve triangles about the origin.
inline TriangleMesh box_mesh(float half) {
    TriangleMesh mesh{.name = "box"};
    for (int i = 0; i < 8; ++i) {
        mesh.positions.push_back(
            {(i & 1) != 0 ? half : -half, (i & 2) != 0 ? half : -half, (i & 4) != 0 ? half : -half});
    }
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

}  // namespace lensproof::scene::test
