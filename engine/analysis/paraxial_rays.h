// engine/analysis/paraxial_rays.h — a paraxial ray surface by surface, as ray-trace tables print it.
#pragma once
#include <vector>

#include "engine/optics/paraxial.h"

namespace lensproof::analysis {

/// A paraxial ray at a surface (Welford, Aberrations of Optical Systems, ch. 3). Its angles are small, so that they and
/// their tangents are one.
struct RayAtSurface {
    double height = 0.0;     // y, mm
    double slope = 0.0;      // u', behind the surface
    double incidence = 0.0;  // i = u + c y, against the normal, in front of the surface
};

/// `ray`, which stands just before the first surface, at each surface.
std::vector<RayAtSurface> ray_at_surfaces(const optics::TraceLens<double>& lens, optics::ParaxialRay ray);

}  // namespace lensproof::analysis
