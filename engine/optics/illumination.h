// engine/optics/illumination.h — how much light of an even scene reaches a point of the sensor, by quadrature.
#pragma once
#include <optional>

#include "engine/optics/lens.h"
#include "engine/optics/region_outline.h"

namespace lensproof::optics {

/// The bundle that reaches a sensor point through every rim.
struct Bundle {
    double projected_solid_angle =
        0.0;                   // ∫ dL dM over direction cosines, sr: irradiance = radiance × this without losses
    double transmitted = 0.0;  // the same weighted with the Fresnel transmittance: what an even scene's light yields
};

/// The outline of the bundle that reaches the sensor point (x, y), mm, in the direction cosines (l, m) of rays that go
/// from there outwards. Rays are followed backwards through every rim, so no pupil or cos⁴ law is assumed; its area is
/// the projected solid angle ∫ dL dM, to 1e-11. Limits are surfaces, as `rim_margin` numbers them. Empty where no light
/// arrives. `towards`: the cosines of a ray that probably passes, as the reversed chief ray's; else one is looked for
/// over the rear element.
RegionOutline image_outline(const TraceLens<double>& lens, Vec2d sensor_point,
                            std::optional<Vec2d> towards = std::nullopt);

/// The bundle at `image_height` (mm from the axis, in the plane x = 0). The transmittance is integrated with six nodes
/// along each azimuth of the outline. Zero where no light arrives.
Bundle image_bundle(const TraceLens<double>& lens, double image_height);

}  // namespace lensproof::optics
