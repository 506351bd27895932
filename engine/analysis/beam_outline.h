// engine/analysis/beam_outline.h — the part of an object point's light that passes every rim.
#pragma once
#include <vector>

#include "engine/optics/field_bundle.h"
#include "engine/optics/region_outline.h"

namespace lensproof::analysis {

/// The outline of the offsets (mm across the chief ray, FieldBundle) whose rays pass every rim. For an object at
/// infinity its area is the beam's cross-section; for a near one it is that of the cone in the plane across the chief
/// ray at its point on the first surface. Limits are surfaces, as `rim_margin` numbers them. Empty where no ray passes.
///
/// Where the chief ray itself is clipped, a passing ray is looked for over the first element. The beam is taken to be
/// star-shaped, see RegionOutline: the far side of a central obstruction is not seen.
optics::RegionOutline beam_outline(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle);

}  // namespace lensproof::analysis
