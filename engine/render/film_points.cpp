#include "engine/render/film_points.h"

#include <algorithm>

namespace lensproof::render {

void draw_from_filter(const PixelFilter& filter, const Sensor& sensor, PathStarts& starts,
                      PathColumn<double>& weights) {
    if (filter.is_box()) {
        std::fill_n(weights.begin(), starts.size, 1.0);
        return;
    }
    const auto width = static_cast<std::uint32_t>(sensor.width);
    for (std::size_t i = 0; i < static_cast<std::size_t>(starts.size); ++i) {
        const std::uint32_t row = starts.pixel[i] / width;
        const std::uint32_t column = starts.pixel[i] - row * width;
        const Vec2d centre = sensor.position(column, row);
        const PixelFilter::Draw across = filter.draw((centre.x - starts.film_x[i]) / sensor.pixel_pitch_mm + 0.5);
        const PixelFilter::Draw down = filter.draw((starts.film_y[i] - centre.y) / sensor.pixel_pitch_mm + 0.5);
        const Vec2d drawn = sensor.position(column + across.offset_px, row + down.offset_px);
        starts.film_x[i] = drawn.x;
        starts.film_y[i] = drawn.y;
        weights[i] = across.weight * down.weight;
    }
}

}  // namespace lensproof::render
