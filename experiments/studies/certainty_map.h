// experiments/studies/certainty_map.h — where in its frame a measurement knows the projection, and from which points.
#pragma once
#include <string>
#include <vector>

#include "calibration/profile/profile.h"
#include "experiments/draw/ticks.h"

namespace lensproof::studies {

/// The pixels of one subject's frame, covered or not, in words and as a drawing.
struct CertaintyMap {
    std::string caption;
    std::string svg;
};

/// Pieces of 45° lines `step` apart that lie in the frame of `width` × `height` pixels and outside a convex polygon
/// (either sense; fewer than three corners: nothing is outside it). Two points each.
std::vector<std::vector<Vec2d>> hatching_outside(const std::vector<Vec2d>& polygon, double width, double height,
                                                 double step);

/// Projection uncertainties (1 σ, far points) that the profiles' maps hold, smallest to largest inside the points'
/// hull and ten times that at most: one range for all drawings, so that colours compare. 0.001 to 1 px where there is
/// no map.
draw::AxisRange certainty_range(const std::vector<const calibration::Profile*>& profiles);

/// Left the projection uncertainty as colours, right the points used; in both the points' convex hull as an outline,
/// and what lies outside it, where the model extrapolates, hatched. Pixels as in engine/formats/image/image.h, y down.
/// `colour` (CSS) is the points'. The profile has to have a geometry with an uncertainty map.
CertaintyMap certainty_map(const calibration::Profile& profile, const std::string& title, const std::string& colour,
                           const draw::AxisRange& range);

}  // namespace lensproof::studies
