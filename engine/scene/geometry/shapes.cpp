#include "engine/scene/geometry/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/input_error.h"

namespace lensproof::scene {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

constexpr float kFarthestVertex = 1e12F;

bool is_finite(const Vec3<float>& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check_positions(const TriangleMesh& mesh) {
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3<float>& p = mesh.positions[i];
        if (!is_finite(p) || std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > kFarthestVertex) {
            throw InputError(fmt::format("{}: vertex {} is ({}, {}, {}), expected finite numbers within {} mm",
                                         mesh.name, i, p.x, p.y, p.z, kFarthestVertex));
        }
    }
    for (const Vec2<float>& uv : mesh.uvs) {
        if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
            throw InputError(fmt::format("{}: the uv of vertex {} is ({}, {}), expected finite numbers", mesh.name,
                                         &uv - mesh.uvs.data(), uv.x, uv.y));
        }
    }
}

void check_counts(const TriangleMesh& mesh) {
    const std::size_t vertices = mesh.positions.size();
    for (const auto& [what, count] : {std::pair{"normals", mesh.normals.size()}, {"uvs", mesh.uvs.size()}}) {
        if (count != 0 && count != vertices) {
            throw InputError(
                fmt::format("{}: has {} {} for {} vertices, expected one each", mesh.name, count, what, vertices));
        }
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (const std::uint32_t vertex : mesh.triangles[i]) {
            if (vertex >= vertices) {
                throw InputError(fmt::format("{}: triangle {} has the vertex {}, expected one of the {}, from 0",
                                             mesh.name, i, vertex, vertices));
            }
        }
    }
}

/// Twice the area, along the outward normal. Products of floats are exact in double, so that three points on a line
/// give exactly nothing where their differences are floats too.
Vec3d area_vector(const TriangleMesh& mesh, const Triangle& t) {
    const Vec3d a = converted<double>(mesh.positions[t[0]]);
    return cross(converted<double>(mesh.positions[t[1]]) - a, converted<double>(mesh.positions[t[2]]) - a);
}

bool has_usable_normals(const TriangleMesh& mesh) {
    const auto is_usable = [&](std::uint32_t vertex) {
        return is_finite(mesh.normals[vertex]) && length(mesh.normals[vertex]) > 0.0F;
    };
    return mesh.normals.empty() ||
           std::ranges::all_of(mesh.triangles, [&](const Triangle& t) { return std::ranges::all_of(t, is_usable); });
}

std::size_t turn_to_normals(TriangleMesh& mesh) {
    std::size_t turned = 0;
    for (Triangle& t : mesh.triangles) {
        const Vec3<float> sum = mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]];
        if (dot(area_vector(mesh, t), converted<double>(sum)) < 0.0) {
            std::swap(t[1], t[2]);
            ++turned;
        }
    }
    return turned;
}

}  // namespace

std::vector<std::string> repair(TriangleMesh& mesh) {
    check_positions(mesh);
    check_counts(mesh);
    std::vector<std::string> remarks;
    const std::size_t given = mesh.triangles.size();
    std::erase_if(mesh.triangles, [&](const Triangle& t) { return !(length(area_vector(mesh, t)) > 0.0); });
    if (mesh.triangles.size() < given) {
        remarks.push_back(fmt::format("{}: {} of {} triangles have no area and are left out", mesh.name,
                                      given - mesh.triangles.size(), given));
    }
    if (mesh.triangles.empty()) {
        throw InputError(fmt::format("{}: holds no triangle that has an area", mesh.name));
    }
    if (!has_usable_normals(mesh)) {
        mesh.normals.clear();
        remarks.push_back(
            fmt::format("{}: some normals are no directions; it is drawn flat, without any of them", mesh.name));
    }
    for (Vec3<float>& normal : mesh.normals) {
        normal = normalized(normal);
    }
    if (!mesh.normals.empty()) {
        if (const std::size_t turned = turn_to_normals(mesh); turned > 0) {
            remarks.push_back(fmt::format("{}: {} triangles stand against their vertices' normals and are turned round",
                                          mesh.name, turned));
        }
    }
    return remarks;
}

}  // namespace lensproof::scene
