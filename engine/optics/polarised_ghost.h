// engine/optics/polarised_ghost.h — what a ghost's light owes to its polarisation.
#pragma once
#include "engine/optics/ghost_path.h"

namespace lensproof::optics {

/// What arrives along `path` (an empty one: straight through) of unpolarised light whose polarisation is carried from
/// surface to surface (engine/optics/polarised_ray.h), over what `trace_ghost` says, which averages it at each: a
/// reflection at a slant leaves light polarised, and the next sends back more of that, or less. 1 where the ray does
/// not arrive. The sensor and the stop's blades are taken to leave polarisation as it is.
double polarisation_factor(const TraceLens<double>& lens, const GhostPath& path, const Ray<double>& ray,
                           const StrayMirrors<double>& mirrors);

}  // namespace lensproof::optics
