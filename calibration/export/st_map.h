// calibration/export/st_map.h — a profile's distortion as maps for compositing (Nuke's STMap and its like).
#pragma once
#include <string>
#include <vector>

#include "calibration/export/ideal_projection.h"
#include "calibration/profile/profile.h"
#include "engine/formats/image/frame_placement.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

struct StMapOptions {
    /// What the undistorted picture is: this projection at the profile's own focal length (on the axis) and principal
    /// point, its frame as large as the picture's.
    optics::Projection undistorted = optics::Projection::rectilinear;
    /// How far the undistorted picture may reach beyond its frame on each side, as a fraction of the frame's width and
    /// height. What would lie farther out is cut.
    double most_overscan = 0.5;
    int threads = 0;  // 0: one a core
};

/// A map: each pixel says where in the source it takes its colour from.
///
/// R and G are u and v: the frame's lower left corner is (0, 0), its upper right (1, 1), so the centre of the frame's
/// top-left pixel is (0.5 / width, 1 − 0.5 / height). B is 1 where the camera model was measured, 0 where it
/// extrapolates. A is 1; where the lens images nothing that belongs here, A is 0 and u = v = −1, outside every picture.
/// u and v outside 0…1 lie in the source's overscan.
struct StMap {
    formats::Image image;  // metadata: the convention and the profile
    formats::FramePlacement placement;
};

struct StMaps {
    StMap undistort;  // of the undistorted picture; overscan all round, as far as the photo reaches
    StMap distort;    // of the photo's frame
    std::vector<std::string> notes;
};

/// Exact but for rounding to 32-bit floats. Throws InputError for a profile without geometry.
StMaps st_maps(const Profile& profile, const StMapOptions& options);

}  // namespace lensproof::calibration
