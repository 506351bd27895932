// engine/analysis/ghost_region.h — the part of the front element from which a ghost reaches the sensor.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/analysis/ghost_beam.h"

namespace lensproof::analysis {

/// A square of a grid.
struct GridCell {
    int x;
    int y;
};

/// Cells, to be asked for by everyone who draws one: a column after the other, what it holds in stretches.
class HeldCells {
  public:
    HeldCells() = default;
    explicit HeldCells(std::vector<GridCell> cells);

    [[nodiscard]] bool contains(int x, int y) const {
        const auto column = static_cast<std::size_t>(std::int64_t{x} - first_column_);  // huge before the first
        if (column >= begins_.size() - 1) {
            return false;
        }
        const auto stretches = std::span(stretches_).subspan(begins_[column], begins_[column + 1] - begins_[column]);
        return std::ranges::any_of(stretches, [y](const auto& of) { return of.first <= y && y <= of.second; });
    }

  private:
    std::int64_t first_column_ = 0;
    std::vector<std::uint32_t> begins_ = {0};     // of each column's stretches, and the end of the last
    std::vector<std::pair<int, int>> stretches_;  // first and last
};

/// Squares of a grid over a FrontBeam's square.
struct GhostRegion {
    int across = 1;     // cells along a side of the whole
    double cell = 0.0;  // side, mm
    Vec2d corner;
    std::vector<GridCell> cells;
    HeldCells held;  // the same
    int search_rays = 0;

    static std::uint64_t key(int x, int y) {
        return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32U) | static_cast<std::uint32_t>(y);
    }
    [[nodiscard]] double area() const { return static_cast<double>(cells.size()) * cell * cell; }
    [[nodiscard]] bool contains(Vec2d offset) const {
        return held.contains(static_cast<int>((offset.x - corner.x) / cell),
                             static_cast<int>((offset.y - corner.y) / cell));
    }
};

/// The cells in which rays may land, by the `landing_margins` at their centres. A cell is left out where one margin is
/// so far above 0 that it does not come down to it within the cell, changing half as fast again as between the cell and
/// its neighbours; where a neighbour's ray ends before it has that margin, it may change by 1, too. Once ten cells
/// land, two rules more keep the edges of total reflection out: the same of 1 − limit / r, which is bounded where r
/// grows beyond all limits there, and that where no ray around a cell arrives there is nothing to be found. From 32 ×
/// 32 cells (or more, up to 256 × 256, so that one is half as wide as the entrance pupil) they are divided until
/// `landing_fraction` of their centres land (of a grid in cells of which 0.86 do, four rays in five will), at most ten
/// times. Where nothing is left, all is done again from 128 × 128.
///
/// What may be missed lies where a margin dips by more within a cell of the first grid than its differences to all
/// neighbours tell, or in a part apart from the first ten cells that is smaller than they. `measure_ghost` looks for
/// such light outside the region too.
GhostRegion ghost_region(const GhostScene& scene, const optics::GhostPath& path, double landing_fraction = 0.86);

}  // namespace lensproof::analysis
