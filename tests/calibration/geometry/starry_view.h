// Stars through a known camera, for the tests of known directions.
#pragma once
#include "calibration/geometry/fit_geometry.h"
#include "tests/calibration/lines/line_pictures.h"

namespace lensproof::calibration::synthetic {

/// `count` directions that the camera images anywhere in the frame, in a frame that `pose` turns into the camera's.
inline ChartView starry_view(const CameraModel& camera, const Pose& pose, int width, int height, int count,
                             unsigned seed) {
    const Pose back{.rotation_rad = -1.0 * pose.rotation_rad, .translation_mm = {}};
    ChartView view{.name = "stars", .chart_mm = {}, .image_px = {}};
    Chance chance(seed);
    while (static_cast<int>(view.image_px.size()) < count) {
        const Vec2d pixel{chance(0.0, width - 1.0), chance(0.0, height - 1.0)};
        if (const auto ray = unproject(camera, pixel)) {
            view.directions.push_back(turned(back, *ray));
            view.image_px.push_back(project(camera, *ray).value());  // to the last digit
        }
    }
    return view;
}

}  // namespace lensproof::calibration::synthetic
