// engine/check/sag.h — where a prescribed surface is, away from its vertex.
#pragma once
#include "engine/optics/prescription.h"

namespace lensproof::check {

/// z above the vertex's plane at `r` mm from the axis, along y, or along x for a toroid's other section. NaN where
/// there is no surface.
enum class Section { along_y, along_x };
double sag_at(const optics::PrescribedSurface& row, double r, Section section = Section::along_y);

/// The distance along the axis from one surface to the next at `r` mm from it, the smaller of the two sections'.
double separation_at(const optics::PrescribedSurface& row, const optics::PrescribedSurface& next, double r);

}  // namespace lensproof::check
