// engine/scene/bsdf/bsdf_sample.h — a direction drawn from a surface's scattering, and what it carries.
#pragma once
#include "engine/base/disc.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::scene {

/// What flows along a path that scatters from `wi` to `wo`. Refraction squeezes beams, and radiance with them, by the
/// square of the indices' ratio; importance, which flows in the other direction, it leaves (E. Veach, PhD thesis,
/// Stanford 1997, §5.2). A path from the camera asks for `radiance`, its `wo` pointing towards the camera; a path from
/// a light asks for `importance`, its `wo` pointing towards the light.
enum class Transport { radiance, importance };

/// What draws a direction: three independent numbers, uniform in (0, 1), and the direction that the last two draw of a
/// matt surface, which those who draw many find together.
struct BsdfNumbers {
    double lobe = 0.0;
    double u1 = 0.0;
    double u2 = 0.0;
    Vec3d matt;
};
inline BsdfNumbers bsdf_numbers(double lobe, double u1, double u2) {
    return {lobe, u1, u2, cosine_direction(u1, u2)};
}

/// A direction drawn from a surface's scattering.
struct BsdfSample {
    Vec3d wi;
    spectral::SpectralSample weight;  // f |cos wi| / pdf; of a delta, reflectance or transmittance over its probability
    double pdf = 0.0;                 // per solid angle; 0 for a delta
    bool is_delta = false;            // a mirror's or a lens's one direction, which no other sampling finds
    bool is_dispersed = false;  // the direction is the hero's alone: weight[1] to [3] are 0, and weight[0] is as it
                                // would be without them; whoever goes on gives the hero the others' part
};

}  // namespace lensproof::scene
