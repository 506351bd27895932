// engine/scene/camera_pose.h — where a camera stands in a scene.
#pragma once
#include "engine/optics/vec.h"

namespace lensproof {

/// Where a camera stands in the world. Its frame is that of pose.h: x to the right of the picture, y down, z into the
/// scene, the origin at the vertex of the lens's first surface.
struct CameraPose {
    Vec3d position;
    Vec3d right{1.0, 0.0, 0.0};
    Vec3d down{0.0, 1.0, 0.0};
    Vec3d forward{0.0, 0.0, 1.0};

    [[nodiscard]] Vec3d direction_to_world(const Vec3d& in_camera) const {
        return in_camera.x * right + in_camera.y * down + in_camera.z * forward;
    }
    [[nodiscard]] Vec3d to_world(const Vec3d& in_camera) const { return position + direction_to_world(in_camera); }
    [[nodiscard]] Vec3d direction_to_camera(const Vec3d& in_world) const {
        return {dot(in_world, right), dot(in_world, down), dot(in_world, forward)};
    }
    [[nodiscard]] Vec3d to_camera(const Vec3d& in_world) const { return direction_to_camera(in_world - position); }
};

/// A camera at `position` that looks at `target`, `up` being upwards in the picture. Throws InputError where these do
/// not say a direction: the two points coincide, or `up` is along the view.
CameraPose look_at(const Vec3d& position, const Vec3d& target, const Vec3d& up);

}  // namespace lensproof
