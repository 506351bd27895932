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

double StopMask::Arc::radius() const {
    return radius_squared > 0.0 ? std::sqrt(radius_squared) : kInfinity;
}

double StopMask::half_chord() const {
    return std::sin(std::numbers::pi / static_cast<double>(arcs_.size()));
}

std::vector<StopMask::NearEdge> StopMask::edges_near(double x, double y, double width) const {
    std::vector<NearEdge> edges;
    if (texture_) {
        return edges;
    }
    if (arcs_.empty()) {
        const double r = std::hypot(x, y);
        if (r > 0.0 && 1.0 - r < width) {
            edges.push_back({1.0 - r, {x / r, y / r}, 1.0});
        }
        return edges;
    }
    for (const Arc& arc : arcs_) {
        const double across = arc.x * y - arc.y * x;
        const double along = arc.x * x + arc.y * y - arc.centre;
        if (!(arc.radius_squared > 0.0)) {
            if (-along < width && std::abs(across) <= half_chord()) {
                edges.push_back({-along, {arc.x, arc.y}, kInfinity});
            }
            continue;
        }
        const double from_centre = std::hypot(along, across);
        if (arc.radius() - from_centre < width && along > 0.0 &&
            std::abs(across) * arc.radius() <= half_chord() * from_centre) {
            const Vec2d outward{(arc.x * along - arc.y * across) / from_centre,
                                (arc.y * along + arc.x * across) / from_centre};
            edges.push_back({arc.radius() - from_centre, outward, arc.radius()});
        }
    }
    return edges;
}

StopMask::EdgePoint StopMask::edge_at(double share) const {
    if (arcs_.empty()) {
        const Vec2d outward{std::cos(2.0 * std::numbers::pi * share), std::sin(2.0 * std::numbers::pi * share)};
        return {outward, outward};
    }
    const double at = share * static_cast<double>(arcs_.size());
    const std::size_t index = std::min(arcs_.size() - 1, static_cast<std::size_t>(at));
    const double along_edge = 2.0 * (at - static_cast<double>(index)) - 1.0;
    const Arc& arc = arcs_[index];
    const auto turned = [&](double along, double across) {
        return Vec2d{arc.x * along - arc.y * across, arc.y * along + arc.x * across};
    };
    if (!(arc.radius_squared > 0.0)) {
        return {turned(arc.centre, along_edge * half_chord()), {arc.x, arc.y}};
    }
    const double angle = along_edge * std::asin(half_chord() / arc.radius());
    const double across = std::sin(angle);
    return {turned(arc.centre + arc.radius() * std::cos(angle), arc.radius() * across),
            turned(std::cos(angle), across)};
}

double StopMask::edge_length() const {
    if (arcs_.empty()) {
        return kInfinity;
    }
    const Arc& any = arcs_.front();  // they are alike
    const double h = half_chord();
    return any.radius_squared > 0.0 ? 2.0 * any.radius() * std::asin(h / any.radius()) : 2.0 * h;
}

double StopMask::perimeter() const {
    return arcs_.empty() ? 2.0 * std::numbers::pi : static_cast<double>(arcs_.size()) * edge_length();
}

double StopMask::area() const {
    double area = arcs_.empty() ? std::numbers::pi : 0.0;
    for (const Arc& arc : arcs_) {
        const double h = half_chord();
        area += h * std::sqrt(1.0 - h * h);  // the triangle from the middle
        if (arc.radius_squared > 0.0) {
            const double half = std::asin(h / arc.radius());
            area += arc.radius_squared * (half - 0.5 * std::sin(2.0 * half));  // the segment beyond it
        }
    }
    return area;
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
