// calibration/explain/twin_camera.h — a fitted lens and its charts as a renderer takes them.
#pragma once
#include <optional>
#include <vector>

#include "calibration/explain/lens_fit.h"
#include "engine/base/affine.h"
#include "engine/optics/lens.h"

namespace lensproof::calibration {

/// A camera whose sensor is square to its axis, with charts before it, of which chief rays make the same pictures as of
/// the changed lens before its sensor.
struct TwinCamera {
    optics::Lens lens;  // with the changes made
    double pixel_pitch_mm = 0.0;
    Vec2d axis_from_middle_px;      // where the axis meets the sensor
    std::vector<AffineMap> charts;  // of each view: from its chart to the camera's frame (engine/scene/chart/pose.h)
};

/// The lens of the first profile in that state. A tilted sensor is put straight by turning all else about its middle;
/// glass that is changed becomes a table of indices, every 5 nm of the range in which its formula holds.
TwinCamera twin_camera(const ExplainedLens& lens, const SeenPoints& seen, const LensState& state);

/// Where that state images each view's points, px. Nothing where one is not imaged.
std::optional<std::vector<std::vector<Vec2d>>> predicted_points(const ExplainedLens& lens, const SeenPoints& seen,
                                                                const LensState& state);

}  // namespace lensproof::calibration
