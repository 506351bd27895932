// engine/render/film/sensor.h — where the pixels of a sensor lie behind a lens.
#pragma once
#include <cmath>
#include <cstdint>

#include "engine/base/vec.h"

namespace lensproof::render {

/// The sensor behind a lens: square pixels. The picture is turned upright, as a camera does it: pixel (u, v) lies at
/// x = −(u − axis.x) pitch, y = (v − axis.y) pitch in lens space.
struct Sensor {
    int width = 0;
    int height = 0;
    double pixel_pitch_mm = 0.0;
    Vec2d axis_from_middle_px{};  // where the axis meets it, to the right and down

    /// The pixel coordinates of that place.
    [[nodiscard]] constexpr Vec2d axis() const {
        return {0.5 * (width - 1) + axis_from_middle_px.x, 0.5 * (height - 1) + axis_from_middle_px.y};
    }
    [[nodiscard]] constexpr Vec2d position(double u, double v) const { return position<double>({u, v}); }
    template <class T>
    [[nodiscard]] constexpr Vec2<T> position(const Vec2<T>& pixel) const {
        return {-(pixel.x - T(axis().x)) * T(pixel_pitch_mm), (pixel.y - T(axis().y)) * T(pixel_pitch_mm)};
    }
    /// The pixel coordinates of a point, on the sensor or beyond it: `position` undone.
    template <class T = double>
    [[nodiscard]] constexpr Vec2<T> pixel(const Vec2<T>& position) const {
        return {T(axis().x) - position.x / T(pixel_pitch_mm), position.y / T(pixel_pitch_mm) + T(axis().y)};
    }
    /// From the axis to the farthest point of it; or of what lies up to `margin_px` around it.
    [[nodiscard]] double half_diagonal_mm(double margin_px = 0.0) const {
        return std::hypot(0.5 * width + margin_px + std::abs(axis_from_middle_px.x),
                          0.5 * height + margin_px + std::abs(axis_from_middle_px.y)) *
               pixel_pitch_mm;
    }
};

}  // namespace lensproof::render
