#include "calibration/comparison/warp_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "calibration/statistics/dense_solvers.h"
#include "engine/base/parallel.h"

namespace lensproof::calibration {

namespace {

constexpr int kMostTiles = 8;  // a side
constexpr int kSmallestTile_px = 16;
constexpr int kContrastColumn = kMostWarpTerms;
constexpr int kOffsetColumn = kMostWarpTerms + 1;
constexpr int kValueColumn = kMostWarpTerms + 2;
constexpr double kNothing = 1e-10;  // of the largest, beside which rounding is all

using Column = Eigen::Matrix<double, kMostWarpTerms + 3, 1>;

struct TileRange {
    int x0, x1, y0, y1;
};

WarpTile summed(const WarpPair& pair, const Warp& warp, const FrameScale& frame, const TileRange& range) {
    WarpTile tile;
    tile.products.setZero();
    Column column;
    column(kOffsetColumn) = 1.0;
    const formats::Image& a = pair.a;
    for (int y = range.y0; y < range.y1; ++y) {
        for (int x = range.x0; x < range.x1; ++x) {
            const Vec2d u = frame.unit(x, y);
            const Vec2d place = frame.px(warp(u));
            if (!(place.x >= pair.margin_px && place.y >= pair.margin_px && place.x <= a.width - 1 - pair.margin_px &&
                  place.y <= a.height - 1 - pair.margin_px)) {
                continue;
            }
            const Vec2d gradient =
                0.5 * frame.half_diagonal_px *
                Vec2d{static_cast<double>(a.at(x + 1, y, 0)) - static_cast<double>(a.at(x - 1, y, 0)),
                      static_cast<double>(a.at(x, y + 1, 0)) - static_cast<double>(a.at(x, y - 1, 0))};
            const auto moves = displacements(u);
            for (int k = 0; k < kMostWarpTerms; ++k) {
                const Vec2d& move = moves[static_cast<std::size_t>(k)];
                column(k) = gradient.x * move.x + gradient.y * move.y;
            }
            column(kContrastColumn) = static_cast<double>(a.at(x, y, 0));
            column(kValueColumn) = pair.b.at(place);
            tile.products.noalias() += column * column.transpose();
            tile.middle = tile.middle + u;
            tile.pixels += 1.0;
        }
    }
    if (tile.pixels > 0.0) {
        tile.middle = tile.middle / tile.pixels;
    }
    return tile;
}

/// Which columns a model uses, contrast and offset last.
std::vector<int> columns_of(int terms) {
    std::vector<int> columns(static_cast<std::size_t>(terms));
    std::iota(columns.begin(), columns.end(), 0);
    columns.push_back(kContrastColumn);
    columns.push_back(kOffsetColumn);
    return columns;
}

/// Whether the matrix of normal equations tells all its unknowns, in their own scales.
bool tells_all(const Eigen::MatrixXd& normal) {
    if (!normal.allFinite() || !(normal.diagonal().minCoeff() > 0.0)) {
        return false;
    }
    const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
    return symmetric_eigen(scaled).values(0) > kNothing;
}

}  // namespace

std::vector<WarpTile> warp_tiles(const WarpPair& pair, const Warp& warp, int threads) {
    const FrameScale frame(pair.a.width, pair.a.height);
    const int near = std::max(1, pair.margin_px);
    const int wide = pair.a.width - 2 * near;
    const int high = pair.a.height - 2 * near;
    const int across = std::clamp(wide / kSmallestTile_px, 1, kMostTiles);
    const int down = std::clamp(high / kSmallestTile_px, 1, kMostTiles);
    std::vector<WarpTile> tiles(static_cast<std::size_t>(across * down));
    parallel_for(across * down, threads, [&](int i) {
        const int column = i % across;
        const int row = i / across;
        tiles[static_cast<std::size_t>(i)] = summed(pair, warp, frame,
                                                    {.x0 = near + wide * column / across,
                                                     .x1 = near + wide * (column + 1) / across,
                                                     .y0 = near + high * row / down,
                                                     .y1 = near + high * (row + 1) / down});
    });
    std::erase_if(tiles, [](const WarpTile& tile) { return tile.pixels == 0.0; });
    return tiles;
}

WarpStep warp_step(const std::vector<WarpTile>& tiles, WarpModel model) {
    WarpStep step;
    const int terms = term_count(model);
    const std::vector<int> columns = columns_of(terms);
    const auto size = static_cast<Eigen::Index>(columns.size());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    double squares = 0.0;
    double pixels = 0.0;
    for (const WarpTile& tile : tiles) {
        normal += tile.products(columns, columns);
        right += tile.products(columns, kValueColumn);
        squares += tile.products(kValueColumn, kValueColumn);
        pixels += tile.pixels;
    }
    if (!tells_all(normal)) {
        return step;
    }
    const Eigen::VectorXd found = solve_symmetric(normal, right);
    step.contrast = found(terms);
    step.is_determined = step.contrast > 0.0;
    for (int k = 0; k < terms; ++k) {
        step.terms[static_cast<std::size_t>(k)] = -found(k) / step.contrast;
    }
    Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(size, size);
    const auto count = static_cast<double>(tiles.size());
    if (count >= 3.0 * static_cast<double>(size)) {
        for (const WarpTile& tile : tiles) {
            const Eigen::VectorXd pull = tile.products(columns, kValueColumn) - tile.products(columns, columns) * found;
            scatter += pull * pull.transpose();
        }
        scatter *= count / (count - static_cast<double>(size));
    } else {
        scatter =
            std::max(0.0, squares - found.dot(right)) / std::max(1.0, pixels - static_cast<double>(size)) * normal;
    }
    const Eigen::MatrixXd inverse = solve_symmetric(normal, Eigen::MatrixXd::Identity(size, size));
    step.covariance = (inverse * scatter * inverse).topLeftCorner(terms, terms) / (step.contrast * step.contrast);
    return step;
}

std::vector<TileShift> tile_shifts(const std::vector<WarpTile>& tiles, double contrast, const FrameScale& frame) {
    const std::vector<int> shifts{0, 1};
    const std::vector<int> light{kContrastColumn, kOffsetColumn};
    const std::vector<int> all{0, 1, kContrastColumn, kOffsetColumn};
    std::vector<TileShift> result;
    for (const WarpTile& tile : tiles) {
        const Eigen::Matrix2d cross = tile.products(shifts, light);
        const Eigen::Matrix2d of_light = tile.products(light, light);
        const Eigen::Matrix2d of_shift = tile.products(shifts, shifts);
        if (!tells_all(of_light) || tile.pixels < 16.0) {
            continue;
        }
        const Eigen::Matrix2d taken = cross * of_light.inverse();
        const Eigen::Matrix2d known = of_shift - taken * cross.transpose();
        const Eigen::Vector2d right = tile.products(shifts, kValueColumn) - taken * tile.products(light, kValueColumn);
        // Along an edge nothing is known: the step stays 0 there.
        const SymmetricEigen axes = symmetric_eigen(known);
        Eigen::Vector2d step = Eigen::Vector2d::Zero();
        for (int i = 0; i < 2; ++i) {
            if (axes.values(i) > 1e-6 * of_shift.trace()) {
                const Eigen::Vector2d axis = axes.vectors.col(i);
                step += axis * (axis.dot(right) / axes.values(i));
            }
        }
        const Eigen::Vector4d right_all = tile.products(all, kValueColumn);
        const Eigen::Matrix4d normal_all = tile.products(all, all);
        const Eigen::Vector4d fit_all = least_norm_solution(normal_all, right_all);
        const double squares = tile.products(kValueColumn, kValueColumn) - right_all.dot(fit_all);
        const double variance = std::max(squares / std::max(1.0, tile.pixels - 4.0),
                                         kNothing * tile.products(kValueColumn, kValueColumn) / tile.pixels);
        const double size = frame.half_diagonal_px;
        if (step.allFinite() && variance > 0.0) {
            result.push_back({.middle = tile.middle,
                              .shift_px = {-step.x() / contrast * size, -step.y() / contrast * size},
                              .information = known * (contrast * contrast / (variance * size * size))});
        }
    }
    return result;
}

double rms_shift_px(const std::vector<TileShift>& shifts) {
    double squares = 0.0;
    double weights = 0.0;
    for (const TileShift& shift : shifts) {
        const Eigen::Vector2d t(shift.shift_px.x, shift.shift_px.y);
        squares += t.dot(shift.information * t);
        weights += shift.information.trace();
    }
    return weights > 0.0 ? std::sqrt(squares / weights) : 0.0;
}

}  // namespace lensproof::calibration
