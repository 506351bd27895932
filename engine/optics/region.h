// engine/optics/region.h — a plane region that is known by asking at points: one of its points, its edge on a line.
#pragma once
#include <functional>
#include <optional>

#include "engine/base/vec.h"

namespace lensproof::optics {

/// How a point stands to a region.
struct RegionSample {
    double margin = 0.0;  // ≤ 0 inside; > 0 outside: smooth along one limit, infinite where nothing is known but that
    int limit = -1;       // the limit that counts: the one with the largest margin
};

using Region = std::function<RegionSample(Vec2d)>;

/// Where to look for a region.
struct RegionSearch {
    Vec2d start;             // probably inside
    double reach = 1.0;      // no point of the region lies farther from `start`
    bool is_mirror = false;  // the region is its own mirror image in x = 0, and start.x = 0
};

/// A point inside: `start`, or else the best of a grid, improved by compass search down the margin (Kolda, Lewis,
/// Torczon, SIAM Review 45, 2003); of a mirror image, on x = 0. Nothing where none is found
/// in at most 18 000 looks: a region of a 1e-9th of the reach, or one at the end of a long, narrow valley.
std::optional<Vec2d> find_inside(const Region& region, const RegionSearch& search);

/// Where a line from a point inside a region leaves it.
struct RegionEdge {
    double distance = 0.0;  // in units of `along`, the last one inside to 1e-14
    int limit = -1;
};

/// The line runs from `inside` along the vector `along`; the edge is expected at about `hint` times it. Found between
/// points inside and outside by TOMS 748 (Alefeld, Potra, Shi 1995), or by halving where the margin is infinite.
RegionEdge region_edge(const Region& region, Vec2d inside, Vec2d along, double hint = 1.0);

}  // namespace lensproof::optics
