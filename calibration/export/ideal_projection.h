// calibration/export/ideal_projection.h — the projections that other programs correct a lens to.
#pragma once
#include <array>
#include <optional>
#include <string>

namespace lensproof::calibration {

/// r = f tan θ, f θ, 2 f sin(θ/2), 2 f tan(θ/2), f sin θ. The names are lensfun's, where "fisheye" is equidistant.
enum class IdealProjection { rectilinear, fisheye, equisolid, stereographic, orthographic };

inline constexpr std::array kIdealProjections = {IdealProjection::rectilinear, IdealProjection::fisheye,
                                                 IdealProjection::equisolid, IdealProjection::stereographic,
                                                 IdealProjection::orthographic};

std::string name_of(IdealProjection projection);
std::optional<IdealProjection> ideal_projection(const std::string& name);

/// r/f of `angle_rad`; none where the projection images nothing, or no longer one to one.
std::optional<double> ideal_radius(IdealProjection projection, double angle_rad);

/// The angle imaged at r/f; none where there is none.
std::optional<double> ideal_angle(IdealProjection projection, double radius);

}  // namespace lensproof::calibration
