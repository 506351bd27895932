// engine/pupil/pupil_nodes.h — the regions that light passes, at nodes over the sensor (or the field) and wavelengths.
#pragma once
#include <vector>

#include "engine/base/disc.h"
#include "engine/pupil/pupil_region.h"
#include "engine/pupil/pupil_stations.h"

namespace lensproof::pupil {

/// Fractions of a radius, at which nodes stand, are multiples of 1 / this.
inline constexpr int kFinestFractions = 4096;

/// Regions of a plane, each in the frame in which its place (RayFamily) lies at (0, r), at nodes in position in the
/// band, azimuth, and radius as a fraction of where the light ends. Between nodes they are linear in all
/// three, and hold what passes.
struct PupilNodes {
    PupilSymmetry symmetry = PupilSymmetry::mirror;
    std::size_t azimuths = 1;       // evenly spread, from +y towards +x
    std::vector<double> positions;  // in the band, rising from 0 to 1
    std::vector<double> ends;       // radii, where the light or the search ends, at [position · azimuths + azimuth]
    std::vector<double> fractions;  // of the end: rising from 0 to 1. None: no light at all
    std::vector<PupilRegion> regions;

    /// Of the region at three nodes.
    [[nodiscard]] std::size_t index(std::size_t position, std::size_t azimuth, std::size_t fraction) const {
        return (position * azimuths + azimuth) * fractions.size() + fraction;
    }
};

/// Which places the nodes are for, and how finely.
struct NodeSearch {
    Disc disc;                   // that no region reaches out of
    bool by_radius = true;       // the lens is rotationally symmetric
    double end = 0.0;            // no place has a larger radius
    double most_excess = 0.005;  // as PupilMapSettings has it
    device::SharedDevice* device = nullptr;
};

/// Lets the full circle pass the stop, which holds what any blades leave.
void open_stop(optics::TraceLens<double>& lens);

/// Traces regions of lenses across a band, one a wavelength, and sets nodes where they are needed. Stops are opened.
PupilNodes find_pupil_nodes(std::vector<optics::TraceLens<double>> band, const RayFamily& rays,
                            const NodeSearch& search);

}  // namespace lensproof::pupil
