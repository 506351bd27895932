#include "calibration/sharpness/chart_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <variant>

#include "engine/base/angle.h"

namespace lensproof::calibration {
namespace {

constexpr double kLengthFraction = 0.7;  // of a side: corners stay outside, also where perspective shears the square
constexpr double kDepthFraction = 0.4;   // of a square, on either side of its edge
constexpr double kGapFraction = 0.8;     // of the white up to the next dark thing
constexpr double kLeastHalfLength_px = 8.0;
constexpr double kLeastHalfWidth_px = 4.0;
constexpr double kMostHalfLength_px = 48.0;
constexpr double kMostHalfWidth_px = 24.0;

// The chart's neighbourhood of a point: image = at + x_axis · x_mm + y_axis · y_mm.
struct LocalMap {
    Vec2d at;
    Vec2d x_axis;
    Vec2d y_axis;

    [[nodiscard]] Vec2d direction(const Vec2d& mm) const {
        return {x_axis.x * mm.x + y_axis.x * mm.y, x_axis.y * mm.x + y_axis.y * mm.y};
    }
};

// The edge through `middle` (mm from the map's point) along `along`, the tones reaching `depth_mm` across.
std::optional<EdgeRegion> region(const LocalMap& map, const Vec2d& middle, const Vec2d& along, double half_length_mm,
                                 double depth_mm) {
    const Vec2d offset = map.direction(middle);
    const Vec2d side = map.direction(along);
    const double length = std::hypot(side.x, side.y);
    const Vec2d across = map.direction({-along.y, along.x});
    if (!(length > 0.0)) {
        return std::nullopt;
    }
    const double depth = std::abs(side.x * across.y - side.y * across.x) / length;  // px per mm, at right angles
    EdgeRegion result{.centre_px = {map.at.x + offset.x, map.at.y + offset.y},
                      .along = {side.x / length, side.y / length},
                      .half_length_px = std::min(kLengthFraction * half_length_mm * length, kMostHalfLength_px),
                      .half_width_px = std::min(depth_mm * depth, kMostHalfWidth_px)};
    const bool is_large = result.half_length_px >= kLeastHalfLength_px && result.half_width_px >= kLeastHalfWidth_px;
    return is_large ? std::optional(result) : std::nullopt;
}

// A point of the chart's grid, with what its neighbours say about the map there.
class Grid {
  public:
    Grid(const ChartPoints& points, const scene::ChartTraits& chart)
        : points_(points), size_(chart.points), pitch_mm_(chart.pitch_mm) {}

    [[nodiscard]] scene::GridSize size() const { return size_; }
    [[nodiscard]] double pitch_mm() const { return pitch_mm_; }
    [[nodiscard]] const Vec2d* at(int column, int row) const {
        if (column < 0 || row < 0 || column >= size_.columns || row >= size_.rows) {
            return nullptr;
        }
        const std::size_t i = static_cast<std::size_t>(row) * size_.columns + column;
        return points_.found[i] ? &points_.image_px[i] : nullptr;
    }
    [[nodiscard]] std::optional<LocalMap> map(int column, int row) const {
        const Vec2d* here = at(column, row);
        const auto x_axis = axis(column, row, 1, 0);
        const auto y_axis = axis(column, row, 0, 1);
        return here != nullptr && x_axis && y_axis ? std::optional(LocalMap{*here, *x_axis, *y_axis}) : std::nullopt;
    }

  private:
    // Pixels per mm along a row or a column: between both neighbours, or to the one there is.
    [[nodiscard]] std::optional<Vec2d> axis(int column, int row, int right, int down) const {
        const Vec2d* here = at(column, row);
        const Vec2d* before = at(column - right, row - down);
        const Vec2d* after = at(column + right, row + down);
        const Vec2d* from = before != nullptr ? before : here;
        const Vec2d* to = after != nullptr ? after : here;
        if (from == nullptr || to == nullptr || from == to) {
            return std::nullopt;
        }
        const double mm = pitch_mm_ * (before != nullptr && after != nullptr ? 2.0 : 1.0);
        return Vec2d{(to->x - from->x) / mm, (to->y - from->y) / mm};
    }

    const ChartPoints& points_;
    scene::GridSize size_;
    double pitch_mm_;
};

std::vector<EdgeRegion> regions_of(const scene::SquareSides& sides, const Grid& grid) {
    const double angle = radians(sides.angle_deg);
    const double half = 0.5 * sides.side_mm;
    const double gap = grid.pitch_mm() - sides.side_mm * (std::abs(std::cos(angle)) + std::abs(std::sin(angle)));
    const double depth = std::min(kDepthFraction * sides.side_mm, kGapFraction * gap);
    std::vector<EdgeRegion> regions;
    for (int row = 0; row < grid.size().rows; ++row) {
        for (int column = 0; column < grid.size().columns; ++column) {
            const auto map = grid.map(column, row);
            for (int side = 0; side < 4 && map; ++side) {
                const double turn = angle + 0.5 * std::numbers::pi * side;
                const Vec2d outwards{std::cos(turn), std::sin(turn)};
                if (const auto edge =
                        region(*map, {half * outwards.x, half * outwards.y}, {-outwards.y, outwards.x}, half, depth)) {
                    regions.push_back(*edge);
                }
            }
        }
    }
    return regions;
}

std::vector<EdgeRegion> regions_of(const scene::CellSides& sides, const Grid& grid) {
    const double square = grid.pitch_mm();
    const double depth = std::min(kDepthFraction * square, kGapFraction * sides.even_mm);
    std::vector<EdgeRegion> regions;
    for (int row = 0; row < grid.size().rows; ++row) {
        for (int column = 0; column < grid.size().columns; ++column) {
            const auto map = grid.map(column, row);
            for (const bool to_the_right : {true, false}) {
                const Vec2d* end = to_the_right ? grid.at(column + 1, row) : grid.at(column, row + 1);
                if (!map || end == nullptr) {
                    continue;
                }
                LocalMap side = *map;  // exactly through both corners
                // By a reference: under its sanitizers GCC 12 leaves out an assignment to (a ? b : c) itself.
                Vec2d& axis = to_the_right ? side.x_axis : side.y_axis;
                axis = Vec2d{(end->x - side.at.x) / square, (end->y - side.at.y) / square};
                const Vec2d along = to_the_right ? Vec2d{1.0, 0.0} : Vec2d{0.0, 1.0};
                if (const auto edge =
                        region(side, {0.5 * square * along.x, 0.5 * square * along.y}, along, 0.5 * square, depth)) {
                    regions.push_back(*edge);
                }
            }
        }
    }
    return regions;
}

std::vector<EdgeRegion> regions_of(const scene::NoEdges&, const Grid&) {
    return {};
}

}  // namespace

std::vector<EdgeRegion> chart_edges(const ChartPoints& points, const scene::Chart& chart) {
    const scene::ChartTraits known = scene::traits(chart);
    const Grid grid(points, known);
    return std::visit([&](const auto& edges) { return regions_of(edges, grid); }, known.edges);
}

}  // namespace lensproof::calibration
