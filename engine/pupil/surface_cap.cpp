#include "engine/pupil/surface_cap.h"

#include <algorithm>
#include <cmath>

#include "engine/optics/surface_axes.h"

namespace lensproof::pupil {

SurfaceCap surface_cap(const optics::TraceLens<double>& lens, const optics::TraceSurface<double>& surface) {
    const optics::SurfaceShape<double> shape = optics::shape_of(lens, surface);
    const double rim = std::sqrt(surface.semi_diameter_squared);
    const double bulge = (1.0 + shape.conic) * shape.curvature * shape.curvature;
    return {.shape = shape, .radius = bulge > 0.0 ? std::min(rim, (1.0 - 1e-12) * (1.0 / std::sqrt(bulge))) : rim};
}

}  // namespace lensproof::pupil
