#include "calibration/profile/profile.h"

#include <cmath>

namespace lensproof::calibration {

double ProfileGeometry::standard_error(std::size_t parameter) const {
    return std::sqrt(covariance[parameter * (parameters(model).size() + 1)]);
}

double half_diagonal_px(const Profile& profile) {
    return 0.5 * std::hypot(profile.width_px, profile.height_px);
}

}  // namespace lensproof::calibration
