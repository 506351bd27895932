#include "engine/optics/stop_mask.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/angle.h"
#include "engine/base/bytes.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"

namespace lensproof::optics {

StopMask::StopMask(const StopShape& shape) {
    if (const auto* polygon = std::get_if<PolygonStop>(&shape)) {
        const double half = std::numbers::pi / polygon->blades;
        const double rotation = radians(polygon->rotation_deg);
        for (int i = 0; i < polygon->blades; ++i) {
            const double azimuth = rotation + (2 * i + 1) * half;
            Arc arc{.x = std::cos(azimuth), .y = std::sin(azimuth), .centre = std::cos(half)};
            if (polygon->curvature > 0.0) {
                // Through both corners (cos half, ± sin half), with the unit circle's curvature times the stated one.
                const double radius = 1.0 / polygon->curvature;
                arc.centre -= std::sqrt(radius * radius - std::sin(half) * std::sin(half));
                arc.radius_squared = radius * radius;
            }
            arcs_.push_back(arc);
        }
    } else if (const auto* textured = std::get_if<TexturedStop>(&shape)) {
        if (!textured->texture) {
            throw InputError(fmt::format("{}: the stop's picture was not read", textured->image));
        }
        texture_ = textured->texture;
    }
}

double StopMask::Arc::margin(double at_x, double at_y) const {
    const double along = x * at_x + y * at_y - centre;
    const double across = x * at_y - y * at_x;
    return radius_squared > 0.0 ? along * along + across * across - radius_squared : along;
}

StopMask::EdgeMargin StopMask::edge_margin(double x, double y) const {
    if (texture_) {
        return {transmittance(x, y) > 0.0 ? -1.0 : kInfinity, 0};
    }
    EdgeMargin worst;
    for (std::size_t i = 0; i < arcs_.size(); ++i) {
        const double margin = arcs_[i].margin(x, y);
        if (i == 0 || margin > worst.margin) {
            worst = {margin, static_cast<int>(i)};
        }
    }
    return worst;
}

double StopMask::transmittance(double x, double y) const {
    const auto is_inside = [&](const Arc& arc) { return arc.margin(x, y) <= 0.0; };
    if (!std::ranges::all_of(arcs_, is_inside)) {
        return 0.0;
    }
    if (!texture_) {
        return 1.0;
    }
    const auto cell = [](double position, int size) {
        return std::clamp(static_cast<int>(0.5 * (position + 1.0) * size), 0, size - 1);
    };
    const int column = cell(x, texture_->size_x);
    const int row = cell(-y, texture_->size_y);
    return texture_->values[static_cast<std::size_t>(row) * texture_->size_x + column];
}

void StopMask::append_to(std::string& bytes) const {
    append_bytes(bytes, arcs_.size());
    for (const auto& [x, y, centre, radius_squared] : arcs_) {
        append_bytes(bytes, x, y, centre, radius_squared);
    }
    append_bytes(bytes, texture_ != nullptr);
    if (texture_) {
        append_bytes(bytes, texture_->size_x, texture_->size_y);
        for (const float value : texture_->values) {
            append_bytes(bytes, value);
        }
    }
}

}  // namespace lensproof::optics
