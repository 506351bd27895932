// engine/optics/illumination.h — how much light of an even scene reaches a point of the sensor, by quadrature.
#pragma once
#include "engine/optics/lens.h"

namespace lensproof {

/// The bundle that reaches a sensor point through every rim.
struct Bundle {
    double projected_solid_angle =
        0.0;                   // ∫ dL dM over direction cosines, sr: irradiance = radiance × this without losses
    double transmitted = 0.0;  // the same weighted with the Fresnel transmittance: what an even scene's light yields
};

/// The bundle at `image_height` (mm from the axis). Rays are followed backwards from the sensor; the bundle's outline
/// in direction cosines is found by bisection along `azimuths` directions from a passing ray, so no rim, pupil or cos⁴
/// law is assumed; the bundle is taken to be star-shaped about that ray. Zero where no light arrives.
Bundle image_bundle(const TraceLens<double>& lens, double image_height, int azimuths = 256);

}  // namespace lensproof
