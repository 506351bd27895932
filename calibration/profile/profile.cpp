#include "calibration/profile/profile.h"

#include <cmath>

namespace lensproof::calibration {

double ProfileGeometry::standard_error(std::size_t parameter) const {
    return std::sqrt(covariance[parameter * (parameters(model).size() + 1)]);
}

bool has_posed_chart(const ProfileView& view) {
    return view.found && view.pose && !view.points.empty() && !view.points.front().direction;
}

double half_diagonal_px(const Profile& profile) {
    return 0.5 * std::hypot(profile.width_px, profile.height_px);
}

const Curve* find_curve(const Profile& profile, const std::string& key) {
    const auto found = profile.curves.find(key);
    return found == profile.curves.end() ? nullptr : &found->second;
}

std::string why_not_measured(const Profile& profile, const char* part, const std::string& otherwise) {
    const auto found = profile.not_measured.find(part);
    return found == profile.not_measured.end() ? otherwise : found->second;
}

}  // namespace lensproof::calibration
