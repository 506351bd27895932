#include "engine/analysis/ghost_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace lensproof::analysis {

namespace {

constexpr int kFirstGrid = 32;
constexpr int kFinestFirstGrid = 256;  // for fisheyes, whose pupil is a fiftieth of their front
constexpr int kSecondGrid = 128;       // where the first saw nothing
constexpr double kSteeper = 1.5;
constexpr double kUnknown = 1.0;  // a change of margin that is possible where a ray ends before it has one
constexpr int kMostDivisions = 10;
constexpr int kResolved = 10;              // cells that land: then the region is seen, and not only its surroundings
constexpr std::size_t kMostCells = 16000;  // that are divided: a region too ragged for fewer is sampled as it is

using Cells = std::vector<GridCell>;

constexpr std::array<std::array<int, 2>, 8> kNeighbours{
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};

/// r / limit − 1 inside a limit, 1 − limit / r beyond it: finite where light on the verge of total reflection flies
/// off.
double bounded(double margin) {
    return margin > 0.0 ? margin / (1.0 + margin) : margin;
}

enum class Fate { lands, may_land, ends, stays_out };

/// The cells of one size that are looked at, with the margins at their centres.
class Grid {
  public:
    Grid(const GhostScene& scene, const optics::GhostPath& path, const GhostRegion& region, const Cells& cells) {
        std::vector<Vec2d> centres;
        for (const auto& [x, y] : cells) {
            centres.push_back(region.corner + region.cell * Vec2d{x + 0.5, y + 0.5});
        }
        std::vector<LandingMargins> found = landing_margins(scene, path, centres);
        int landing = 0;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            LandingMargins& margins = found[i];
            landing += margins.arrives && std::ranges::max(margins.margins) <= 0.0 ? 1 : 0;
            at_.emplace(GhostRegion::key(cells[i].x, cells[i].y), std::move(margins));
        }
        is_fine_ = landing >= kResolved;
        for (const GridCell& cell : cells) {
            fates_.emplace(GhostRegion::key(cell.x, cell.y), fate_of(cell));
        }
    }

    [[nodiscard]] bool lands(const GridCell& cell) const {
        return fates_.at(GhostRegion::key(cell.x, cell.y)) == Fate::lands;
    }

    [[nodiscard]] bool stays(const GridCell& cell) const {
        const Fate here = fates_.at(GhostRegion::key(cell.x, cell.y));
        return here == Fate::lands || here == Fate::may_land ||
               (here == Fate::ends &&
                has_neighbour(cell, fates_, [](Fate fate) { return fate == Fate::lands || fate == Fate::may_land; }));
    }

  private:
    template <class Map, class Holds>
    static bool has_neighbour(const GridCell& cell, const Map& map, const Holds& holds) {
        return std::ranges::any_of(kNeighbours, [&](const auto& step) {
            const auto next = map.find(GhostRegion::key(cell.x + step[0], cell.y + step[1]));
            return next != map.end() && holds(next->second);
        });
    }

    [[nodiscard]] Fate fate_of(const GridCell& cell) const {
        const LandingMargins& here = at_.at(GhostRegion::key(cell.x, cell.y));
        std::array<const LandingMargins*, 4> beside{};
        for (std::size_t i = 0; i < beside.size(); ++i) {
            const auto found = at_.find(GhostRegion::key(cell.x + kNeighbours[i][0], cell.y + kNeighbours[i][1]));
            beside[i] = found == at_.end() ? nullptr : &found->second;
        }
        bool is_inside = true;
        for (std::size_t k = 0; k < here.margins.size(); ++k) {
            if (here.margins[k] <= 0.0) {
                continue;
            }
            is_inside = false;
            // From the centre to a corner is half a cell along both axes.
            double steepest = 0.0;
            double bounded_steepest = 0.0;
            bool is_known = false;
            for (const LandingMargins* other : beside) {
                if (other != nullptr && other->margins.size() <= k && !is_fine_) {
                    steepest = std::max(steepest, kUnknown);
                } else if (other != nullptr && other->margins.size() > k) {
                    steepest = std::max(steepest, std::abs(here.margins[k] - other->margins[k]));
                    bounded_steepest =
                        std::max(bounded_steepest, std::abs(bounded(here.margins[k]) - bounded(other->margins[k])));
                    is_known = true;
                }
            }
            if (is_fine_ && is_known && bounded(here.margins[k]) > kSteeper * bounded_steepest) {
                return Fate::stays_out;
            }
            if (is_known && here.margins[k] > kSteeper * steepest) {
                return Fate::stays_out;
            }
        }
        if (is_inside) {
            return here.arrives ? Fate::lands : Fate::ends;
        }
        // Where rays end all around, the edge of a rim that they end behind does not matter.
        const bool arrives =
            here.arrives || has_neighbour(cell, at_, [](const LandingMargins& beside_it) { return beside_it.arrives; });
        return arrives ? Fate::may_land : Fate::stays_out;
    }

    bool is_fine_ = false;
    std::unordered_map<std::uint64_t, LandingMargins> at_;
    std::unordered_map<std::uint64_t, Fate> fates_;
};

Cells divided(const Cells& cells) {
    Cells parts;
    for (const auto& [x, y] : cells) {
        for (const auto& [dx, dy] : {std::array{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
            parts.push_back({2 * x + dx, 2 * y + dy});
        }
    }
    return parts;
}

GhostRegion region_from(const GhostScene& scene, const optics::GhostPath& path, double landing_fraction, int first) {
    GhostRegion region{
        .across = first, .cell = scene.beam.side() / first, .corner = scene.beam.corner(), .cells = {}, .held = {}};
    Cells cells;
    for (int i = 0; i < first * first; ++i) {
        cells.push_back({i % first, i / first});
    }
    for (int division = 0;; ++division) {
        const Grid grid(scene, path, region, cells);
        region.search_rays += static_cast<int>(cells.size());
        region.cells.clear();
        std::size_t landing = 0;
        for (const GridCell& cell : cells) {
            if (grid.stays(cell)) {
                region.cells.push_back(cell);
                landing += grid.lands(cell) ? 1 : 0;
            }
        }
        const bool enough = static_cast<double>(landing) >= landing_fraction * static_cast<double>(region.cells.size());
        if (enough || division == kMostDivisions || region.cells.size() > kMostCells) {
            break;
        }
        cells = divided(region.cells);
        region.across *= 2;
        region.cell *= 0.5;
    }
    region.held = HeldCells(region.cells);
    return region;
}

}  // namespace

HeldCells::HeldCells(std::vector<GridCell> cells) {
    std::ranges::sort(cells, {}, [](const GridCell& cell) { return std::pair(cell.x, cell.y); });
    begins_.clear();
    first_column_ = cells.empty() ? 0 : cells.front().x;
    for (const auto& [x, y] : cells) {
        const auto column = static_cast<std::size_t>(x - first_column_);
        const bool goes_on = begins_.size() == column + 1 && stretches_.back().second == y - 1;
        begins_.resize(column + 1, static_cast<std::uint32_t>(stretches_.size()));
        if (goes_on) {
            stretches_.back().second = y;
        } else {
            stretches_.emplace_back(y, y);
        }
    }
    begins_.push_back(static_cast<std::uint32_t>(stretches_.size()));
}

GhostRegion ghost_region(const GhostScene& scene, const optics::GhostPath& path, double landing_fraction) {
    int first = kFirstGrid;
    while (first < kFinestFirstGrid && scene.beam.side() / first > 0.5 * std::sqrt(scene.pupil_area)) {
        first *= 2;
    }
    GhostRegion region = region_from(scene, path, landing_fraction, first);
    if (region.cells.empty() && first < kSecondGrid) {
        const int searched = region.search_rays;
        region = region_from(scene, path, landing_fraction, kSecondGrid);
        region.search_rays += searched;
    }
    return region;
}

}  // namespace lensproof::analysis
