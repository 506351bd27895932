#include <fmt/format.h>

#include <cmath>

#include "engine/scene/chart/chart_file.h"
#include "engine/scene/scene_file_parts.h"

namespace lensproof::scene {

namespace {

constexpr Bounds kSize{.min = 0.0, .max = 1e12, .min_excluded = true};
constexpr Bounds kAngle{.min = -3600.0, .max = 3600.0};
constexpr Bounds kCoordinate{.min = -1e12, .max = 1e12};
constexpr Bounds kFactor{.min = -1e9, .max = 1e9};
constexpr Bounds kPositiveFactor{.min = 0.0, .max = 1e15, .min_excluded = true};

AffineMap read_matrix(TomlTable& table) {
    const std::vector<std::vector<double>> rows = table.number_lists("matrix");
    AffineMap map;
    double* const translation[] = {&map.translation.x, &map.translation.y, &map.translation.z};
    if (rows.size() != 3) {
        table.fail("matrix", fmt::format("has {} rows, expected 3 of 4 numbers", rows.size()));
    }
    for (std::size_t i = 0; i < 3; ++i) {
        if (rows[i].size() != 4) {
            table.fail("matrix", fmt::format("row {} has {} numbers, expected 4", i + 1, rows[i].size()));
        }
        map.linear[i] = {rows[i][0], rows[i][1], rows[i][2]};
        *translation[i] = rows[i][3];
    }
    return map;
}

AffineMap read_steps(TomlTable& table) {
    AffineMap map;
    if (table.is_number("scale")) {
        const double factor = table.number("scale", kFactor);
        map.linear = {Vec3d{factor, 0, 0}, Vec3d{0, factor, 0}, Vec3d{0, 0, factor}};
    } else if (table.has("scale")) {
        const std::vector<double> factors = table.numbers("scale", 3, kFactor);
        map.linear = {Vec3d{factors[0], 0, 0}, Vec3d{0, factors[1], 0}, Vec3d{0, 0, factors[2]}};
    }
    if (table.has("rotate_deg")) {
        const std::vector<double> turn = table.numbers("rotate_deg", 3, kAngle);
        map.linear = product(about_z(turn[2]), product(about_y(turn[1]), product(about_x(turn[0]), map.linear)));
    }
    if (table.has("translate_mm")) {
        map.translation = read_vector(table, "translate_mm");
    }
    return map;
}

MeshFromFile read_mesh_shape(TomlTable& table) {
    MeshFromFile mesh{.file = read_file_name(table, "file")};
    mesh.options.by_material = is_gltf(mesh.file) && !table.has("material");
    if (mesh.options.by_material) {
        mesh.cd_m2_per_unit = table.number_or("cd_m2_per_unit", mesh.cd_m2_per_unit, kPositiveFactor);
    } else if (table.has("cd_m2_per_unit")) {
        table.fail("cd_m2_per_unit",
                   "is for a glTF file's own materials, expected a .gltf or .glb file and no material");
    }
    mesh.options.mm_per_unit = table.optional_number("mm_per_unit", kSize);
    mesh.options.part = table.text_or("part", "");
    if (table.has("normals")) {
        const std::string normals = table.choice("normals", {"file", "flat", "smooth"});
        mesh.options.normals = normals == "file"   ? MeshNormals::file
                               : normals == "flat" ? MeshNormals::flat
                                                   : MeshNormals::smooth;
    }
    if (mesh.options.normals == MeshNormals::smooth) {
        mesh.options.crease_deg = table.number_or("crease_deg", mesh.options.crease_deg, {.min = 0.0, .max = 180.0});
    }
    return mesh;
}

ChartOnQuad read_chart_shape(TomlTable& table) {
    TomlTable inner = table.table("chart");
    ChartOnQuad on{.chart = read_chart(inner)};
    if (table.has("size_mm")) {
        const std::vector<double> size = table.numbers("size_mm", 2, kSize);
        on.quad = {size[0], size[1]};
        return on;
    }
    const double margin_mm = table.number_or("margin_mm", 0.0, {.min = 0.0, .max = 1e9});
    const Vec2d pattern = pattern_size_mm(on.chart);
    if (!(pattern.x > 0.0 && pattern.y > 0.0)) {
        table.fail("chart", "has no size of its own, expected size_mm = [width, height] beside it");
    }
    on.quad = {pattern.x + 2.0 * margin_mm, pattern.y + 2.0 * margin_mm};
    return on;
}

/// A fan of triangles about the first vertex.
TriangleMesh read_polygon(TomlTable& table) {
    const std::vector<std::vector<double>> vertices = table.number_lists("vertices_mm");
    if (vertices.size() < 3) {
        table.fail("vertices_mm", fmt::format("has {} vertices, expected at least 3", vertices.size()));
    }
    TriangleMesh mesh{.name = table.where()};
    for (const std::vector<double>& vertex : vertices) {
        if (vertex.size() != 3 || !kCoordinate.hold(vertex[0]) || !kCoordinate.hold(vertex[1]) ||
            !kCoordinate.hold(vertex[2])) {
            table.fail("vertices_mm", fmt::format("its vertex {} is not three numbers within {} mm",
                                                  mesh.positions.size() + 1, kCoordinate.max));
        }
        mesh.positions.push_back(converted<float>(Vec3d{vertex[0], vertex[1], vertex[2]}));
    }
    for (std::uint32_t i = 2; i < mesh.positions.size(); ++i) {
        mesh.triangles.push_back({0, i - 1, i});
    }
    return mesh;
}

ShapeDescription read_shape(TomlTable& table) {
    const std::string shape = table.choice("shape", {"mesh", "sphere", "quad", "polygon", "chart"});
    if (shape == "mesh") {
        return read_mesh_shape(table);
    }
    if (shape == "sphere") {
        return Sphere{table.number("radius_mm", kSize)};
    }
    if (shape == "quad") {
        const std::vector<double> size = table.numbers("size_mm", 2, kSize);
        return Quad{size[0], size[1]};
    }
    if (shape == "polygon") {
        return read_polygon(table);
    }
    return read_chart_shape(table);
}

InstanceOf read_instance(TomlTable& table, const NameIndex& names, const std::vector<ObjectDescription>& objects) {
    if (table.has("shape")) {
        table.fail("shape", "stands beside instance_of, which says the shape");
    }
    const std::size_t of = names.find(table, "instance_of");
    if (std::holds_alternative<InstanceOf>(objects[of].shape)) {
        table.fail("instance_of", "is an instance itself, expected the object that it is one of");
    }
    return {of};
}

}  // namespace

AffineMap read_transform(TomlTable& table) {
    const bool is_matrix = table.has("matrix");
    if (is_matrix && (table.has("translate_mm") || table.has("rotate_deg") || table.has("scale"))) {
        table.fail("matrix", "stands beside translate_mm, rotate_deg or scale, expected it alone");
    }
    const AffineMap map = is_matrix ? read_matrix(table) : read_steps(table);
    if (!inverse(map)) {
        table.fail(is_matrix ? "matrix" : "scale", "flattens the object, expected a transform that can be undone");
    }
    return map;
}

std::vector<ObjectDescription> read_objects(TomlTable& top, const NameIndex& materials, NameIndex& names) {
    std::vector<ObjectDescription> objects;
    for (TomlTable& table : top.tables("objects")) {
        ObjectDescription object{.where = table.where()};
        if (table.has("instance_of")) {
            object.shape = read_instance(table, names, objects);
        } else {
            object.shape = read_shape(table);
        }
        object.name = names.add(table, "name", objects.size(), true);
        object.to_world = read_transform(table);
        const auto* instance = std::get_if<InstanceOf>(&object.shape);
        const ShapeDescription& shape = instance != nullptr ? objects[instance->object].shape : object.shape;
        if (table.has("material")) {
            object.material = materials.find(table, "material");
        } else if (instance != nullptr) {
            object.material = objects[instance->object].material;
        } else if (const auto* mesh = std::get_if<MeshFromFile>(&shape);
                   !std::holds_alternative<ChartOnQuad>(shape) && (mesh == nullptr || !mesh->options.by_material)) {
            table.text("material");  // is missing
        }
        table.finish();
        objects.push_back(std::move(object));
    }
    return objects;
}

}  // namespace lensproof::scene
