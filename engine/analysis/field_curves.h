// engine/analysis/field_curves.h — what changes over the field along the chief rays: foci, distortion, colour, light.
#pragma once
#include <span>
#include <vector>

#include "engine/analysis/distortion.h"
#include "engine/analysis/field_light.h"
#include "engine/analysis/ray_pencil.h"
#include "engine/base/infinity.h"
#include "engine/optics/lens.h"

namespace lensproof::analysis {

/// A lens at one wavelength with its chief rays.
struct ColourOfLens {
    double wavelength_nm;
    optics::TraceLens<double> lens;
    optics::ChiefRays chief_rays;

    /// With Rims::follow the curves go on where the chief ray is clipped.
    ColourOfLens(const optics::Lens& whole, double wavelength, optics::Rims rims = optics::Rims::follow)
        : wavelength_nm(wavelength),
          lens(optics::at_wavelength<double>(whole, wavelength)),
          chief_rays(whole, wavelength, rims) {}
};

/// `count` ≥ 2 field angles in even steps from 0 to `largest`, in its unit.
std::vector<double> even_fields(double largest, int count);

struct FieldCurvePoint {
    double field_angle;                        // radians
    double image_height;                       // mm
    std::optional<double> distortion_percent;  // nothing where the projection has no height
    AstigmaticFoci foci;                       // mm from the image plane
};

/// Astigmatism, field curvature and distortion (in `reference`'s paraxial image plane). Fields without a chief ray are
/// left out.
std::vector<FieldCurvePoint> field_curves(const ColourOfLens& colour, const ColourOfLens& reference,
                                          optics::Projection projection, std::span<const double> fields,
                                          double object_distance = kInfinity);

struct LateralColourPoint {
    double field_angle;         // radians
    double image_height;        // mm, of the reference wavelength
    std::vector<double> shift;  // mm: each wavelength's chief ray's height less that of the reference
};

/// Lateral colour of every colour against `reference`. Fields that a colour's chief ray does not reach are left out.
std::vector<LateralColourPoint> lateral_colour(std::span<const ColourOfLens> colours, const ColourOfLens& reference,
                                               std::span<const double> fields, double object_distance = kInfinity);

struct IlluminationPoint {
    double field_angle;   // radians
    double image_height;  // mm, of the reference wavelength
    FieldLightRatio light;
};

/// Vignetting and relative illumination at the reference chief rays' image points.
std::vector<IlluminationPoint> illumination_curve(const ColourOfLens& colour, const ColourOfLens& reference,
                                                  std::span<const double> fields, double object_distance = kInfinity);

}  // namespace lensproof::analysis
