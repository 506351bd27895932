// tests/engine/analysis/analysis_lens.h — lenses for the tests of the analysis, in any precision and between any two
// media.
#pragma once
#include <vector>

#include "engine/base/infinity.h"
#include "engine/optics/lens.h"

namespace lensproof::analysis {

/// A row of a lens's table.
struct Row {
    double radius = kInfinity;
    double thickness = 0.0;
    double index = 1.0;  // behind the surface
    double conic = 0.0;
    double a2 = 0.0;
    double a4 = 0.0;
    double a6 = 0.0;
    double semi_diameter = 1e6;
    bool is_stop = false;
    bool along_normal = false;  // the terms are
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
                             .terms = 3,
                             .along_normal = row.along_normal};
            lens.surfaces.back().special = static_cast<int>(lens.specials.size());
            lens.specials.push_back(special);
        }
        index_before = row.index;
        lens.image_z += T(row.thickness);
    }
    return lens;
}

/// The lens of these surfaces, whose media are stated by their indices.
inline optics::Lens made_of(std::vector<optics::PrescribedSurface> surfaces) {
    optics::Prescription prescription;
    prescription.surfaces = std::move(surfaces);
    return optics::make_lens(prescription, {});
}

}  // namespace lensproof::analysis
