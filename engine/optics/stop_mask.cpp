#include "engine/optics/stop_mask.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>
#include <numeric>

#include "engine/base/angle.h"
#include "engine/base/bytes.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"

namespace lensproof::optics {

namespace {

/// As `StopMask::edges_near`.
std::vector<StopMask::NearEdge> pieces_near(const std::vector<EdgePiece>& pieces, const Vec2d& point, double width) {
    std::vector<StopMask::NearEdge> edges;
    for (const EdgePiece& piece : pieces) {
        const double side = piece.piece_length();
        const double fraction = dot(point - piece.from, piece.to - piece.from) / (side * side);
        if (!(fraction >= 0.0 && fraction < 1.0)) {
            continue;
        }
        const Vec2d outward = piece.outward(fraction);
        const double distance = dot(piece.from + fraction * (piece.to - piece.from) - point, outward);
        if (distance >= 0.0 && distance < width) {
            const double turn = cross(piece.outward_from, piece.outward_to);
            edges.push_back({.distance = distance,
                             .outward = outward,
                             .radius = turn != 0.0 ? side / turn : kInfinity,
                             .length = piece.edge_length});
        }
    }
    return edges;
}

}  // namespace

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

StopMask StopMask::with_edges() const {
    StopMask mask = *this;
    if (texture_) {
        if (auto pieces = texture_edges(*texture_)) {
            mask.pieces_ = std::make_shared<const std::vector<EdgePiece>>(*std::move(pieces));
        }
    }
    return mask;
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
        return pieces_ ? pieces_near(*pieces_, {x, y}, width) : edges;
    }
    if (edges_.empty()) {
        const double r = std::hypot(x, y);
        if (r > 0.0 && 1.0 - r < width) {
            edges.push_back({1.0 - r, {x / r, y / r}, 1.0, kInfinity});
        }
        return edges;
    }
    for (const Edge& edge : edges_) {
        const double across = edge.x * y - edge.y * x;
        const double along = edge.x * x + edge.y * y - edge.centre;
        if (!(edge.radius_squared > 0.0)) {
            if (-along < width && std::abs(across) <= half_chord()) {
                edges.push_back({-along, {edge.x, edge.y}, kInfinity, edge_length()});
            }
            continue;
        }
        const double from_centre = std::hypot(along, across);
        if (edge.radius() - from_centre < width && along > 0.0 &&
            std::abs(across) * edge.radius() <= half_chord() * from_centre) {
            const Vec2d outward{(edge.x * along - edge.y * across) / from_centre,
                                (edge.y * along + edge.x * across) / from_centre};
            edges.push_back({edge.radius() - from_centre, outward, edge.radius(), edge_length()});
        }
    }
    return edges;
}

StopMask::EdgePoint StopMask::edge_at(double fraction) const {
    if (pieces_) {
        const double along = fraction * perimeter();
        const auto after = std::ranges::upper_bound(*pieces_, along, {}, &EdgePiece::before);
        const EdgePiece& piece = *std::prev(after);
        const double part = std::min((along - piece.before) / piece.piece_length(), 1.0);
        return {piece.from + part * (piece.to - piece.from), piece.outward(part), piece.edge_length};
    }
    if (edges_.empty()) {
        const Vec2d outward{std::cos(2.0 * std::numbers::pi * fraction), std::sin(2.0 * std::numbers::pi * fraction)};
        return {outward, outward, kInfinity};
    }
    const double at = fraction * static_cast<double>(edges_.size());
    const std::size_t index = std::min(edges_.size() - 1, static_cast<std::size_t>(at));
    const double asideedge = 2.0 * (at - static_cast<double>(index)) - 1.0;
    const Edge& edge = edges_[index];
    const auto turned = [&](double along, double across) {
        return Vec2d{edge.x * along - edge.y * across, edge.y * along + edge.x * across};
    };
    if (!(edge.radius_squared > 0.0)) {
        return {turned(edge.centre, asideedge * half_chord()), {edge.x, edge.y}, edge_length()};
    }
    const double angle = asideedge * std::asin(half_chord() / edge.radius());
    const double across = std::sin(angle);
    return {turned(edge.centre + edge.radius() * std::cos(angle), edge.radius() * across),
            turned(std::cos(angle), across), edge_length()};
}

double StopMask::edge_length() const {
    const Edge& any = edges_.front();  // they are alike
    const double h = half_chord();
    return any.radius_squared > 0.0 ? 2.0 * any.radius() * std::asin(h / any.radius()) : 2.0 * h;
}

double StopMask::perimeter() const {
    if (pieces_) {
        return pieces_->back().before + pieces_->back().piece_length();
    }
    return edges_.empty() ? 2.0 * std::numbers::pi : static_cast<double>(edges_.size()) * edge_length();
}

double StopMask::area() const {
    if (pieces_) {
        return std::accumulate(pieces_->begin(), pieces_->end(), 0.0, [](double sum, const EdgePiece& piece) {
            return sum + 0.5 * cross(piece.from, piece.to);  // the bright is on their left
        });
    }
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
