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
/// Nothing for a rectilinear lens from 90° on, and where the paraxial image is at infinity.
std::optional<double> ideal_height(const optics::TraceLens<double>& lens, optics::Projection projection,
                                   const optics::FieldBundle& bundle);

/// 100 (h / h_ideal − 1) of the bundle's chief ray at the sensor's plane; 0 at field 0.
std::optional<double> distortion_percent(const optics::TraceLens<double>& lens, optics::Projection projection,
                                         const optics::FieldBundle& bundle);

}  // namespace lensproof::analysis
