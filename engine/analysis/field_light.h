// engine/analysis/field_light.h — how much light a field gets: vignetting and relative illumination.
#pragma once
#include "engine/analysis/beam_outline.h"

namespace lensproof::analysis {

/// What the rims leave of a field's light, seen from both ends.
struct FieldLight {
    optics::RegionOutline beam;   // offsets across the chief ray, mm: its area is the incoming beam's cross-section
    optics::RegionOutline image;  // direction cosines at the image point: its area is the projected solid angle, sr
};

/// For the bundle of one wavelength and the image point that it is judged at, that of the reference wavelength's chief
/// ray. The light that arrives there is radiance · `image.area`, but for losses; no cos⁴ law is assumed.
///
/// `vignetting` is beam.area over that on the axis, and may exceed 1, since pupils grow; relative illumination is
/// image.area over that on the axis. Both are exact to about 1e-11 where the outlines are star-shaped.
FieldLight field_light(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle, Vec2d image_point);

/// Both ratios at one field. Of what the axis sees nothing, the ratios are 0.
struct FieldLightRatio {
    double vignetting = 0.0;
    double relative_illumination = 0.0;
};
FieldLightRatio light_ratio(const FieldLight& field, const FieldLight& axis);

}  // namespace lensproof::analysis
