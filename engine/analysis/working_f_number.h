// engine/analysis/working_f_number.h — how wide the cone of real rays is that reaches the axis of the image.
#pragma once

#include "engine/base/infinity.h"
#include "engine/optics/trace.h"

namespace lensproof::analysis {

/// 1 / (2 n' sin U') of the outermost real rays in the plane x = 0 that leave the axial object point, at
/// `object_distance` mm > 0 in front of the first vertex, and pass every rim; for a lens that is not symmetric
/// 1 / (n' (sin U'₁ − sin U'₂)) of the upper and the lower one. Unlike the paraxial f-number it knows the aberrations
/// of the pupils and the rims that cut before the stop does, and it sets the irradiance on the axis. Infinite where no
/// such light passes or it leaves parallel to the axis.
double real_working_f_number(const optics::TraceLens<double>& lens, double object_distance = kInfinity);

}  // namespace lensproof::analysis
