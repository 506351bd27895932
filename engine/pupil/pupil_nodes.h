// engine/pupil/pupil_nodes.h — the regions of the pupil that light passes, at nodes over the sensor.
#pragma once
#include <vector>

#include "engine/optics/trace.h"
#include "engine/pupil/pupil_region.h"
#include "engine/pupil/rear_disc.h"

namespace lensproof {

/// Regions in the plane of the rear disc for sensor points at nodes in radius and azimuth, each in the frame in which
/// its sensor point lies at (0, r). Between nodes they are linear in both, and hold what passes.
struct PupilNodes {
    PupilSymmetry symmetry = PupilSymmetry::mirror;
    std::size_t azimuths = 1;          // evenly spread, from the sensor's +y towards +x
    std::vector<double> radii;         // rising, mm; no light was found beyond the last. None: no light at all
    std::vector<PupilRegion> regions;  // at radius i and azimuth k: [i · azimuths + k]
};

/// Which part of the sensor the nodes are for, and how finely.
struct NodeSearch {
    bool by_radius = true;  // the lens is rotationally symmetric
    double sensor_radius_mm = 0.0;
    double most_excess = 0.005;  // as PupilMapSettings has it
};

/// Traces the regions of all lenses of a band, one a wavelength, and sets nodes where they are needed.
PupilNodes find_pupil_nodes(const std::vector<TraceLens<double>>& band, const RearDisc& disc, const NodeSearch& search);

}  // namespace lensproof
