// engine/pupil/surface_cap.h — the part of a surface that a ray can pass through.
#pragma once
#include "engine/optics/trace.h"

namespace lensproof::pupil {

/// A surface inside its rim, in its own axes, mm.
struct SurfaceCap {
    optics::SurfaceShape<double> shape;
    double radius = 0.0;  // of its rim; or of its equator, less 1e-12, where an ellipsoid ends before that
};
SurfaceCap surface_cap(const optics::TraceLens<double>& lens, const optics::TraceSurface<double>& surface);

}  // namespace lensproof::pupil
