#include "engine/scene/camera_pose.h"

#include "engine/io/input_error.h"

namespace lensproof {

CameraPose look_at(const Vec3d& position, const Vec3d& target, const Vec3d& up) {
    const Vec3d way = target - position;
    const Vec3d across = cross(way, up);
    if (!(length(way) > 0.0)) {
        throw InputError("the camera stands where it looks at, expected two different points");
    }
    if (!(length(across) > 1e-9 * length(way) * length(up))) {
        throw InputError("the camera's up is along its view, or of no length; expected a direction across it");
    }
    const Vec3d forward = normalized(way);
    const Vec3d right = normalized(across);
    return {.position = position, .right = right, .down = cross(forward, right), .forward = forward};
}

}  // namespace lensproof
