#include "engine/check/sag.h"

#include <algorithm>

namespace lensproof {

SurfaceShape<double> prescribed_shape(const PrescribedSurface& row) {
    return {.curvature = row.curvature(),
            .conic = row.conic,
            .asphere = row.asphere,
            .terms = row.is_asphere() ? kAsphereTerms : 0,
            .is_toroid = row.radius_x_mm.has_value(),
            .curvature_x = row.radius_x_mm ? 1.0 / *row.radius_x_mm : 0.0};
}

double sag_at(const PrescribedSurface& row, double r, Section section) {
    const bool along_y = section == Section::along_y;
    return sag(prescribed_shape(row), along_y ? 0.0 : r, along_y ? r : 0.0);
}

double separation_at(const PrescribedSurface& row, const PrescribedSurface& next, double r) {
    const auto along = [&](Section section) {
        return row.thickness_mm + sag_at(next, r, section) - sag_at(row, r, section);
    };
    return std::min(along(Section::along_y), along(Section::along_x));
}

}  // namespace lensproof
