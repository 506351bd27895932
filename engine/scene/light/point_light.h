// engine/scene/light/point_light.h — light from a point, the same in every direction.
#pragma once
#include <numbers>
#include <string>

#include "engine/base/kinds.h"
#include "engine/base/toml_keys.h"
#include "engine/scene/light/light_maker.h"
#include "engine/scene/light/light_sample.h"

namespace lensproof::scene {

struct PointLight {
    Vec3d position;
    spectral::GridSpectrum intensity;

    [[nodiscard]] double power() const { return 4.0 * std::numbers::pi * mean_of(intensity); }
    [[nodiscard]] double cone_sr() const { return cone(-1.0); }
    [[nodiscard]] Vec3d draw(double u1, double u2) const { return in_cone(-1.0, u1, u2); }
    [[nodiscard]] double falloff(const Vec3d& /*direction*/) const { return 1.0; }
};

struct PointLightDescription {
    static constexpr KindNames<> kNames{"point"};
    Vec3d position_mm;
    std::string illuminant;
    double intensity_cd = 0.0;
};

inline void read_keys(PointLightDescription& light, TomlTable& table, const NameIndex& /*objects*/) {
    light.position_mm = read_vector(table, "position_mm");
    light.illuminant = read_illuminant(table, "illuminant");
    light.intensity_cd = table.number("intensity_cd", kPower);
}

inline PointLight make_light(const PointLightDescription& light, const LightMaker& maker) {
    return {light.position_mm, maker.intensity(light.illuminant, light.intensity_cd)};
}

}  // namespace lensproof::scene
