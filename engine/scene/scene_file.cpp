#include "engine/scene/scene_file.h"

#include <fmt/format.h>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/nearest_name.h"
#include "engine/base/text.h"
#include "engine/scene/scene_file_parts.h"

namespace lensproof::scene {

namespace {

constexpr Bounds kCoordinate{.min = -1e12, .max = 1e12};

std::filesystem::path beside(const TomlTable& table, const std::string& key, const std::string& name) {
    std::filesystem::path file = table.file().parent_path() / name;
    try {
        check_readable(file);
    } catch (const InputError& error) {
        table.fail(key, fmt::format("is \"{}\": {}", printable(name), error.what()));
    }
    return file;
}

RgbColour read_rgb(TomlTable& table, const std::string& key, const Bounds& bounds) {
    const std::vector<double> rgb = table.numbers(key, 3, bounds);
    return {{rgb[0], rgb[1], rgb[2]}};
}

ImageDescription read_image_texture(TomlTable& table) {
    ImageDescription texture{.file = read_file_name(table, "image")};
    texture.scale = table.number_or("scale", texture.scale, kPositive);
    if (table.has("repeats")) {
        const std::vector<double> repeats = table.numbers("repeats", 2, kPositive);
        texture.repeats = {repeats[0], repeats[1]};
    }
    table.finish();
    return texture;
}

}  // namespace

std::string NameIndex::add(TomlTable& table, const std::string& key, std::size_t index, bool may_be_empty) {
    std::string name = may_be_empty ? table.text_or(key, "") : table.text(key);
    if (name.empty()) {
        if (!may_be_empty || table.has(key)) {
            table.fail(key, "is empty, expected a name");
        }
        return name;
    }
    if (!index_.try_emplace(name, index).second) {
        table.fail(key, fmt::format("\"{}\" names another {} already", printable(name), what_));
    }
    return name;
}

std::size_t NameIndex::find(TomlTable& table, const std::string& key) const {
    return find(table, key, table.text(key));
}

std::size_t NameIndex::find(const TomlTable& table, const std::string& key, const std::string& name) const {
    const auto found = index_.find(name);
    if (found == index_.end()) {
        std::vector<std::string> known;
        for (const auto& entry : index_) {
            known.push_back(entry.first);
        }
        table.fail(key, fmt::format("is \"{}\", which names no {}{}", printable(name), what_,
                                    known.empty() ? ": there is none" : " here" + name_hint(name, known)));
    }
    return found->second;
}

Vec3d read_vector(TomlTable& table, const std::string& key) {
    const std::vector<double> v = table.numbers(key, 3, kCoordinate);
    return {v[0], v[1], v[2]};
}

Vec3d read_direction(TomlTable& table, const std::string& key) {
    const Vec3d v = read_vector(table, key);
    if (!(largest_coordinate(v) > 1e-12)) {
        table.fail(key, "has no length, expected a direction");
    }
    return normalized(v);
}

std::filesystem::path read_file_name(TomlTable& table, const std::string& key) {
    return beside(table, key, table.text(key));
}

SpectrumDescription read_spectrum(TomlTable& table, const std::string& key, const Bounds& bounds,
                                  const std::string& column) {
    if (table.is_number(key)) {
        return table.number(key, bounds);
    }
    if (table.is_table(key)) {
        TomlTable inner = table.table(key);
        SpectrumTable spectrum{.file = read_file_name(inner, "file"), .column = inner.text_or("column", column)};
        inner.finish();
        return spectrum;
    }
    if (!table.is_text(key)) {
        return read_rgb(table, key, bounds);
    }
    const std::string name = table.text(key);
    if (name.ends_with(".csv")) {
        return SpectrumTable{.file = beside(table, key, name), .column = column};
    }
    if (name.empty()) {
        table.fail(key, "is empty, expected a spectrum's name");
    }
    return SpectrumName{name};
}

TextureDescription read_texture(TomlTable& table, const std::string& key, const Bounds& bounds,
                                const std::string& column) {
    if (table.is_table(key)) {
        TomlTable inner = table.table(key);
        if (inner.has("image")) {
            return read_image_texture(inner);
        }
    }
    return std::visit([](const auto& spectrum) { return TextureDescription(spectrum); },
                      read_spectrum(table, key, bounds, column));
}

SceneDescription read_scene(TomlTable& top) {
    NameIndex materials("material");
    NameIndex objects("object");
    SceneDescription scene;
    scene.materials = read_materials(top, materials);
    scene.objects = read_objects(top, materials, objects);
    scene.lights = read_lights(top, objects);
    return scene;
}

CameraView read_camera_view(TomlTable& camera) {
    CameraView view;
    view.position_mm = read_vector(camera, "position_mm");
    view.look_at_mm = read_vector(camera, "look_at_mm");
    view.up = camera.has("up") ? read_direction(camera, "up") : view.up;
    const Vec3d forwards = view.look_at_mm - view.position_mm;
    if (!(length(forwards) > 1e-9)) {
        camera.fail("look_at_mm", "is where the camera stands, expected another place");
    }
    constexpr double kSmallestSine = 1e-6;
    if (length(cross(normalized(forwards), view.up)) < kSmallestSine) {
        camera.fail(camera.has("up") ? "up" : "look_at_mm", "the camera looks along up, expected another direction");
    }
    if (camera.has("model")) {
        view.model = lens_model_named(camera.choice("model", lens_model_names()));
    }
    view.focal_length_mm = camera.optional_number("focal_length_mm", kPositive);
    if (view.focal_length_mm && (view.model == LensModel::exact || view.model == LensModel::paraxial)) {
        camera.fail("focal_length_mm", "is for the models thin-lens and pinhole; here the lens says it");
    }
    return view;
}

RigidMotion camera_to_world(const CameraView& view) {
    const Vec3d z = normalized(view.look_at_mm - view.position_mm);
    const Vec3d x = normalized(cross(z, view.up));
    const Vec3d y = cross(z, x);
    return {.rotation_rows = {Vec3d{x.x, y.x, z.x}, Vec3d{x.y, y.y, z.y}, Vec3d{x.z, y.z, z.z}},
            .translation = view.position_mm};
}

}  // namespace lensproof::scene
