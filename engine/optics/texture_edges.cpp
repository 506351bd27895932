#include "engine/optics/texture_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"

namespace lensproof::optics {

namespace {

constexpr double kHalf = 0.5;
constexpr double kTolerance = 0.6;  // of polygons, texels
const double kSharp = std::cos(radians(25.0));

/// A texture on the lattice of its texels' middles. Points are from the middle of the stop, y upwards, in texels of the
/// side that has fewer.
class Lattice {
  public:
    explicit Lattice(const ApertureTexture& texture)
        : texture_(texture), semi_diameter_(0.5 * std::min(texture.size_x, texture.size_y)) {}

    [[nodiscard]] int columns() const { return texture_.size_x; }
    [[nodiscard]] int rows() const { return texture_.size_y; }

    /// Dark from −1 and from `columns` or `rows` on; between them the circle cuts texels off.
    [[nodiscard]] double brightness(int column, int row) const {
        if (column < 0 || row < 0 || column >= columns() || row >= rows()) {
            return 0.0;
        }
        const Vec2d point = at(column, row);
        const double texels_inside =
            dot(point, point) < (semi_diameter_ - 1.0) * (semi_diameter_ - 1.0) ? 1.0 : semi_diameter_ - length(point);
        const auto place = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns());
        return std::clamp(texels_inside + kHalf, 0.0, 1.0) * texture_.values[place + static_cast<std::size_t>(column)];
    }
    [[nodiscard]] Vec2d at(int column, int row) const {
        return semi_diameter_ * Vec2d{2.0 * (column + 0.5) / columns() - 1.0, 1.0 - 2.0 * (row + 0.5) / rows()};
    }
    /// Of the texel that holds a point.
    [[nodiscard]] double brightness_at(const Vec2d& point) const {
        const Vec2d unit = (1.0 / semi_diameter_) * point;
        return brightness(static_cast<int>(std::floor(0.5 * (unit.x + 1.0) * columns())),
                          static_cast<int>(std::floor(0.5 * (1.0 - unit.y) * rows())));
    }
    [[nodiscard]] double semi_diameter() const { return semi_diameter_; }

  private:
    const ApertureTexture& texture_;
    double semi_diameter_;
};

using Contour = std::vector<Vec2d>;

/// Crossings of half brightness between neighbours of the lattice, each with the next one along its contour, which has
/// the bright on its left.
class Crossings {
  public:
    explicit Crossings(const Lattice& lattice) : lattice_(lattice) {
        for (int row = -1; row < lattice.rows() && !are_too_many(); ++row) {
            for (int column = -1; column < lattice.columns(); ++column) {
                cross_cell(column, row);
            }
        }
    }

    /// As of noise, which has no edges: not all were then looked for. (Blades of 4096 texels across have 20,000.)
    [[nodiscard]] bool are_too_many() const { return next_.size() > 100'000; }

    [[nodiscard]] std::vector<Contour> contours() {
        std::vector<Contour> found;
        while (!next_.empty()) {
            Contour& contour = found.emplace_back();
            for (auto here = next_.begin(); here != next_.end();) {
                contour.push_back(point(here->first));
                const std::int64_t next = here->second;
                next_.erase(here);
                here = next_.find(next);
            }
        }
        return found;
    }

  private:
    /// Of the way from a lattice point to the one on its right, or below.
    [[nodiscard]] std::int64_t key(int column, int row, bool is_down) const {
        return 2 * (std::int64_t{row + 1} * width() + column + 1) + (is_down ? 1 : 0);
    }
    [[nodiscard]] std::int64_t width() const { return std::int64_t{lattice_.columns()} + 2; }
    [[nodiscard]] Vec2d point(std::int64_t crossing) const {
        const auto column = static_cast<int>(crossing / 2 % width() - 1);
        const auto row = static_cast<int>(crossing / 2 / width() - 1);
        const bool is_down = crossing % 2 != 0;
        const double here = lattice_.brightness(column, row);
        const double there = lattice_.brightness(is_down ? column : column + 1, is_down ? row + 1 : row);
        const double fraction = (kHalf - here) / (there - here);
        const Vec2d from = lattice_.at(column, row);
        const Vec2d to = lattice_.at(is_down ? column : column + 1, is_down ? row + 1 : row);
        return from + fraction * (to - from);
    }

    void cross_cell(int column, int row) {
        // Corners and the sides behind them, counterclockwise from the lower left one.
        const std::array<double, 4> corner{lattice_.brightness(column, row + 1),
                                           lattice_.brightness(column + 1, row + 1),
                                           lattice_.brightness(column + 1, row), lattice_.brightness(column, row)};
        const std::array<std::int64_t, 4> side{key(column, row + 1, false), key(column + 1, row, true),
                                               key(column, row, false), key(column, row, true)};
        const auto is_bright = [&](std::size_t i) { return corner[i % 4] >= kHalf; };
        const bool is_middle_bright = std::accumulate(corner.begin(), corner.end(), 0.0) >= 4.0 * kHalf;
        for (std::size_t i = 0; i < 4; ++i) {
            if (is_bright(i) || !is_bright(i + 1)) {
                continue;
            }
            // The contour comes out of the cell through side i, where the bright begins; it came in where that ends.
            std::size_t end = i + 1;
            while (is_bright(end + 1)) {
                ++end;
            }
            const bool is_saddle = is_bright(i + 3) && !is_bright(i + 2);
            const std::size_t in = is_saddle && is_middle_bright ? i + 3 : end;
            next_[side[in % 4]] = side[i];
        }
    }

    const Lattice& lattice_;
    std::map<std::int64_t, std::int64_t> next_;
};

double distance_to(const Vec2d& point, const Vec2d& from, const Vec2d& to) {
    const Vec2d side = to - from;
    const double long_squared = dot(side, side);
    const double fraction = long_squared > 0.0 ? std::clamp(dot(point - from, side) / long_squared, 0.0, 1.0) : 0.0;
    return length(point - from - fraction * side);
}

/// Marks the corners of a polygon between two that are known.
void mark_corners(const Contour& contour, std::size_t begin, std::size_t end, std::vector<bool>& is_corner) {
    std::vector<std::array<std::size_t, 2>> left{{begin, end}};
    while (!left.empty()) {
        const auto [first, last] = left.back();
        left.pop_back();
        std::size_t farthest = first;
        double most = kTolerance;
        for (std::size_t i = first + 1; i < last; ++i) {
            const double distance = distance_to(contour[i], contour[first], contour[last % contour.size()]);
            if (distance > most) {
                most = distance;
                farthest = i;
            }
        }
        if (farthest != first) {
            is_corner[farthest] = true;
            left.push_back({first, farthest});
            left.push_back({farthest, last});
        }
    }
}

/// A side of a contour's polygon, texels.
struct Side {
    Vec2d from;
    Vec2d to;
    Vec2d outward;
    bool is_straight = false;
    Vec2d middle;  // of a straight one's points

    [[nodiscard]] bool is_along(const Vec2d& point) const { return std::abs(dot(point - middle, outward)) < 1.0; }
};

Vec2d right_of(const Vec2d& along) {
    return (1.0 / length(along)) * Vec2d{along.y, -along.x};
}

/// One that is long is straight, and its points say which way it runs.
Side side_of(const Contour& contour, std::size_t first, std::size_t last, double shortest_straight) {
    Side side{.from = contour[first], .to = contour[last % contour.size()], .outward = {}};
    side.outward = right_of(side.to - side.from);
    side.is_straight = length(side.to - side.from) >= shortest_straight;
    if (side.is_straight) {
        const std::size_t begin = first + (last - first) / 8;  // corners are rounded off
        const std::size_t end = last - (last - first) / 8;
        for (std::size_t i = begin; i < end; ++i) {
            side.middle = side.middle + (1.0 / static_cast<double>(end - begin)) * contour[i];
        }
        double xx = 0.0;
        double xy = 0.0;
        double yy = 0.0;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec2d off = contour[i] - side.middle;
            xx += off.x * off.x;
            xy += off.x * off.y;
            yy += off.y * off.y;
        }
        const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
        const Vec2d along{std::cos(angle), std::sin(angle)};
        side.outward = right_of(dot(along, side.to - side.from) < 0.0 ? -1.0 * along : along);
    }
    return side;
}

/// The polygon of a contour, from the point on that is farthest from its middle: of a polygon a corner.
std::vector<Side> sides_of(Contour contour, double shortest_straight) {
    const auto farthest_from = [&](const Vec2d& from) {
        return std::ranges::max_element(contour, {}, [&](const Vec2d& point) { return length(point - from); });
    };
    const Vec2d middle =
        (1.0 / static_cast<double>(contour.size())) * std::accumulate(contour.begin(), contour.end(), Vec2d{});
    std::rotate(contour.begin(), farthest_from(middle), contour.end());
    const auto opposite = static_cast<std::size_t>(farthest_from(contour.front()) - contour.begin());
    std::vector<bool> is_corner(contour.size(), false);
    is_corner[opposite] = true;
    mark_corners(contour, 0, opposite, is_corner);
    mark_corners(contour, opposite, contour.size(), is_corner);
    std::vector<std::size_t> corners{0};
    for (std::size_t i = 1; i < contour.size(); ++i) {
        if (is_corner[i]) {
            corners.push_back(i);
        }
    }
    corners.push_back(contour.size());
    const auto side_from = [&](std::size_t corner) {
        return side_of(contour, corners[corner], corners[corner + 1], shortest_straight);
    };
    std::vector<Side> sides;
    for (std::size_t corner = 0; corner + 1 < corners.size(); ++corner) {
        sides.push_back(side_from(corner));
    }
    for (std::size_t i = 0; i + 1 < sides.size();) {
        const Side& here = sides[i];
        const Side& next = sides[i + 1];
        const bool goes_on = here.is_straight && !next.is_straight && here.is_along(next.to);
        const bool begins = !here.is_straight && next.is_straight && next.is_along(here.from);
        if (goes_on || begins) {
            corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(i) + 1);
            sides.erase(sides.begin() + static_cast<std::ptrdiff_t>(i));
            sides[i] = side_from(i);
            i -= i > 0 ? 1 : 0;
        } else {
            ++i;
        }
    }
    return sides;
}

/// A side's normal where it meets its neighbour.
Vec2d outward_beside(const Side& side, const Side& neighbour) {
    if (side.is_straight || dot(side.outward, neighbour.outward) < kSharp) {
        return side.outward;
    }
    const Vec2d between = neighbour.is_straight ? neighbour.outward : side.outward + neighbour.outward;
    return (1.0 / length(between)) * between;
}

bool is_crisp(const Lattice& lattice, const Side& side) {
    constexpr double kBeside = 3.0;  // texels
    const Vec2d middle = 0.5 * (side.from + side.to);
    return lattice.brightness_at(middle - kBeside * side.outward) >= 0.9 &&
           lattice.brightness_at(middle + kBeside * side.outward) <= 0.1;
}

}  // namespace

Vec2d EdgePiece::outward(double fraction) const {
    const Vec2d between = (1.0 - fraction) * outward_from + fraction * outward_to;
    return (1.0 / length(between)) * between;
}

std::optional<std::vector<EdgePiece>> texture_edges(const ApertureTexture& texture) {
    const Lattice lattice(texture);
    const double to_unit = 1.0 / lattice.semi_diameter();
    // From the middle of a chord so long an arc of twice the stop's radius is 1 texel away: it is no side of a polygon.
    const double shortest_straight = 4.0 * std::sqrt(lattice.semi_diameter());
    std::vector<EdgePiece> pieces;
    double before = 0.0;
    Crossings crossings(lattice);
    if (crossings.are_too_many()) {
        return std::nullopt;
    }
    for (const Contour& contour : crossings.contours()) {
        const std::vector<Side> sides = sides_of(contour, shortest_straight);
        for (std::size_t i = 0; i < sides.size(); ++i) {
            const Side& side = sides[i];
            if (!is_crisp(lattice, side)) {
                return std::nullopt;
            }
            const double along = to_unit * length(side.to - side.from);
            pieces.push_back({.from = to_unit * side.from,
                              .to = to_unit * side.to,
                              .outward_from = outward_beside(side, sides[(i + sides.size() - 1) % sides.size()]),
                              .outward_to = outward_beside(side, sides[(i + 1) % sides.size()]),
                              .edge_length = side.is_straight ? along : kInfinity,
                              .before = before});
            before += along;
        }
    }
    return pieces.empty() ? std::nullopt : std::optional(std::move(pieces));
}

}  // namespace lensproof::optics
