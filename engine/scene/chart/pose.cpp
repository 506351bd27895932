#include "engine/scene/chart/pose.h"

namespace lensproof::scene {

AffineMap place(const Placement& placement) {
    // Turning about y by a positive angle carries the z axis to the right; about x by a negative one, downwards.
    const Matrix3 facing = product(about_y(placement.towards_right_deg), about_x(-placement.towards_down_deg));
    const Matrix3 tilt = product(about_z(placement.tilt_deg[2]),
                                 product(about_y(placement.tilt_deg[1]), about_x(placement.tilt_deg[0])));
    const Vec3d direction{facing[0].z, facing[1].z, facing[2].z};
    return {.linear = product(facing, tilt), .translation = placement.distance_mm * direction};
}

}  // namespace lensproof::scene
