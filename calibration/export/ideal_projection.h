// calibration/export/ideal_projection.h — the projections that other programs correct a lens to.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/optics/projection.h"

namespace lensproof::calibration {

/// lensfun's name of a projection: "fisheye" is the equidistant one.
std::string name_of(optics::Projection projection);
std::vector<std::string> ideal_projection_names();
std::optional<optics::Projection> ideal_projection(const std::string& name);

/// r/f of `angle_rad`; none where the projection images nothing, or no longer one to one.
std::optional<double> ideal_radius(optics::Projection projection, double angle_rad);

/// The angle imaged at r/f; none where there is none.
std::optional<double> ideal_angle(optics::Projection projection, double radius);

}  // namespace lensproof::calibration
