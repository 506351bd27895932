// engine/scene/light/environment_light.h — light from every direction at infinity.
#pragma once
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <variant>

#include "engine/base/kinds.h"
#include "engine/base/toml_keys.h"
#include "engine/scene/light/environment.h"
#include "engine/scene/light/light_maker.h"
#include "engine/scene/light/light_sample.h"

namespace lensproof::scene {

/// The same radiance from every direction.
struct ConstantLight {
    spectral::GridSpectrum radiance;

    [[nodiscard]] double irradiance() const { return mean_of(radiance) * 4.0 * std::numbers::pi; }
    [[nodiscard]] SkySample draw(const spectral::PathWavelengths& path, double u1, double u2) const {
        return seen(in_cone(-1.0, u1, u2), path);
    }
    [[nodiscard]] SkySample seen(const Vec3d& direction, const spectral::PathWavelengths& path) const {
        return {direction, radiance(path), 1.0 / (4.0 * std::numbers::pi)};
    }
};

/// A picture of all directions at infinity.
struct EnvironmentLight {
    std::shared_ptr<const Environment> map;

    [[nodiscard]] double irradiance() const { return map->mean_power(); }
    [[nodiscard]] SkySample draw(const spectral::PathWavelengths& /*path*/, double u1, double u2,
                                 const MapDraw& ahead = {}) const {
        const MapDraw drawn = ahead.place.map == map.get() ? ahead : map->draw({u1, u2});
        return {drawn.direction, spectral::SpectralSample(1.0F), drawn.place.pdf, drawn.place};
    }
    [[nodiscard]] SkySample seen(const Vec3d& direction, const spectral::PathWavelengths& path,
                                 const MapPlace& ahead = {}) const {
        const MapPlace place = ahead.map == map.get() ? ahead : map->find(direction);
        return {direction, map->radiance_at(place, path), place.pdf};
    }
};

/// Asks memory for what `light_of` will read.
inline void fetch(const MapPlace& place) {
    if (place.map != nullptr) {
        place.map->fetch(place);
    }
}

/// `value`, and as a factor what a map has at `place`.
inline spectral::SpectralSample light_of(const spectral::SpectralSample& value, const MapPlace& place,
                                         const spectral::PathWavelengths& path) {
    return place.map != nullptr ? value * place.map->radiance_at(place, path) : value;
}

/// Light from every direction: the same, or as a picture in equirectangular projection, whose white (1, 1, 1) has the
/// luminance and the illuminant. The picture's middle row is the horizon, its middle column the direction +x turned
/// about +z by `rotate_deg`; columns to the left of it lie towards +y. `up` is the direction that the top row shows.
struct EnvironmentLightDescription {
    static constexpr KindNames<> kNames{"environment"};
    std::optional<std::filesystem::path> image;
    EmissionDescription emission;
    double rotate_deg = 0.0;
    Vec3d up{0, 0, 1};
};

inline void read_keys(EnvironmentLightDescription& sky, TomlTable& table, const NameIndex& /*objects*/) {
    if (table.has("image")) {
        sky.image = read_file_name(table, "image");
        sky.rotate_deg = table.number_or("rotate_deg", 0.0, {.min = -360.0, .max = 360.0});
        sky.up = table.has("up") ? read_direction(table, "up") : sky.up;
    }
    sky.emission = read_emission(table);
}

inline void check_beside(const EnvironmentLightDescription&, const EnvironmentLightDescription&, const std::string&,
                         const TomlTable& table) {
    table.fail("kind", "is a second environment, expected one at most");
}

inline std::variant<ConstantLight, EnvironmentLight> make_light(const EnvironmentLightDescription& light,
                                                                const LightMaker& maker) {
    spectral::GridSpectrum even = maker.radiance(light.emission);
    if (!light.image) {
        return ConstantLight{std::move(even)};
    }
    const formats::Image image = formats::read_image(*light.image);
    return EnvironmentLight{std::make_shared<const Environment>(
        emission_texture(image, *light.image, {image.width, image.height, Wrap::repeat, Wrap::clamp}, kAsItIs,
                         SceneSpectra::radiance_spectrum(light.emission), maker.spectra.grid(), maker.spectra.uplift()),
        light.up, light.rotate_deg)};
}

}  // namespace lensproof::scene
