// engine/optics/dual_numbers.h — the tracer over numbers that carry derivatives (ceres::Jet), for geometry alone.
#pragma once
#include "engine/optics/trace.h"

namespace lensproof::optics {

/// A value `a` with derivatives `v`.
template <class T>
concept DualNumber = requires(const T& number) {
    number.a;
    number.v;
};

/// In place of the tracer's own, whose blades and coatings are for real numbers: a lens that is traced for its geometry
/// has neither.
template <DualNumber Dual>
Dual mask_transmittance(const TraceSurface<Dual>& /*surface*/, const SpecialSurface<Dual>& /*special*/,
                        const Dual& /*x*/, const Dual& /*y*/) {
    return Dual(1.0);
}
template <DualNumber Dual>
Dual coated_transmittance(const TraceSurface<Dual>& /*surface*/, const SpecialSurface<Dual>& /*special*/,
                          bool /*forward*/, const Dual& /*cos_incidence*/) {
    return Dual(1.0);
}

}  // namespace lensproof::optics
