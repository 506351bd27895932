// engine/analysis/axial_curves.h — where the rays of the axial point cross the axis: spherical aberration and colour.
#pragma once
#include <vector>

#include "engine/optics/field_bundle.h"

namespace lensproof::analysis {

struct AxialPoint {
    double zone;    // fraction of the beam's semi-diameter, 0 … 1
    double height;  // mm across the axis at the first surface
    double focus;   // mm from the image plane to where the ray crosses the axis, positive beyond
};

/// The axial beam's semi-diameter, mm: the offset of the last ray that passes every rim, along +y.
double axial_semi_diameter(const optics::TraceLens<double>& lens, const optics::FieldBundle& axis);

/// The longitudinal aberration by zone, of a rotationally symmetric lens at one wavelength; over several wavelengths,
/// with `semi_diameter` that of the reference, it shows axial colour and spherochromatism. Zones of `count` ≥ 2 even
/// steps from 0, where the limit is the paraxial focus. A zone whose ray does not arrive is left out.
std::vector<AxialPoint> longitudinal_aberration(const optics::TraceLens<double>& lens, const optics::FieldBundle& axis,
                                                double semi_diameter, int count);

}  // namespace lensproof::analysis
