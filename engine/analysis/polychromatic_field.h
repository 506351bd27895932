// engine/analysis/polychromatic_field.h — one object point's light at several wavelengths, about one image point.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "engine/analysis/beam_outline.h"
#include "engine/analysis/wavefront.h"

namespace lensproof::analysis {

/// A wavelength and how much of the light it has; the weights need not add up to 1.
struct WeightedWavelength {
    double wavelength_nm = 0.0;
    double weight = 1.0;
};

/// What PSF, MTF and focus are computed from: the beam of one object point at each wavelength. Positions in the image
/// plane count from the centre of `sphere`, which is where the chief ray of the reference wavelength arrives, so that
/// lateral colour shows: x along +x, y (tangential) away from the axis for a field in +y.
struct PolychromaticField {
    struct Part {
        double wavelength_nm = 0.0;
        double weight = 0.0;  // in the sensor's light: the given weight times the beam's cross-section
        optics::TraceLens<double> lens;
        optics::RegionOutline outline;  // of the beam
    };
    optics::FieldBundle bundle;
    ReferenceSphere sphere;
    Vec3d chief_direction;    // optical direction cosines of the chief ray at the image point
    std::vector<Part> parts;  // whose light passes; their weights add up to 1. Empty: no light arrives
};

/// The field of `bundle` (its chief ray at `reference_nm`, best with Rims::follow) at the sensor of `lens`. Throws
/// InputError for a wavelength that a glass's formula does not cover, or a weight that is negative or not finite.
PolychromaticField polychromatic_field(const optics::Lens& lens, const optics::FieldBundle& bundle, double reference_nm,
                                       std::span<const WeightedWavelength> wavelengths);

/// Sums over the beam for integrands that oscillate: `rings` Gauss-Legendre nodes along each of about `azimuths` radii
/// from the outline's centre to its rim; the radii are even around an outline without corners, else Gauss-Legendre from
/// corner to corner. Weights in mm². (For smooth integrands `region_quadrature` needs fewer rays.)
std::vector<optics::RegionNode> polar_nodes(const PolychromaticField::Part& part, const optics::FieldBundle& bundle,
                                            int azimuths, int rings);

/// A ray of the beam at the image.
struct ImageRay {
    Vec3d direction;      // optical direction cosines: the index times the direction
    Vec2d aberration;     // mm, where it meets the image plane, from the image point
    double path = 0.0;    // optical path up to the foot of the perpendicular from the image point, mm
    bool passes = false;  // every rim
};

/// The image side of the ray at `offset`, followed beyond rims. Nothing where it does not get through the lens, or runs
/// away from the image.
std::optional<ImageRay> image_ray(const PolychromaticField::Part& part, const PolychromaticField& field, Vec2d offset);

}  // namespace lensproof::analysis
