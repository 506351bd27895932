#include "engine/check/restoration.h"

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"

namespace lensproof::check {

Restoration::Restoration(const CheckedLens& checked)
    : efl_(checked.claims.efl_mm),
      image_distance_(checked.claims.bfl_mm),
      object_distance_(checked.prescription.object_distance_mm),
      image_distance_is_bfl_(checked.claims.bfl_mm.has_value()) {
    const double last = checked.size() > 0 ? checked.row(checked.size() - 1).thickness_mm : 0.0;
    // A plane of best focus, or behind a beam that leaves parallel, says nothing of the paraxial image.
    const bool is_image = !checked.is_at_best_focus && !checked.collimates();
    if (!image_distance_ && is_image && last > 0.0 && std::isfinite(last)) {
        image_distance_ = last;
    }
    as_given_ = checked.focus ? residual(checked.table) : kInfinity;
}

double Restoration::residual(const ParaxialTable& table) const {
    const Focus focus = paraxial_focus(table, object_distance_);
    const double scale = std::abs(efl_.value_or(focus.efl));
    const double off_efl = efl_ ? std::abs(focus.efl - *efl_) : 0.0;
    const double at = image_distance_is_bfl_ ? focus.bfl : focus.image_distance;
    const double off_image = image_distance_ ? std::abs(at - *image_distance_) : 0.0;
    const double worst = std::max(off_efl, off_image) / scale;
    return std::isfinite(worst) ? worst : kInfinity;
}

}  // namespace lensproof::check
