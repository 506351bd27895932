// engine/scene/light/sun_light.h — a disc at infinity, evenly bright: the sun.
#pragma once
#include <cmath>
#include <numbers>
#include <string>

#include "engine/base/angle.h"
#include "engine/base/basis.h"
#include "engine/base/kinds.h"
#include "engine/base/toml_keys.h"
#include "engine/scene/light/light_maker.h"
#include "engine/scene/light/light_sample.h"
#include "engine/spectral/illuminant.h"

namespace lensproof::scene {

struct SunLight {
    Vec3d towards;  // unit length, to the disc's centre
    double cos_radius = 1.0;
    spectral::GridSpectrum radiance;

    [[nodiscard]] double irradiance() const { return mean_of(radiance) * cone(cos_radius); }
    [[nodiscard]] SkySample draw(const spectral::PathWavelengths& path, double u1, double u2) const {
        return {Basis(towards).to_world(in_cone(cos_radius, u1, u2)), radiance(path), 1.0 / cone(cos_radius)};
    }
    [[nodiscard]] SkySample seen(const Vec3d& direction, const spectral::PathWavelengths& path) const {
        // 1 − cos of the angle between unit vectors, from their difference: a narrow disc's edge does not cancel.
        const Vec3d apart = direction - towards;
        if (0.5 * dot(apart, apart) > 1.0 - cos_radius) {
            return {};
        }
        return {direction, radiance(path), 1.0 / cone(cos_radius)};
    }
};

struct SunLightDescription {
    static constexpr KindNames<> kNames{"sun"};
    Vec3d direction;  // of unit length, towards the sun
    double angular_diameter_deg = 0.53;
    std::string illuminant;
    double illuminance_lx = 0.0;  // on a plane that faces it
};

inline void read_keys(SunLightDescription& sun, TomlTable& table, const NameIndex& /*objects*/) {
    sun.direction = read_direction(table, "direction");
    sun.angular_diameter_deg = table.number_or("angular_diameter_deg", sun.angular_diameter_deg,
                                               {.min = 0.0, .max = 90.0, .min_excluded = true});
    sun.illuminant = read_illuminant(table, "illuminant");
    sun.illuminance_lx = table.number("illuminance_lx", kPower);
}

/// An even disc of angular radius r gives a plane that faces it the irradiance L π sin²r.
inline SunLight make_light(const SunLightDescription& sun, const LightMaker& maker) {
    const double radius = radians(0.5 * sun.angular_diameter_deg);
    const double per_projected = 1.0 / (std::numbers::pi * std::sin(radius) * std::sin(radius));
    const spectral::Spectrum irradiance =
        spectral::irradiance_of(spectral::illuminant(sun.illuminant), sun.illuminance_lx);
    return {.towards = sun.direction,
            .cos_radius = std::cos(radius),
            .radiance = maker.shining(per_projected * irradiance)};
}

}  // namespace lensproof::scene
