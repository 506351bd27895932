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
            Edge edge{.x = std::cos(azimuth), .y = std::sin(azimuth), .centre = std::cos(half)};
            if (polygon->curvature > 0.0) {
                // Through both corners (cos half, ± sin half), with the unit circle's curvature times the stated one.
                const double radius = 1.0 / polygon->curvature;
                edge.centre -= std::sqrt(radius * radius - std::sin(half) * std::sin(half));
                edge.radius_squared = radius * radius;
            }
            edges_.push_back(edge);
        }
    } else if (const auto* textured = std::get_if<TexturedStop>(&shape)) {
        if (!textured->texture) {
            throw InputError(fmt::format("{}: the stop's picture was not read", textured->image));
        }
        texture_ = textured->texture;
    }
}

double StopOpening::Edge::radius() const {
    return radius_squared > 0.0 ? std::sqrt(radius_squared) : kInfinity;
}

double StopMask::half_chord() const {
    return std::sin(std::numbers::pi / static_cast<double>(edges_.size()));
}

std::vector<StopMask::NearEdge> StopMask::edges_near(double x, double y, double width) const {
    std::vector<NearEdge> edges;
    if (texture_) {
        return edges;
    }
    if (edges_.empty()) {
        const double r = std::hypot(x, y);
        if (r > 0.0 && 1.0 - r < width) {
            edges.push_back({1.0 - r, {x / r, y / r}, 1.0});
        }
        return edges;
    }
    for (const Edge& edge : edges_) {
        const double across = edge.x * y - edge.y * x;
        const double along = edge.x * x + edge.y * y - edge.centre;
        if (!(edge.radius_squared > 0.0)) {
            if (-along < width && std::abs(across) <= half_chord()) {
                edges.push_back({-along, {edge.x, edge.y}, kInfinity});
            }
            continue;
        }
        const double from_centre = std::hypot(along, across);
        if (edge.radius() - from_centre < width && along > 0.0 &&
            std::abs(across) * edge.radius() <= half_chord() * from_centre) {
            const Vec2d outward{(edge.x * along - edge.y * across) / from_centre,
                                (edge.y * along + edge.x * across) / from_centre};
            edges.push_back({edge.radius() - from_centre, outward, edge.radius()});
        }
    }
    return edges;
}

StopMask::EdgePoint StopMask::edge_at(double share) const {
    if (edges_.empty()) {
        const Vec2d outward{std::cos(2.0 * std::numbers::pi * share), std::sin(2.0 * std::numbers::pi * share)};
        return {outward, outward};
    }
    const double at = share * static_cast<double>(edges_.size());
    const std::size_t index = std::min(edges_.size() - 1, static_cast<std::size_t>(at));
    const double along_edge = 2.0 * (at - static_cast<double>(index)) - 1.0;
    const Edge& edge = edges_[index];
    const auto turned = [&](double along, double across) {
        return Vec2d{edge.x * along - edge.y * across, edge.y * along + edge.x * across};
    };
    if (!(edge.radius_squared > 0.0)) {
        return {turned(edge.centre, along_edge * half_chord()), {edge.x, edge.y}};
    }
    const double angle = along_edge * std::asin(half_chord() / edge.radius());
    const double across = std::sin(angle);
    return {turned(edge.centre + edge.radius() * std::cos(angle), edge.radius() * across),
            turned(std::cos(angle), across)};
}

double StopMask::edge_length() const {
    if (edges_.empty()) {
        return kInfinity;
    }
    const Edge& any = edges_.front();  // they are alike
    const double h = half_chord();
    return any.radius_squared > 0.0 ? 2.0 * any.radius() * std::asin(h / any.radius()) : 2.0 * h;
}

double StopMask::perimeter() const {
    return edges_.empty() ? 2.0 * std::numbers::pi : static_cast<double>(edges_.size()) * edge_length();
}

double StopMask::area() const {
    double area = edges_.empty() ? std::numbers::pi : 0.0;
    for (const Edge& edge : edges_) {
        const double h = half_chord();
        area += h * std::sqrt(1.0 - h * h);  // the triangle from the middle
        if (edge.radius_squared > 0.0) {
            const double half = std::asin(h / edge.radius());
            area += edge.radius_squared * (half - 0.5 * std::sin(2.0 * half));  // the segment beyond it
        }
    }
    return area;
}

StopOpening StopMask::opening() const {
    StopOpening opening{.edges = edges_, .texture = {}};
    if (texture_) {
        opening.texture = texture_->values;
        opening.texture_columns = texture_->size_x;
        opening.texture_rows = texture_->size_y;
    }
    return opening;
}

void StopMask::append_to(std::string& bytes) const {
    append_bytes(bytes, edges_.size());
    for (const auto& [x, y, centre, radius_squared] : edges_) {
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
