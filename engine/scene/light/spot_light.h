// engine/scene/light/spot_light.h — a cone of light from a point.
#pragma once
#include <cmath>
#include <string>

#include "engine/base/affine.h"
#include "engine/base/angle.h"
#include "engine/base/basis.h"
#include "engine/base/kinds.h"
#include "engine/base/toml_keys.h"
#include "engine/scene/light/light_maker.h"
#include "engine/scene/light/light_sample.h"

namespace lensproof::scene {

/// Full within `cos_inner` of its axis, none beyond `cos_outer`, a smoothstep of the cosine between.
struct SpotLight {
    Vec3d position;
    Vec3d axis;  // unit length, that of the light
    double cos_inner = 1.0;
    double cos_outer = 0.0;
    spectral::GridSpectrum intensity;  // on the axis

    /// A smoothstep's mean is 1/2.
    [[nodiscard]] double power() const { return 0.5 * (cone(cos_inner) + cone(cos_outer)) * mean_of(intensity); }
    [[nodiscard]] double cone_sr() const { return cone(cos_outer); }
    [[nodiscard]] Vec3d draw(double u1, double u2) const { return Basis(axis).to_world(in_cone(cos_outer, u1, u2)); }
    [[nodiscard]] double falloff(const Vec3d& direction) const {
        const double cosine = dot(direction, axis);
        if (cosine >= cos_inner) {
            return 1.0;
        }
        if (cosine <= cos_outer) {
            return 0.0;
        }
        const double t = (cosine - cos_outer) / (cos_inner - cos_outer);
        return t * t * (3.0 - 2.0 * t);
    }
};

/// Full intensity within `full_deg` of the direction, none beyond `cone_deg`, smooth between.
struct SpotLightDescription {
    static constexpr KindNames<> kNames{"spot"};
    Vec3d position_mm;
    Vec3d direction;  // of unit length, that of the light
    double cone_deg = 0.0;
    double full_deg = 0.0;
    std::string illuminant;
    double intensity_cd = 0.0;
};

inline void read_keys(SpotLightDescription& spot, TomlTable& table, const NameIndex& /*objects*/) {
    spot.position_mm = read_vector(table, "position_mm");
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
}

inline SpotLight make_light(const SpotLightDescription& spot, const LightMaker& maker) {
    return {.position = spot.position_mm,
            .axis = spot.direction,
            .cos_inner = std::cos(radians(spot.full_deg)),
            .cos_outer = std::cos(radians(spot.cone_deg)),
            .intensity = maker.intensity(spot.illuminant, spot.intensity_cd)};
}

}  // namespace lensproof::scene
