#include <fmt/format.h>

#include "engine/base/input_error.h"
#include "engine/scene/illuminant_key.h"
#include "engine/scene/scene_file_parts.h"

namespace lensproof::scene {

namespace {

constexpr Bounds kLength{.min = 0.0, .max = 1e12, .min_excluded = true};
/// A light without power is an error: whoever wants none leaves it out.
constexpr Bounds kPower{.min = 0.0, .max = 1e15, .min_excluded = true};

EmissionDescription read_emission(TomlTable& table) {
    if (!table.has("radiance")) {
        return {.illuminant = read_illuminant(table, "illuminant"),
                .luminance_cd_m2 = table.number("luminance_cd_m2", kPower)};
    }
    if (table.has("illuminant")) {
        table.fail("radiance", "stands beside illuminant, expected one or the other");
    }
    const SpectrumDescription spectrum = read_spectrum(table, "radiance", kPower, "radiance");
    const auto* file = std::get_if<SpectrumTable>(&spectrum);
    if (file == nullptr) {
        table.fail("radiance", "expected a CSV table of W·m⁻²·sr⁻¹·nm⁻¹ over wavelength_nm");
    }
    return {.illuminant = "",
            .luminance_cd_m2 = table.has("luminance_cd_m2") ? table.number("luminance_cd_m2", kPower) : 0.0,
            .radiance = *file};
}

SpotLightDescription read_spot(TomlTable& table) {
    SpotLightDescription spot{.position_mm = read_vector(table, "position_mm")};
    if (table.has("look_at_mm")) {
        const Vec3d along = read_vector(table, "look_at_mm") - spot.position_mm;
        if (!(largest_coordinate(along) > 0.0)) {
            table.fail("look_at_mm", "is where the light stands, expected another place");
        }
        spot.direction = normalized(along);
    } else {
        spot.direction = read_direction(table, "direction");
    }
    spot.cone_deg = table.number("cone_deg", {.min = 0.0, .max = 90.0, .min_excluded = true});
    spot.full_deg = table.number_or("full_deg", spot.cone_deg, {.min = 0.0, .max = spot.cone_deg});
    spot.illuminant = read_illuminant(table, "illuminant");
    spot.intensity_cd = table.number("intensity_cd", kPower);
    return spot;
}

SunLightDescription read_sun(TomlTable& table) {
    SunLightDescription sun{.direction = read_direction(table, "direction")};
    sun.angular_diameter_deg = table.number_or("angular_diameter_deg", sun.angular_diameter_deg,
                                               {.min = 0.0, .max = 90.0, .min_excluded = true});
    sun.illuminant = read_illuminant(table, "illuminant");
    sun.illuminance_lx = table.number("illuminance_lx", kPower);
    return sun;
}

EnvironmentLightDescription read_environment(TomlTable& table) {
    EnvironmentLightDescription sky;
    if (table.has("image")) {
        sky.image = read_file_name(table, "image");
        sky.rotate_deg = table.number_or("rotate_deg", 0.0, {.min = -360.0, .max = 360.0});
        sky.up = table.has("up") ? read_direction(table, "up") : sky.up;
    }
    sky.emission = read_emission(table);
    return sky;
}

AreaLightDescription read_area(TomlTable& table, const NameIndex& objects) {
    AreaLightDescription light{.object = objects.find(table, "object"), .emission = read_emission(table)};
    light.is_two_sided = table.boolean_or("two_sided", false);
    return light;
}

LightKind read_light_kind(TomlTable& table, const NameIndex& objects) {
    const std::string kind = table.choice("kind", {"area", "sphere", "point", "spot", "sun", "environment"});
    if (kind == "area") {
        return read_area(table, objects);
    }
    if (kind == "sphere") {
        return SphereLightDescription{.position_mm = read_vector(table, "position_mm"),
                                      .radius_mm = table.number("radius_mm", kLength),
                                      .emission = read_emission(table)};
    }
    if (kind == "point") {
        return PointLightDescription{.position_mm = read_vector(table, "position_mm"),
                                     .illuminant = read_illuminant(table, "illuminant"),
                                     .intensity_cd = table.number("intensity_cd", kPower)};
    }
    if (kind == "spot") {
        return read_spot(table);
    }
    if (kind == "sun") {
        return read_sun(table);
    }
    return read_environment(table);
}

}  // namespace

std::vector<LightDescription> read_lights(TomlTable& top, const NameIndex& objects) {
    std::vector<LightDescription> lights;
    bool has_environment = false;
    for (TomlTable& table : top.tables("lights")) {
        LightDescription light{.kind = read_light_kind(table, objects), .where = table.where()};
        table.finish();
        if (const auto* area = std::get_if<AreaLightDescription>(&light.kind)) {
            for (const LightDescription& other : lights) {
                const auto* same = std::get_if<AreaLightDescription>(&other.kind);
                if (same != nullptr && same->object == area->object) {
                    table.fail("object", "shines already, by " + other.where);
                }
            }
        }
        if (std::holds_alternative<EnvironmentLightDescription>(light.kind)) {
            if (has_environment) {
                table.fail("kind", "is a second environment, expected one at most");
            }
            has_environment = true;
        }
        lights.push_back(std::move(light));
    }
    return lights;
}

}  // namespace lensproof::scene
