// engine/render/camera/lens_profile.h — what a round lens does to chief rays and to brightness, as curves over the
// film's radius.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/cache.h"
#include "engine/optics/lens.h"
#include "engine/render/camera/radial_curve.h"

namespace lensproof::render {

/// At one wavelength, over the film point's distance from the axis, mm, up to where the light ends: beyond, there is
/// none.
struct RadialProfile {
    RisingCurve field_angle;  // of the chief ray, rad: rising from 0, past 90° where the lens sees so far
    /// Of an even world, the film's irradiance over its radiance, sr: vignetting, cos⁴ and losses are in it.
    RadialCurve illumination;
    double transmittance = 1.0;  // of the light on the axis
};

/// All that the profile models know of a lens: distortion and lateral colour, brightness, and where the lens sees from.
/// Traced here; a measured one says the same.
struct LensProfile {
    std::vector<RadialProfile> at;  // a wavelength each
    /// Where chief rays cross the axis before the lens, z in lens space, over the field angle; of all wavelengths, so
    /// that their rays outside are the same. Beyond its end as there.
    RadialCurve pupil_z;
    double front_z = 0.0;  // of the first vertex

    [[nodiscard]] std::string serialized() const;
    static std::optional<LensProfile> deserialized(std::string_view bytes);
};

/// Of a lens, stopped down and focused, at these wavelengths, which lie evenly, for film points within `film_radius_mm`
/// of the axis. Chief rays are real ones (optics::ChiefRays), followed beyond rims as far as the film's radius and the
/// field grow; where the film is lit farther out than that, the profile ends (the outer 8 % of the Tessar's image
/// circle, of other lenses that ship less or nothing). The light is optics::image_bundle's, in the plane x = 0 where
/// the stop has blades: the integral that an exact camera's paths estimate.
///
/// Against both, traced between the nodes, image heights differ by less than 1e-7 mm and the light by 6e-4 of the
/// axis's; of fisheyes by 3e-3, where a rim sets in abruptly, and by 3e-2 in the last 0.5 % of the radius
/// (`LensProfile.IsTheLensBetweenItsNodes` in tests/validation says it lens by lens).
///
/// Throws InputError for lenses that are not rotationally symmetric, with mirrors, with an entrance pupil at infinity,
/// or without light on the axis.
LensProfile traced_profile(const optics::Lens& lens, const std::vector<double>& wavelengths_nm, double film_radius_mm);

/// The same from the cache, by all that it follows from; to the last bit what tracing gives.
LensProfile kept_profile(const Cache& cache, const optics::Lens& lens, const std::vector<double>& wavelengths_nm,
                         double film_radius_mm);

}  // namespace lensproof::render
