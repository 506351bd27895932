// engine/scene/light/light_sample.h — what paths learn of a light, and what kinds of lights are sampled with.
//
// World frame, mm. Radiance in W·m⁻²·sr⁻¹·nm⁻¹, intensity in W·sr⁻¹·nm⁻¹, irradiance in W·m⁻²·nm⁻¹; so intensity over a
// squared distance in mm is taken in m. A pdf is per solid angle where it does not say otherwise.
#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <variant>

#include "engine/base/ray.h"
#include "engine/scene/light/packet/facet_view.h"
#include "engine/scene/spectra/texture.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::scene {

class Environment;
class ShiningSurface;

/// A place of a map that is not yet looked up: it lies beyond the caches, and once it may count, memory is asked for it
/// (`fetch`), so that it is there when a path knows whether it sees the place.
struct MapPlace {
    const Environment* map = nullptr;  // none: there is nothing to look up
    Vec2d at;                          // of the picture's unit square, from its top left corner
    double pdf = 0.0;                  // with which the map is drawn there
};

/// A direction that was drawn of a map.
struct MapDraw {
    Vec3d direction;
    MapPlace place;
};

/// A point of a shining surface that was drawn, as a point sees it.
struct SurfaceDraw {
    const ShiningSurface* surface = nullptr;
    ShiningView<double> view;
};

/// What draws a light and a point of it: three numbers in [0, 1), and what they draw where that is known
/// (`Lights::draw_ahead`).
struct LightNumbers {
    double of_light = 0.0;
    Vec2d of_point;
    std::variant<std::monostate, MapDraw, SurfaceDraw> ahead{};
};

/// Light that reaches a point: what next-event estimation adds, if nothing stands in the way.
struct LightSample {
    Vec3d direction;                 // from the point to the light, unit length
    Vec3d end;                       // the path is free if nothing stands between the point and this
    spectral::SpectralSample value;  // radiance over pdf, or irradiance on a surface that faces a delta light; but for
    MapPlace place{};                // what a map's light has there, a factor (`light_of`)
    double pdf = 0.0;                // per solid angle at the point, with the light drawn by power; 0 for a delta
    /// The pdf per etendue with which a light path would leave along this path, over that of this sample, 1/mm².
    double leaving_per_sample = 0.0;
};

/// Where a light path begins: a point of a source or, for one at infinity, a direction that its light comes along.
struct LightStart {
    std::uint32_t light = 0;
    bool is_at_infinity = false;
    bool is_sun = false;
    Vec3d point;
    Vec3d direction;        // of light from infinity, unit length
    Vec3d normal;           // of a surface, on the side that shines here; else zeros
    double error_mm = 0.0;  // for `ray_origin`
    /// Over the pdf of having drawn the start. Of a surface radiance · m², of a point intensity, W·sr⁻¹·nm⁻¹; of
    /// light from infinity radiance · sr, the irradiance across it.
    spectral::SpectralSample value;
    /// With which it was drawn, choice of the light included: per mm² of a surface, per solid angle of directions from
    /// infinity; 0 of a point.
    double pdf = 0.0;

    /// Of a point light or a spot, which has an intensity and no radiance.
    [[nodiscard]] bool is_point() const { return pdf == 0.0; }
};

/// A light path from its start to the first surface point, and how likely each technique is to take it.
struct FirstSegment {
    double hit_per_leaving = 0.0;     // mm² sr: 1 over the pdf per etendue with which light paths leave along it; 0
                                      // of a point, which no path runs into
    double sample_per_leaving = 0.0;  // mm²: the pdf with which the surface point samples it, over the same
};

/// A ray of light as it leaves a source.
struct EmittedRay {
    Ray<double> ray;
    spectral::SpectralSample power;  // W·nm⁻¹: what the source sends out, over the pdf of having drawn this ray of it
};

/// A direction towards a light at infinity, what comes from there, and the pdf with which the light draws it.
struct SkySample {
    Vec3d direction;  // unit length
    spectral::SpectralSample radiance;
    double pdf = 0.0;
    MapPlace place{};  // whose light `radiance` lacks, as a factor
};

inline constexpr double kSquareMetresPerSquareMm = 1e-6;

/// Over the grid.
inline double mean_of(const spectral::GridSpectrum& spectrum) {
    return std::accumulate(spectrum.value.begin(), spectrum.value.end(), 0.0) /
           static_cast<double>(spectrum.value.size());
}

inline spectral::SpectralSample scaled(const spectral::SpectralSample& sample, double scale) {
    return static_cast<float>(scale) * sample;
}

/// Solid angle of a cone about an axis.
inline double cone(double cos_half_angle) {
    return 2.0 * std::numbers::pi * (1.0 - cos_half_angle);
}

/// A direction of a cone about z, evenly.
inline Vec3d in_cone(double cos_half_angle, double u1, double u2) {
    const double down = u1 * (1.0 - cos_half_angle);  // 1 − z, which does not cancel in a narrow cone
    const double across = std::sqrt(down * (2.0 - down));
    const double angle = 2.0 * std::numbers::pi * u2;
    return {across * std::cos(angle), across * std::sin(angle), 1.0 - down};
}

}  // namespace lensproof::scene
