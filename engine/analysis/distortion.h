// engine/analysis/distortion.h — image heights against the projection that the lens is designed for.
#pragma once
#include <optional>

#include "engine/optics/field_bundle.h"
#include "engine/optics/prescription.h"

namespace lensproof::analysis {

/// The image height (mm, positive for a positive field angle) of the bundle's object in a lens without distortion, from
/// first-order data at the lens's wavelength:
///   - object at infinity: f · r(θ), r the projection's radius (f tan θ, f θ, …);
///   - near object, rectilinear: the paraxial magnification m times the object's height;
///   - near object, other projections: r(θ) times −m (d + z_E), the distance from the paraxial entrance pupil to the
///     object's plane imaged. With the object drawn away this becomes f, and for tan θ it is the former but for the
///     pupil's aberration.
/// Nothing for a rectilinear lens from 90° on, where the paraxial image is at infinity, and behind gratings, which turn
/// the axis.
std::optional<double> ideal_height(const optics::TraceLens<double>& lens, optics::Projection projection,
                                   const optics::FieldBundle& bundle);

/// The plane that heights are compared in, z: that of the paraxial image at the reference wavelength, where h_ideal is
/// the height of paraxial rays, so that a curve starts at 0 wherever the sensor stands. The sensor's, where the
/// paraxial image lies at infinity. `object_distance` from z = 0.
double distortion_plane(const optics::TraceLens<double>& reference, double object_distance);

/// 100 (h / h_ideal − 1) of the bundle's chief ray in the plane z = `plane_z`; 0 at field 0. Nothing where it does not
/// get through.
std::optional<double> distortion_percent(const optics::TraceLens<double>& lens, optics::Projection projection,
                                         const optics::FieldBundle& bundle, double plane_z);

}  // namespace lensproof::analysis
