// calibration/profile/curve_difference.h — how far two measured curves are apart, and how sure that is.
#pragma once
#include <optional>
#include <string>

#include "calibration/profile/profile.h"

namespace lensproof::calibration {

/// a − b over the image heights that both cover.
struct CurveDifference {
    Curve curve;
    double rms = 0.0;  // over the area of the picture: heights count in proportion to themselves
    double rms_sigma = 0.0;
    double largest = 0.0;  // of |a − b|
    double largest_sigma = 0.0;
    double largest_at = 0.0;  // image height
};

/// Bands add in quadrature, the two being measured independently. The errors of neighbouring samples of a curve go
/// together, so the rms's uncertainty is taken to be the rms of the samples' (its upper bound). Nothing where no height
/// is shared.
std::optional<CurveDifference> difference(const Curve& a, const Curve& b);

/// How far apart (px) the two profiles of the same camera image the same direction: r_a(θ) − r_b(θ) over image height.
/// From the field angles at equal height, Δr = −(θ_a − θ_b) / (dθ/dr), which is exact to first order in the difference.
std::optional<CurveDifference> radial_difference_px(const Profile& a, const Profile& b);

/// The difference of two profiles' curves of that key, and of kQuantities.image_position the above; nothing where one
/// lacks it.
std::optional<CurveDifference> difference(const Profile& a, const Profile& b, const std::string& curve);

}  // namespace lensproof::calibration
