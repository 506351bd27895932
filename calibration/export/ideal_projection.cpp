#include "calibration/export/ideal_projection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lensproof::calibration {
namespace {

constexpr double kBelowRightAngle = std::numbers::pi / 2 - 1e-4;
constexpr double kBelowBackwards = std::numbers::pi - 1e-2;

double largest_angle(IdealProjection projection) {
    switch (projection) {
        case IdealProjection::rectilinear:
        case IdealProjection::orthographic:
            return kBelowRightAngle;
        case IdealProjection::stereographic:
        case IdealProjection::equisolid:
            return kBelowBackwards;
        case IdealProjection::fisheye:
            break;
    }
    return std::numbers::pi;
}

}  // namespace

std::string name_of(IdealProjection projection) {
    constexpr std::array names = {"rectilinear", "fisheye", "equisolid", "stereographic", "orthographic"};
    return names.at(static_cast<std::size_t>(projection));
}

std::optional<IdealProjection> ideal_projection(const std::string& name) {
    const auto* const found = std::ranges::find(kIdealProjections, name, name_of);
    return found == kIdealProjections.end() ? std::nullopt : std::optional(*found);
}

std::optional<double> ideal_radius(IdealProjection projection, double angle_rad) {
    if (!(angle_rad <= largest_angle(projection))) {
        return std::nullopt;
    }
    switch (projection) {
        case IdealProjection::rectilinear:
            return std::tan(angle_rad);
        case IdealProjection::orthographic:
            return std::sin(angle_rad);
        case IdealProjection::stereographic:
            return 2.0 * std::tan(angle_rad / 2.0);
        case IdealProjection::equisolid:
            return 2.0 * std::sin(angle_rad / 2.0);
        case IdealProjection::fisheye:
            break;
    }
    return angle_rad;
}

std::optional<double> ideal_angle(IdealProjection projection, double radius) {
    const auto farthest = ideal_radius(projection, largest_angle(projection));
    if (!(radius <= *farthest)) {
        return std::nullopt;
    }
    switch (projection) {
        case IdealProjection::rectilinear:
            return std::atan(radius);
        case IdealProjection::orthographic:
            return std::asin(radius);
        case IdealProjection::stereographic:
            return 2.0 * std::atan(radius / 2.0);
        case IdealProjection::equisolid:
            return 2.0 * std::asin(radius / 2.0);
        case IdealProjection::fisheye:
            break;
    }
    return radius;
}

}  // namespace lensproof::calibration
