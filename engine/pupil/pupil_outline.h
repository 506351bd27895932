// engine/pupil/pupil_outline.h — outlines of many plane regions at once, by asking which points lie inside.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "engine/pupil/pupil_region.h"

namespace lensproof::pupil {

/// A point, and the region (by its number) that it is asked about.
struct RegionPoint {
    int region;
    Vec2d point;
};

/// Says for each point whether its region holds it: 1, or 0. Points come in order of their regions.
using PassTest = std::function<void(std::span<const RegionPoint>, std::span<std::uint8_t>)>;

/// Where a region lies and how it is bent: around `centre`, about `scale` wide and high, sheared by bend · x².
struct PupilFrame {
    Vec2d centre;
    Vec2d scale{1.0, 1.0};
    double bend = 0.0;  // 1/mm

    /// A point given in the frame, in the plane.
    [[nodiscard]] Vec2d from_own(Vec2d p) const {
        const double x = scale.x * p.x;
        return {centre.x + x, centre.y + scale.y * p.y + bend * x * x};
    }
};

/// A closed polygon around a region, in order of rising azimuth (from +x towards +y); of a mirror image its half at
/// x ≥ 0, from the lower end on x = 0 to the upper one. Without points nothing was found.
struct PupilOutline {
    PupilFrame frame;
    std::vector<Vec2d> points;

    [[nodiscard]] bool is_empty() const { return points.empty(); }
};

struct OutlineSearch {
    double radius = 1.0;  // no region reaches farther from the origin, mm
    PupilSymmetry symmetry = PupilSymmetry::none;
    /// A point of the region, for one that a grid over the disc met nowhere; nothing where there is none.
    std::function<std::optional<Vec2d>(int region)> look_closer;
};

/// The outlines of the regions that `passes` knows, one for each of `expected`: where it probably lies, or nothing.
///
/// A region is found by a grid over its expected place, or over the whole disc; from a point inside, its edge is found
/// by halving along rays that are evenly spread in the region's frame, which makes a sliver round and straight. Where
/// neighbouring edge points turn sharply, rays are added. Edge points lie outside, by 1e-4 of their distance at most,
/// and between them stands the point where the sides next to them, drawn on, meet: the polygon holds an outline that is
/// convex there. A region has to be star-shaped about its centre in its frame.
std::vector<PupilOutline> pupil_outlines(const PassTest& passes, std::span<const std::optional<PupilFrame>> expected,
                                         const OutlineSearch& search);

}  // namespace lensproof::pupil
