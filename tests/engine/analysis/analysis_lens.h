// tests/engine/analysis/analysis_lens.h — lenses for the tests of the analysis, in any precision and between any two
// media.
#pragma once
#include <limits>
#include <vector>

#include "engine/optics/trace.h"

namespace lensproof::analysis {

/// A row of a lens's table.
struct Row {
    double radius = std::numeric_limits<double>::infinity();
    double thickness = 0.0;
    double index = 1.0;  // behind the surface
    double conic = 0.0;
    double a2 = 0.0;
    double a4 = 0.0;
    double a6 = 0.0;
    double semi_diameter = 1e6;
    bool is_stop = false;
};

/// The lens of `rows` behind a medium of `index_before`; the image plane stands the last thickness behind it.
template <class T>
optics::TraceLens<T> lens_of(const std::vector<Row>& rows, double index_before = 1.0) {
    optics::TraceLens<T> lens{.surfaces = {}, .image_z = T(0)};
    for (const Row& row : rows) {
        const T curvature = T(1) / T(row.radius);
        lens.surfaces.push_back(optics::make_trace_surface<T>(
            curvature + 2 * T(row.a2), lens.image_z, T(row.semi_diameter), T(index_before), T(row.index), row.is_stop));
        if (row.conic != 0.0 || row.a2 != 0.0 || row.a4 != 0.0 || row.a6 != 0.0) {
            optics::SpecialSurface<T> special;
            special.has_shape = true;
            special.shape = {.curvature = curvature,
                             .conic = T(row.conic),
                             .asphere = {T(row.a2), T(row.a4), T(row.a6)},
                             .terms = 3};
            lens.surfaces.back().special = static_cast<int>(lens.specials.size());
            lens.specials.push_back(special);
        }
        index_before = row.index;
        lens.image_z += T(row.thickness);
    }
    return lens;
}

/// The same numbers in another precision, for what the paraxial and the third-order theory ask.
template <class T>
optics::TraceLens<T> converted(const optics::TraceLens<double>& lens) {
    optics::TraceLens<T> made{.surfaces = {}, .image_z = T(lens.image_z)};
    for (const optics::TraceSurface<double>& from : lens.surfaces) {
        made.surfaces.push_back(optics::make_trace_surface<T>(T(from.curvature), T(from.vertex_z), T(0),
                                                              T(from.index_before), T(from.index_after), from.is_stop));
        made.surfaces.back().semi_diameter_squared = T(from.semi_diameter_squared);
        made.surfaces.back().special = from.special;
    }
    for (const optics::SpecialSurface<double>& from : lens.specials) {
        optics::SpecialSurface<T> special;
        special.has_shape = from.has_shape;
        special.shape = {.curvature = T(from.shape.curvature),
                         .conic = T(from.shape.conic),
                         .asphere = {T(from.shape.asphere[0]), T(from.shape.asphere[1])},
                         .terms = 2};
        made.specials.push_back(special);
    }
    return made;
}

}  // namespace lensproof::analysis
