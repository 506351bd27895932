// engine/pupil/pupil_nodes.h — the regions of the pupil that light passes, at nodes over sensor and wavelengths.
#pragma once
#include <vector>

#include "engine/optics/trace.h"
#include "engine/pupil/pupil_region.h"
#include "engine/pupil/rear_disc.h"

namespace lensproof {

/// Regions in the plane of the rear disc, each in the frame in which its sensor point lies at (0, r), at nodes in
/// position in the band, azimuth, and radius as a share of where the light ends. Between nodes they are linear in all
/// three, and hold what passes.
struct PupilNodes {
    PupilSymmetry symmetry = PupilSymmetry::mirror;
    std::size_t azimuths = 1;       // evenly spread, from the sensor's +y towards +x
    std::vector<double> positions;  // in the band, rising from 0 to 1
    std::vector<double> ends_mm;    // at each position: the light ends there, or the sensor does
    std::vector<double> shares;     // of the end: rising from 0 to 1. None: no light at all
    std::vector<PupilRegion> regions;

    /// Of the region at three nodes.
    [[nodiscard]] std::size_t index(std::size_t position, std::size_t azimuth, std::size_t share) const {
        return (position * azimuths + azimuth) * shares.size() + share;
    }
};

/// Which part of the sensor the nodes are for, and how finely.
struct NodeSearch {
    bool by_radius = true;  // the lens is rotationally symmetric
    double sensor_radius_mm = 0.0;
    double most_excess = 0.005;  // as PupilMapSettings has it
};

/// Traces regions of lenses across a band, one a wavelength, and sets nodes where they are needed.
PupilNodes find_pupil_nodes(const std::vector<TraceLens<double>>& band, const RearDisc& disc, const NodeSearch& search);

}  // namespace lensproof
