// engine/optics/frame.h — where the surfaces of a tilted and decentred lens stand.
#pragma once
#include <array>
#include <vector>

#include "engine/base/vec.h"
#include "engine/optics/prescription.h"

namespace lensproof::optics {

/// A right-handed system of coordinates: its origin (mm) and its axes of unit length, in lens space.
struct Frame {
    Vec3d origin;
    std::array<Vec3d, 3> axes{{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};

    /// A vector given in this frame, in lens space.
    [[nodiscard]] Vec3d rotate(const Vec3d& v) const { return v.x * axes[0] + (v.y * axes[1] + v.z * axes[2]); }
    /// The frame shifted by a vector given in itself.
    [[nodiscard]] Frame shifted(const Vec3d& by) const { return {origin + rotate(by), axes}; }
    /// The frame turned by the right-hand rule about its own axis x (0), y (1) or z (2).
    [[nodiscard]] Frame turned(std::size_t about, double angle_deg) const;
    /// The frame turned about its x, then the turned y, then the twice turned z, as `Misalignment` says.
    [[nodiscard]] Frame tilted(const std::array<double, 3>& tilt_deg) const;
};

/// The tilts that `Frame::tilted` makes the frame's axes of: the middle one from −90° to 90°; where that is ±90°, which
/// leaves only the sum of the others, the last is 0.
std::array<double, 3> tilt_angles(const Frame& frame);

/// The frames of the prescription's surfaces, in order: each by its own misalignment, then by its groups'. The first
/// vertex of an aligned lens is the origin.
std::vector<Frame> surface_frames(const Prescription& prescription);

}  // namespace lensproof::optics
