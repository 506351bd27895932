// engine/optics/design_fields.h — where a design's fields lie, as angles of its chief rays.
#pragma once
#include <optional>
#include <vector>

#include "engine/optics/chief_ray.h"
#include "engine/optics/prescription.h"

namespace lensproof::optics {

/// The angle between the axis and a direction whose projections on the planes of x and y lie at these angles: their
/// tangents add as a vector's components. Degrees; with y's sign where x is 0, else not negative.
double oblique_angle_deg(const Vec2d& angles_deg);

/// The first field angle (radians, from 0) whose chief ray meets the sensor's plane this far from the axis, or the last
/// one where none reaches so far.
double field_at_image_height(const ChiefRays& chief_rays, double height_mm);

/// The angle of the chief ray of a design's field point, radians: that of a point across the axis is that of one as far
/// off along y, with y's sign where x is 0. Image heights are read in the lens's sensor plane, objects stand
/// `object_distance_mm` in front of the first vertex. Nothing where the lens has no such chief ray.
///
/// `chief_rays` are those of `lens`. A paraxial image height is that over the focal length or the magnification.
std::optional<double> field_angle(FieldKind kind, const Vec2d& point, const TraceLens<double>& lens,
                                  const ChiefRays& chief_rays, double object_distance_mm);

/// The angles of the prescription's design fields that the lens has, beyond its rims too, each once, degrees: in the
/// file's order, of a lens of revolution from 0. Empty where there are no such fields.
std::vector<double> design_fields_deg(const Prescription& prescription, const Lens& lens, double wavelength_nm,
                                      double object_distance_mm);

}  // namespace lensproof::optics
