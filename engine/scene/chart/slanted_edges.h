// engine/scene/chart/slanted_edges.h — squares turned a little, whose edges measure resolution (ISO 12233).
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/angle.h"
#include "engine/base/kinds.h"
#include "engine/scene/chart/chart_traits.h"
#include "engine/scene/chart/outline.h"

namespace lensproof::scene {

/// Black squares, each turned by `angle_deg` about its centre (clockwise as one sees the chart).
struct SlantedEdges {
    static constexpr KindNames<> kNames{"slanted-edges"};
    int columns = 0;
    int rows = 0;
    double pitch_mm = 0.0;
    double square_mm = 0.0;
    double angle_deg = 5.0;
};

void visit_keys(SlantedEdges& edges, auto& keys) {
    keys.grid("squares", edges.columns, edges.rows, {.least = 1, .printed = {7, 5}});
    keys.pitch("pitch_mm", edges.pitch_mm, {edges.columns, edges.rows});
    keys.angle("angle_deg", edges.angle_deg, 45.0);
    const double angle = radians(std::abs(edges.angle_deg));
    keys.part("square_mm", edges.square_mm,
              {.of = "what of pitch_mm a turned square may have",
               .most_mm = edges.pitch_mm / (std::cos(angle) + std::sin(angle)),
               .printed_mm = 0.6 * edges.pitch_mm});
}

inline bool is_black(const SlantedEdges& edges, double x_mm, double y_mm) {
    const Cell cell = cell_at({edges.columns, edges.rows}, edges.pitch_mm, x_mm, y_mm);
    const double angle = radians(edges.angle_deg);
    const double c = std::cos(angle) * edges.pitch_mm;
    const double s = std::sin(angle) * edges.pitch_mm;
    return cell.is_on_grid && is_in_square(c * cell.x + s * cell.y, c * cell.y - s * cell.x, edges.square_mm);
}

inline ChartTraits traits(const SlantedEdges& edges) {
    return {.points = {edges.columns, edges.rows},
            .pitch_mm = edges.pitch_mm,
            .size_mm = {edges.columns * edges.pitch_mm, edges.rows * edges.pitch_mm},
            .look = Spots{.name = "squares",
                          .radius_pitches = edges.square_mm / (std::numbers::sqrt2 * edges.pitch_mm),
                          .moment_diameter_mm = 2.0 / std::numbers::sqrt3 * edges.square_mm},
            .edges = SquareSides{.side_mm = edges.square_mm, .angle_deg = edges.angle_deg},
            .narrowest_mm = std::min(edges.square_mm, edges.pitch_mm - std::numbers::sqrt2 * edges.square_mm)};
}

inline Outline outline(const SlantedEdges& edges) {
    Outline outline;
    const double angle = radians(edges.angle_deg);
    for (const Vec2d& centre : cell_middles({edges.columns, edges.rows}, edges.pitch_mm)) {
        outline.push_back(rectangle(centre, {std::cos(angle), std::sin(angle)}, edges.square_mm, edges.square_mm));
    }
    return outline;
}

}  // namespace lensproof::scene
