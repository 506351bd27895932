// tests/experiments/studies/tradeoff/wall_scene.h — a scene for plans.
#pragma once
#include <fmt/format.h>

#include <string>

#include "engine/render/scene_setup.h"

namespace lensproof::studies {

/// A lens before a chequered wall in the plane of focus, under a lamp.
inline render::SceneSetup wall(const std::string& lens, double f_number, double half_field_mm, double luminance = 1e5) {
    const std::string text = fmt::format(R"([camera]
lens = "{}"
f_number = {}
focus_distance_mm = 3000.0
position_mm = [0.0, 0.0, 0.0]
look_at_mm = [0.0, 0.0, 3000.0]
sensor_mm = [{}, {}]
pixels = [150, 100]
shutter_s = 0.01
iso = 100.0
response = "cie-1931"
[render]
layers = 16
strata_per_layer = 1
max_bounces = 3
[[materials]]
name = "grey"
kind = "diffuse"
reflectance = 0.3
[[objects]]
name = "wall"
shape = "chart"
chart = {{ kind = "checkerboard", squares = [48, 32], square_mm = 100.0 }}
rotate_deg = [0.0, 180.0, 0.0]
translate_mm = [0.0, 0.0, 3000.0]
[[lights]]
kind = "sphere"
position_mm = [0.0, 1500.0, 1000.0]
radius_mm = 300.0
luminance_cd_m2 = {}
)",
                                         lens, f_number, 3.0 * half_field_mm, 2.0 * half_field_mm, luminance);
    return render::parse_scene_setup(text, "wall.toml");
}

}  // namespace lensproof::studies
