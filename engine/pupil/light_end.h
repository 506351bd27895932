// engine/pupil/light_end.h — up to which radius places are lit.
#pragma once
#include <vector>

#include "engine/pupil/pupil_stations.h"

namespace lensproof::pupil {

/// Where it is looked for.
struct LightEndSearch {
    double farthest = 0.0;
    double precision = 0.0;        // of that
    std::vector<double> azimuths;  // in turns
};

/// Of each of these lenses of the band, azimuth by azimuth, the last radius that is lit: `farthest` itself,
/// or a radius that is lit, with darkness a precision farther out. 0: no light at all.
std::vector<double> light_ends(PupilStations& stations, const std::vector<std::size_t>& lenses,
                               const LightEndSearch& search);

}  // namespace lensproof::pupil
