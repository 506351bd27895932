#include "engine/optics/frame.h"

#include <cmath>

#include "engine/base/angle.h"

namespace lensproof::optics {

Frame Frame::turned(std::size_t about, double angle_deg) const {
    const double sine = std::sin(angle_deg * kDegree);
    const double cosine = std::cos(angle_deg * kDegree);
    Frame frame = *this;
    const Vec3d& u = axes[(about + 1) % 3];
    const Vec3d& v = axes[(about + 2) % 3];
    frame.axes[(about + 1) % 3] = cosine * u + sine * v;
    frame.axes[(about + 2) % 3] = cosine * v - sine * u;
    return frame;
}

Frame Frame::tilted(const std::array<double, 3>& tilt_deg) const {
    return turned(0, tilt_deg[0]).turned(1, tilt_deg[1]).turned(2, tilt_deg[2]);
}

std::array<double, 3> tilt_angles(const Frame& frame) {
    // The matrix with the axes as its columns is R_x R_y R_z; its last column is (sin y, −sin x cos y, cos x cos y),
    // its first row (cos y cos z, −cos y sin z, sin y).
    const auto& [x, y, z] = frame.axes;
    const double cos_y = std::hypot(x.x, y.x);
    const double about_y = std::atan2(z.x, cos_y) / kDegree;
    constexpr double kGimbalLock = 1e-12;
    if (cos_y < kGimbalLock) {
        return {std::atan2(y.z, y.y) / kDegree, about_y, 0.0};
    }
    return {std::atan2(-z.y, z.z) / kDegree, about_y, std::atan2(-y.x, x.x) / kDegree};
}

std::vector<Frame> surface_frames(const Prescription& prescription) {
    std::vector<Frame> frames;
    double z = 0.0;
    for (const PrescribedSurface& row : prescription.surfaces) {
        Frame frame{.origin = {0.0, 0.0, z}};
        if (row.misalignment != Misalignment{}) {
            frame.origin.x = row.misalignment.decentre_mm[0];
            frame.origin.y = row.misalignment.decentre_mm[1];
            frame = frame.tilted(row.misalignment.tilt_deg);
        }
        frames.push_back(frame);
        z += row.thickness_mm;
    }
    for (const MisalignedGroup& group : prescription.groups) {
        const double pivot_z = frames[group.first - 1].origin.z + group.pivot_mm;
        const Frame turn = Frame{}.tilted(group.misalignment.tilt_deg);
        for (int i = group.first - 1; i < group.last; ++i) {
            Frame& frame = frames[i];
            const Vec3d from_pivot{frame.origin.x, frame.origin.y, frame.origin.z - pivot_z};
            frame.origin = turn.rotate(from_pivot) +
                           Vec3d{group.misalignment.decentre_mm[0], group.misalignment.decentre_mm[1], pivot_z};
            for (Vec3d& axis : frame.axes) {
                axis = turn.rotate(axis);
            }
        }
    }
    return frames;
}

}  // namespace lensproof::optics
