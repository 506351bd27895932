// engine/render/film/sensor.h — where the pixels of a sensor lie behind a lens.
#pragma once
#include <cmath>
#include <cstdint>

#include "engine/base/vec.h"

namespace lensproof::render {

/// The sensor behind a lens: square pixels, centred on the axis. The picture is turned upright, as a camera does it:
/// pixel (u, v) lies at x = −(u − (width − 1)/2) pitch, y = (v − (height − 1)/2) pitch in lens space.
struct Sensor {
    int width = 0;
    int height = 0;
    double pixel_pitch_mm = 0.0;

    [[nodiscard]] Vec2d position(double u, double v) const {
        return {-(u - 0.5 * (width - 1)) * pixel_pitch_mm, (v - 0.5 * (height - 1)) * pixel_pitch_mm};
    }
    /// The pixel coordinates of a point, on the sensor or beyond it: `position` undone.
    [[nodiscard]] Vec2d pixel(Vec2d position) const {
        return {0.5 * (width - 1) - position.x / pixel_pitch_mm, position.y / pixel_pitch_mm + 0.5 * (height - 1)};
    }
    /// From the axis to the farthest point of it; or of what lies up to `margin_px` around it.
    [[nodiscard]] double half_diagonal_mm(double margin_px = 0.0) const {
        return 0.5 * std::hypot(width + 2.0 * margin_px, height + 2.0 * margin_px) * pixel_pitch_mm;
    }
};

}  // namespace lensproof::render
