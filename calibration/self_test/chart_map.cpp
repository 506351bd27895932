#include "calibration/self_test/chart_map.h"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

namespace lensproof::calibration {
namespace {

constexpr int kBlock = 8;  // cells along a block's side
constexpr int kBlock_px = kBlock * ChartMap::kKnot_px;
constexpr double kSmooth_px = 1e-4;  // that a cubic may be off by

int blocks_over(int pixels) {
    return (pixels + kBlock_px - 1) / kBlock_px;
}

Vec2d point_or_nowhere(const std::optional<Vec2d>& point) {
    return point.value_or(Vec2d{kNaN, kNaN});
}

bool is_somewhere(const Vec2d& point) {
    return !std::isnan(point.x);
}

// Lagrange's weights of the values at −1, 0, 1 and 2 for the one at `t`.
std::array<double, 4> cubic_weights(double t) {
    return {-t * (t - 1.0) * (t - 2.0) / 6.0, (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0, -(t + 1.0) * t * (t - 2.0) / 2.0,
            (t + 1.0) * t * (t - 1.0) / 6.0};
}

double distance(const Vec2d& a, const Vec2d& b) {
    return std::hypot(b.x - a.x, b.y - a.y);
}

// What four corners show, in the chart's order of reading.
struct Quad {
    Vec2d a, b, c, d;

    [[nodiscard]] bool is_complete() const { return is_somewhere(a + b + c + d); }
    [[nodiscard]] Vec2d middle() const { return 0.25 * (a + b + c + d); }
    // None of the chart's parts is so narrow that it slips between its corners and its middle and those of the
    // neighbours: none is narrower than both diagonals.
    [[nodiscard]] bool is_finer_than(double narrowest_mm) const {
        return distance(a, d) + distance(b, c) <= narrowest_mm;
    }
};

std::optional<double> only_tone_of(const Quad& quad, const scene::Chart& chart, double narrowest_mm) {
    if (!quad.is_complete() || !quad.is_finer_than(narrowest_mm)) {
        return std::nullopt;
    }
    const auto tone = [&](const Vec2d& place) { return scene::reflectance(chart, place.x, place.y); };
    const double of_all = tone(quad.a);
    const bool is_even =
        tone(quad.b) == of_all && tone(quad.c) == of_all && tone(quad.d) == of_all && tone(quad.middle()) == of_all;
    return is_even ? std::optional(of_all) : std::nullopt;
}

}  // namespace

// Corners from one block before the first to one behind the last.
struct ChartMap::Lattice {
    int columns;  // of blocks in the map
    int rows;
    std::vector<Vec2d> corners;

    /// The top left corner of block (i, j), −1 ≤ i ≤ columns + 1.
    [[nodiscard]] const Vec2d& corner(int i, int j) const {
        return corners[static_cast<std::size_t>(j + 1) * (columns + 3) + i + 1];
    }
    [[nodiscard]] Quad block(int i, int j) const {
        return {corner(i, j), corner(i + 1, j), corner(i, j + 1), corner(i + 1, j + 1)};
    }
    /// The four rows of four corners around block (i, j), summed down by these weights.
    [[nodiscard]] std::array<Vec2d, 4> rows_at(int i, int j, const std::array<double, 4>& weights) const {
        std::array<Vec2d, 4> sums;
        for (int column = 0; column < 4; ++column) {
            for (int row = 0; row < 4; ++row) {
                sums[column] = sums[column] + weights[row] * corner(i + column - 1, j + row - 1);
            }
        }
        return sums;
    }
};

namespace {

Vec2d weighted(const std::array<Vec2d, 4>& values, const std::array<double, 4>& weights) {
    return weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2] + weights[3] * values[3];
}

}  // namespace

ChartMap::ChartMap(const Exact& exact, const scene::Chart& chart, const cv::Rect& pixels)
    : first_(pixels.tl()),
      columns_(kBlock * blocks_over(pixels.width) + 1),
      rows_(kBlock * blocks_over(pixels.height) + 1),
      knots_(static_cast<std::size_t>(columns_) * rows_),
      even_tones_(rows_, columns_, CV_32F, cv::Scalar(kNaN)) {
    Lattice lattice{.columns = blocks_over(pixels.width), .rows = blocks_over(pixels.height), .corners = {}};
    for (int j = -1; j <= lattice.rows + 1; ++j) {
        for (int i = -1; i <= lattice.columns + 1; ++i) {
            lattice.corners.push_back(point_or_nowhere(exact(pixel_of_knot(kBlock * i, kBlock * j))));
        }
    }
    fill_knots(exact, lattice);
    find_even_cells(chart, lattice);
}

void ChartMap::fill_knots(const Exact& exact, const Lattice& lattice) {
    std::array<std::array<double, 4>, kBlock + 1> weights;
    for (int k = 0; k <= kBlock; ++k) {
        weights[k] = cubic_weights(static_cast<double>(k) / kBlock);
    }
    const auto is_cubic = [&](int i, int j) {
        const Quad block = lattice.block(i, j);
        const double allowed_mm =
            kSmooth_px / kBlock_px * std::min(distance(block.a, block.d), distance(block.b, block.c));
        const auto holds = [&](int u, int v) {
            const Vec2d cubic = weighted(lattice.rows_at(i, j, weights[v]), weights[u]);  // NaN where a corner is
            const auto there = exact(pixel_of_knot(kBlock * i + u, kBlock * j + v));
            return there && distance(cubic, *there) <= allowed_mm;
        };
        return holds(kBlock / 2, kBlock / 2) && holds(kBlock / 2, 0);
    };
    for (int j = 0; j < lattice.rows; ++j) {
        const int knot_rows = j + 1 == lattice.rows ? kBlock + 1 : kBlock;
        for (int i = 0; i < lattice.columns; ++i) {
            const int knot_columns = i + 1 == lattice.columns ? kBlock + 1 : kBlock;
            const bool as_cubic = is_cubic(i, j);
            for (int v = 0; v < knot_rows; ++v) {
                const std::array<Vec2d, 4> across = lattice.rows_at(i, j, weights[v]);
                Vec2d* row =
                    &knots_[static_cast<std::size_t>(kBlock * j + v) * columns_ + static_cast<std::size_t>(kBlock) * i];
                for (int u = 0; u < knot_columns; ++u) {
                    row[u] = as_cubic ? weighted(across, weights[u])
                                      : point_or_nowhere(exact(pixel_of_knot(kBlock * i + u, kBlock * j + v)));
                }
            }
        }
    }
}

// A cell is even if it and its eight neighbours are of one tone at all corners and middles; so is a block with all of
// its cells. Only cells of other blocks are looked at one by one.
void ChartMap::find_even_cells(const scene::Chart& chart, const Lattice& lattice) {
    const double narrowest = scene::traits(chart).narrowest_mm;
    cv::Mat blocks(lattice.rows + 2, lattice.columns + 2, CV_32F, cv::Scalar(kNaN));  // their tones, from (−1, −1)
    for (int j = -1; j <= lattice.rows; ++j) {
        for (int i = -1; i <= lattice.columns; ++i) {
            if (const auto tone = only_tone_of(lattice.block(i, j), chart, narrowest)) {
                blocks.at<float>(j + 1, i + 1) = static_cast<float>(*tone);
            }
        }
    }
    const auto tone_around = [&](int i, int j) {
        const float tone = blocks.at<float>(j + 1, i + 1);
        for (int k = 0; k < 9; ++k) {
            if (blocks.at<float>(j + k / 3, i + k % 3) != tone) {
                return std::numeric_limits<float>::quiet_NaN();
            }
        }
        return tone;
    };
    cv::Mat seen(rows_, columns_, CV_32F, cv::Scalar(kNaN));  // cells of one tone, by themselves
    for (int j = 0; j < lattice.rows; ++j) {
        for (int i = 0; i < lattice.columns; ++i) {
            const cv::Rect cells(kBlock * i, kBlock * j, kBlock, kBlock);
            if (const float tone = tone_around(i, j); !std::isnan(tone)) {
                seen(cells).setTo(tone);
                even_tones_(cells).setTo(tone);
                continue;
            }
            for (int v = cells.y; v < cells.br().y; ++v) {
                for (int u = cells.x; u < cells.br().x; ++u) {
                    const Quad quad{knot(u, v), knot(u + 1, v), knot(u, v + 1), knot(u + 1, v + 1)};
                    if (const auto tone_of_cell = only_tone_of(quad, chart, narrowest)) {
                        seen.at<float>(v, u) = static_cast<float>(*tone_of_cell);
                    }
                }
            }
        }
    }
    for (int v = 1; v + 2 < rows_; ++v) {
        for (int u = 1; u + 2 < columns_; ++u) {
            const float tone = seen.at<float>(v, u);
            bool is_even = std::isnan(even_tones_.at<float>(v, u)) && !std::isnan(tone);
            for (int k = 0; k < 9 && is_even; ++k) {
                is_even = seen.at<float>(v - 1 + k / 3, u - 1 + k % 3) == tone;
            }
            if (is_even) {
                even_tones_.at<float>(v, u) = tone;
            }
        }
    }
}

// The mean of those at knots (i, j) and the next one along x or y; 0 where a neighbour is missing.
Vec2d ChartMap::second_difference(int i, int j, int along_x, int along_y) const {
    if (i < along_x || j < along_y || i + 2 * along_x >= columns_ || j + 2 * along_y >= rows_) {
        return {};
    }
    const Vec2d twice = knot(i - along_x, j - along_y) - knot(i, j) - knot(i + along_x, j + along_y) +
                        knot(i + 2 * along_x, j + 2 * along_y);
    return is_somewhere(twice) ? 0.5 * twice : Vec2d{};
}

// Of the cell's form A + U B + V C + U V D + U (U − 1) E + V (V − 1) F the part of this pixel.
ChartMap::Pixel ChartMap::pixel(int x, int y) const {
    const int i = (x - first_.x) / kKnot_px;
    const int j = (y - first_.y) / kKnot_px;
    const double from_u = static_cast<double>((x - first_.x) % kKnot_px) / kKnot_px;
    const double from_v = static_cast<double>((y - first_.y) % kKnot_px) / kKnot_px;
    const Vec2d& a = knot(i, j);
    const Vec2d b = knot(i + 1, j) - a;
    const Vec2d c = knot(i, j + 1) - a;
    const Vec2d d = knot(i + 1, j + 1) - a - b - c;
    const Vec2d e = 0.5 * second_difference(i, j, 1, 0);
    const Vec2d f = 0.5 * second_difference(i, j, 0, 1);
    constexpr double kPerPixel = 1.0 / kKnot_px;
    return {.corner = a + from_u * (b + (from_u - 1.0) * e) + from_v * (c + from_u * d + (from_v - 1.0) * f),
            .along_x = kPerPixel * (b + from_v * d + (2.0 * from_u - 1.0) * e),
            .along_y = kPerPixel * (c + from_u * d + (2.0 * from_v - 1.0) * f),
            .twist = kPerPixel * kPerPixel * d,
            .bend_x = kPerPixel * kPerPixel * e,
            .bend_y = kPerPixel * kPerPixel * f};
}

std::optional<float> ChartMap::only_tone(const cv::Rect& pixels) const {
    const cv::Point from((pixels.x - first_.x) / kKnot_px, (pixels.y - first_.y) / kKnot_px);
    const cv::Point last((pixels.br().x - 1 - first_.x) / kKnot_px, (pixels.br().y - 1 - first_.y) / kKnot_px);
    const float tone = even_tones_.at<float>(from.y, from.x);
    for (int j = from.y; j <= last.y; ++j) {
        const float* row = even_tones_.ptr<float>(j);
        for (int i = from.x; i <= last.x; ++i) {
            if (row[i] != tone) {  // NaN differs from itself
                return std::nullopt;
            }
        }
    }
    return tone;
}

}  // namespace lensproof::calibration
