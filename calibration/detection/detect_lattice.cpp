#include "calibration/detection/detect_lattice.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibration/detection/blob_lattice.h"

namespace lensproof::calibration {
namespace {

constexpr double kLeastFractionSeen = 0.25;  // of the chart's points that have to be seen
constexpr double kInWindow = 0.9;            // of the spots found that have to fit into the chart
constexpr double kLineDarkness = 0.8;        // grey level of a line at most, of the ground's
constexpr double kCrossingBlur_px = 1.5;
constexpr double kCrossingReach = 0.15;  // of a step, around where the cells put a crossing

scene::GridSize size_of(const std::vector<LatticeSpot>& spots) {
    scene::GridSize size;
    for (const LatticeSpot& spot : spots) {
        size = {std::max(size.columns, spot.column + 1), std::max(size.rows, spot.row + 1)};
    }
    return size;
}

std::string in_words(scene::GridSize size) {
    return std::to_string(size.columns) + " × " + std::to_string(size.rows);
}

/// The lattice as a chart that was turned by a quarter turn numbers it.
std::vector<LatticeSpot> turned_lattice(std::vector<LatticeSpot> spots) {
    const int columns = size_of(spots).columns;
    for (LatticeSpot& spot : spots) {
        spot = {spot.row, columns - 1 - spot.column, spot.middle};
    }
    return spots;
}

/// Where the chart's first column (or row) stands in a lattice, were it as long as `seen`.
std::pair<int, int> offsets(int chart, int seen) {
    return seen <= chart ? std::pair(-(chart - seen) / 2, -(chart - seen) / 2) : std::pair(0, seen - chart);
}

struct Placing {
    std::size_t inside = 0;
    int column = 0;
    int row = 0;
};

bool is_within(const LatticeSpot& spot, const Placing& placing, scene::GridSize grid) {
    return spot.column >= placing.column && spot.column < placing.column + grid.columns && spot.row >= placing.row &&
           spot.row < placing.row + grid.rows;
}

/// The chart's place in the lattice that holds most of the spots.
Placing best_placing(const std::vector<LatticeSpot>& spots, scene::GridSize grid) {
    const scene::GridSize seen = size_of(spots);
    const auto [first_column, last_column] = offsets(grid.columns, seen.columns);
    const auto [first_row, last_row] = offsets(grid.rows, seen.rows);
    Placing best;
    for (int row = first_row; row <= last_row; ++row) {
        for (int column = first_column; column <= last_column; ++column) {
            Placing placing{.column = column, .row = row};
            placing.inside = static_cast<std::size_t>(std::count_if(
                spots.begin(), spots.end(), [&](const LatticeSpot& spot) { return is_within(spot, placing, grid); }));
            if (placing.inside > best.inside) {
                best = placing;
            }
        }
    }
    return best;
}

struct Dark {
    double level = 255.0;
    cv::Point2f place;
};

Dark darkest_near(const cv::Mat& picture, cv::Point2f place, int reach_px) {
    const cv::Rect around(cvRound(place.x) - reach_px, cvRound(place.y) - reach_px, 2 * reach_px + 1, 2 * reach_px + 1);
    const cv::Rect seen = around & cv::Rect(0, 0, picture.cols, picture.rows);
    Dark darkest{.level = 255.0, .place = place};
    if (!seen.empty()) {
        cv::Point at;
        cv::minMaxLoc(picture(seen), &darkest.level, nullptr, &at);
        darkest.place = cv::Point2f(at + seen.tl());
    }
    return darkest;
}

double darkest_near(const cv::Mat& picture, cv::Point2f place) {
    return darkest_near(picture, place, 2).level;
}

using Middles = std::map<std::pair<int, int>, cv::Point2f>;

/// From a cell to the next by its neighbours.
cv::Point2f step_at(const Middles& middles, const LatticeSpot& cell, int dc, int dr) {
    const auto after = middles.find({cell.column + dc, cell.row + dr});
    const auto before = middles.find({cell.column - dc, cell.row - dr});
    const bool has_after = after != middles.end();
    const bool has_before = before != middles.end();
    const cv::Point2f difference =
        (has_after ? after->second : cell.middle) - (has_before ? before->second : cell.middle);
    return difference * (has_after && has_before ? 0.5F : 1.0F);
}

/// Row and column of a crossing, and where it is.
using Crossings = std::map<std::pair<int, int>, cv::Point2f>;

/// Adds what is missing within the rows and columns that there are, as a cell at the chart's corner easily is: a row or
/// a column, followed by one step, and a dark place there.
void fill_gaps(const cv::Mat& smooth, Crossings& crossings) {
    std::pair<int, int> most{std::numeric_limits<int>::min(), std::numeric_limits<int>::min()};
    std::pair<int, int> least{std::numeric_limits<int>::max(), std::numeric_limits<int>::max()};
    for (const auto& [place, at] : crossings) {
        least = {std::min(least.first, place.first), std::min(least.second, place.second)};
        most = {std::max(most.first, place.first), std::max(most.second, place.second)};
    }
    const auto follow = [&](int row, int column, int dr, int dc) -> std::optional<cv::Point2f> {
        const auto one = crossings.find({row + dr, column + dc});
        const auto two = crossings.find({row + 2 * dr, column + 2 * dc});
        if (one == crossings.end() || two == crossings.end()) {
            return std::nullopt;
        }
        const cv::Point2f step = one->second - two->second;
        const Dark dark =
            darkest_near(smooth, one->second + step, std::max(2, static_cast<int>(kCrossingReach * cv::norm(step))));
        const double ground = darkest_near(smooth, one->second + 0.5F * step + 0.5F * cv::Point2f(-step.y, step.x));
        return dark.level < kLineDarkness * ground ? std::optional(dark.place) : std::nullopt;
    };
    for (int row = least.first; row <= most.first; ++row) {
        for (int column = least.second; column <= most.second; ++column) {
            for (const auto& [dr, dc] : {std::pair{0, 1}, {0, -1}, {1, 0}, {-1, 0}}) {
                if (const auto place = crossings.contains({row, column}) ? std::nullopt : follow(row, column, dr, dc)) {
                    crossings[{row, column}] = *place;
                }
            }
        }
    }
}

/// Counted from 0.
std::vector<LatticeSpot> as_lattice(const Crossings& crossings) {
    std::pair<int, int> least{std::numeric_limits<int>::max(), std::numeric_limits<int>::max()};
    for (const auto& [place, at] : crossings) {
        least = {std::min(least.first, place.first), std::min(least.second, place.second)};
    }
    std::vector<LatticeSpot> spots;
    spots.reserve(crossings.size());
    for (const auto& [place, at] : crossings) {
        spots.push_back({place.second - least.second, place.first - least.first, at});
    }
    return spots;
}

/// Crossings of lines from the white cells between them: the corners of each cell, by the steps to its neighbours.
std::vector<LatticeSpot> crossings_of(const cv::Mat& picture, const std::vector<LatticeSpot>& cells) {
    Middles middles;
    for (const LatticeSpot& cell : cells) {
        middles[{cell.column, cell.row}] = cell.middle;
    }
    // Smoothed, a crossing is darker than the lines that lead to it.
    cv::Mat smooth;
    cv::GaussianBlur(picture, smooth, {}, kCrossingBlur_px);
    std::map<std::pair<int, int>, std::vector<cv::Point2f>> corners;
    for (const LatticeSpot& cell : cells) {
        const cv::Point2f along_row = step_at(middles, cell, 1, 0);
        const cv::Point2f along_column = step_at(middles, cell, 0, 1);
        for (const int i : {0, 1}) {
            for (const int j : {0, 1}) {
                const cv::Point2f corner = cell.middle + (static_cast<float>(i) - 0.5F) * along_row +
                                           (static_cast<float>(j) - 0.5F) * along_column;
                const double step = std::min(cv::norm(along_row), cv::norm(along_column));
                const int reach = std::max(2, static_cast<int>(kCrossingReach * step));
                const Dark dark = darkest_near(smooth, corner, reach);
                if (dark.level < kLineDarkness * darkest_near(smooth, cell.middle)) {
                    corners[{cell.row + j, cell.column + i}].push_back(dark.place);
                }
            }
        }
    }
    Crossings crossings;
    for (const auto& [place, around] : corners) {
        cv::Point2f sum;
        for (const cv::Point2f& corner : around) {
            sum += corner;
        }
        crossings[place] = sum / static_cast<float>(around.size());
    }
    fill_gaps(smooth, crossings);
    return as_lattice(crossings);
}

/// What of the chart is seen, by the lattice of its points in the picture.
ChartSearch numbered(std::vector<LatticeSpot> spots, scene::GridSize grid, const std::string& name) {
    const auto total = static_cast<std::size_t>(grid.columns) * grid.rows;
    const std::string wanted = in_words(grid) + " " + name;
    if (spots.size() < kFewestSpots) {
        return {.reason = "no grid of " + wanted + " found"};
    }
    Placing placing = best_placing(spots, grid);
    std::vector<LatticeSpot> other = turned_lattice(spots);
    const Placing other_placing = best_placing(other, grid);
    if (other_placing.inside > placing.inside) {
        spots = std::move(other);
        placing = other_placing;
    }
    if (static_cast<double>(placing.inside) < kInWindow * static_cast<double>(spots.size())) {
        return {.reason = "a grid of " + in_words(size_of(spots)) + " " + name + " found, more than the " + wanted +
                          " of the chart"};
    }
    if (static_cast<double>(placing.inside) < kLeastFractionSeen * static_cast<double>(total)) {
        return {.reason = "only " + std::to_string(placing.inside) + " of " + wanted + " found in rows and columns"};
    }
    const scene::GridSize seen = size_of(spots);
    const bool is_whole = seen.columns >= grid.columns && seen.rows >= grid.rows;
    ChartSearch result{.points = std::vector<cv::Point2f>(total),
                       .found = std::vector<bool>(total, false),
                       .reason = {},
                       .numbering = !is_whole                   ? Numbering::whole_pitches
                                    : grid.columns == grid.rows ? Numbering::quarter_turn
                                                                : Numbering::half_turn};
    for (const LatticeSpot& spot : spots) {
        if (is_within(spot, placing, grid)) {
            const std::size_t i =
                static_cast<std::size_t>(spot.row - placing.row) * grid.columns + (spot.column - placing.column);
            result.points[i] = spot.middle;
            result.found[i] = true;
        }
    }
    return result;
}

}  // namespace

ChartSearch find_lattice(const cv::Mat& picture, scene::GridSize grid, const scene::Spots& spots) {
    return numbered(find_blob_lattice(picture, !spots.is_bright, true), grid, spots.name);
}

ChartSearch find_lattice(const cv::Mat& picture, scene::GridSize grid, const scene::LineCrossings& /*any width*/) {
    return numbered(crossings_of(picture, find_blob_lattice(picture, false, false)), grid, "crossings of lines");
}

}  // namespace lensproof::calibration
