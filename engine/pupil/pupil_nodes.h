// engine/pupil/pupil_nodes.h — the regions that light passes, at nodes over the sensor or over the scene's directions.
#pragma once
#include <functional>
#include <vector>

#include "engine/optics/trace.h"
#include "engine/pupil/disc.h"
#include "engine/pupil/pupil_region.h"

namespace lensproof {

/// The rays whose passage makes the regions: one for each place and each point of the plane that the regions lie in. A
/// place is a point of the sensor (mm) or a direction of the scene (the field angle, rad, along its azimuth). Turned
/// about the axis with its point, it has to have the turned ray.
struct RayFamily {
    Direction direction = Direction::forward;
    std::function<Ray<double>(Vec2d place, Vec2d point)> ray;
};

/// Regions for places at nodes in radius and azimuth, each in the frame in which its place lies at (0, r). Between
/// nodes they are linear in both, and hold what passes.
struct PupilNodes {
    PupilSymmetry symmetry = PupilSymmetry::mirror;
    std::size_t azimuths = 1;          // evenly spread, from the places' +y towards +x
    std::vector<double> radii;         // rising; no light was found beyond the last. None: no light at all
    std::vector<PupilRegion> regions;  // at radius i and azimuth k: [i · azimuths + k]
};

/// Which places the nodes are for, and how finely.
struct NodeSearch {
    Disc disc;                   // that no region reaches out of
    bool by_radius = true;       // the lens is rotationally symmetric
    double end = 0.0;            // places lie within this radius
    double most_excess = 0.005;  // as PupilMapSettings has it
};

/// Traces the regions of all lenses of a band, one a wavelength, and sets nodes where they are needed. Stops are opened
/// to the full circle, which holds what any blades leave.
PupilNodes find_pupil_nodes(std::vector<TraceLens<double>> band, const RayFamily& rays, const NodeSearch& search);

}  // namespace lensproof
