// engine/optics/rim_margin.h — how far a ray stands from the rims of a lens: the region that its rims leave open.
#pragma once
#include "engine/optics/region.h"
#include "engine/optics/trace.h"

namespace lensproof::optics {

/// The ray against every rim: margin max (r² / semi-diameter² − 1) over the surfaces, limit the surface (from 0) where
/// that is; limit % surface count is the surface in every case. The stop's blades count as rims of their own. A ray
/// that ends (a miss, total reflection) has at least the margins of the rims it had passed until there; where those are
/// none, an infinite margin, and the surface count · (1 + status) + surface as its limit, so that its edge is told from
/// the rim's.
RegionSample rim_margin(const TraceLens<double>& lens, const Ray<double>& ray, Direction direction);

/// Whether lens and rims are their own mirror image in the plane x = 0.
bool is_mirror_symmetric(const TraceLens<double>& lens);

}  // namespace lensproof::optics
