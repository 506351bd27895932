// engine/scene/light/sphere_light.h — a ball that shines: a lamp that shows.
#pragma once
#include "engine/scene/light/area_light.h"

namespace lensproof::scene {

struct SphereLightDescription {
    static constexpr KindNames<> kNames{"sphere"};
    Vec3d position_mm;
    double radius_mm = 0.0;
    EmissionDescription emission;
};

inline void read_keys(SphereLightDescription& light, TomlTable& table, const NameIndex& /*objects*/) {
    light.position_mm = read_vector(table, "position_mm");
    light.radius_mm = table.number("radius_mm", {.min = 0.0, .max = 1e12, .min_excluded = true});
    light.emission = read_emission(table);
}

/// The area light of a black ball.
inline AreaLight make_light(const SphereLightDescription& light, const LightMaker& maker) {
    return {.object = maker.add_black_ball(light.position_mm, light.radius_mm),
            .radiance = maker.radiance(light.emission)};
}

}  // namespace lensproof::scene
