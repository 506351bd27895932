// calibration/export/covered_frame.h — the part of a picture that a profile's camera model was measured in.
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "calibration/profile/profile.h"
#include "engine/base/vec.h"

namespace lensproof::calibration {

/// A pixel and the unit direction that the profile's model says it shows.
struct FramePoint {
    Vec2d pixel_px;
    Vec3d direction;
    bool covered = true;  // not farther from the principal point than the measurement reached
};

/// A grid over the picture, its outermost pixels included, `columns` points wide. What the model cannot reach is left
/// out. The profile must have a geometry with a covered height above 0.
std::vector<FramePoint> frame_points(const Profile& profile, int columns);

/// The largest distance, px, between where `model` and the profile put the covered points; none where `model` puts one
/// nowhere.
std::optional<double> largest_difference_px(const std::vector<FramePoint>& points,
                                            const std::function<std::optional<Vec2d>(const Vec3d&)>& model);

/// A point of the radial function r(θ).
struct RadialPoint {
    double angle_rad = 0.0;
    double radius_px = 0.0;
    bool covered = true;
};

/// r(θ) at `count` radii from 0 (left out) to the picture's farthest corner, as far as the model reaches.
std::vector<RadialPoint> radial_points(const Profile& profile, int count);

/// In fits of a target's model, how much less a point counts that was not covered: enough to keep a polynomial from
/// running away there, too little to bend it where the profile knows.
constexpr double kUncoveredSigma = 100.0;

/// The profile's geometry. Throws InputError, naming the profile, where it has none or one that covers nothing.
const ProfileGeometry& exported_geometry(const Profile& profile);

}  // namespace lensproof::calibration
