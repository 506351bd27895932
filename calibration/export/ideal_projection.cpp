#include "calibration/export/ideal_projection.h"

#include <algorithm>

#include "engine/base/angle.h"

namespace lensproof::calibration {
namespace {

using optics::Projection;

constexpr double kBelowRightAngle = kPi / 2 - 1e-4;
constexpr double kBelowBackwards = kPi - 1e-2;

double largest_angle(Projection projection) {
    if (projection == Projection::equidistant) {
        return kPi;
    }
    const bool ends_sideways = projection == Projection::rectilinear || projection == Projection::orthographic;
    return ends_sideways ? kBelowRightAngle : kBelowBackwards;
}

}  // namespace

std::string name_of(Projection projection) {
    return projection == Projection::equidistant ? "fisheye" : optics::projection_name(projection);
}

std::vector<std::string> ideal_projection_names() {
    std::vector<std::string> names;
    std::ranges::transform(optics::kProjections, std::back_inserter(names), name_of);
    return names;
}

std::optional<Projection> ideal_projection(const std::string& name) {
    const auto* const found = std::ranges::find(optics::kProjections, name, name_of);
    return found == optics::kProjections.end() ? std::nullopt : std::optional(*found);
}

std::optional<double> ideal_radius(Projection projection, double angle_rad) {
    const bool is_imaged = angle_rad <= largest_angle(projection);
    return is_imaged ? std::optional(optics::projected_radius(projection, angle_rad)) : std::nullopt;
}

std::optional<double> ideal_angle(Projection projection, double radius) {
    const bool is_reached = radius <= optics::projected_radius(projection, largest_angle(projection));
    return is_reached ? std::optional(optics::projected_angle(projection, radius)) : std::nullopt;
}

}  // namespace lensproof::calibration
