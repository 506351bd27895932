#include "calibration/comparison/registration.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "calibration/comparison/spline_surface.h"
#include "calibration/comparison/warp_fit.h"
#include "calibration/comparison/warp_pyramid.h"
#include "calibration/statistics/dense_solvers.h"
#include "engine/base/parallel.h"

namespace lensproof::calibration {

namespace {

constexpr int kSmallestSide_px = 32;
constexpr double kMostPixelsToChoose = 2e6;
constexpr int kMostSteps = 20;
constexpr double kWarpSettled_px = 1e-4;
constexpr double kLeastOverlap = 0.05;
constexpr int kBlurReach_px = 4;

/// What a level's fit came to.
struct FittedLevel {
    Warp warp;
    bool is_determined = false;
    WarpStep step;  // the last, at which nothing moves any more
    std::vector<WarpTile> tiles;
};

double overlap_of(const std::vector<WarpTile>& tiles, const formats::Image& image) {
    double pixels = 0.0;
    for (const WarpTile& tile : tiles) {
        pixels += tile.pixels;
    }
    return pixels / (static_cast<double>(image.width) * image.height);
}

FittedLevel fitted(const WarpLevel& level, const Warp& start, WarpModel model, int threads) {
    const SplineSurface surface(level.b, 0, threads);
    const WarpPair pair{.a = level.a, .b = surface, .margin_px = kBlurReach_px};
    FittedLevel result{.warp = start};
    for (int i = 0; i < kMostSteps; ++i) {
        result.tiles = warp_tiles(pair, result.warp, threads);
        result.step = warp_step(result.tiles, model);
        result.is_determined = result.step.is_determined && overlap_of(result.tiles, level.a) >= kLeastOverlap;
        if (!result.is_determined || model == WarpModel::none) {
            break;
        }
        const Warp small = small_warp(result.step.terms);
        result.warp = composed(result.warp, small);
        if (farthest_move_px(small, level.a.width, level.a.height) < kWarpSettled_px) {
            break;
        }
    }
    return result;
}

/// The same with as many terms as the level tells; the start where it tells none.
FittedLevel best_at(const WarpLevel& level, const Warp& start, WarpModel model, int threads) {
    FittedLevel shifted = fitted(level, start, WarpModel::translation, threads);
    FittedLevel all = model == WarpModel::translation
                          ? shifted
                          : fitted(level, shifted.is_determined ? shifted.warp : start, model, threads);
    if (all.is_determined) {
        return all;
    }
    return shifted.is_determined ? shifted : FittedLevel{.warp = start};
}

/// Least squares of a model's terms over what tiles say of the whole displacement, and χ².
struct TermFit {
    WarpTerms terms{};
    double chi_squared = 0.0;
};

TermFit fit_terms(const std::vector<TileShift>& tiles, const Warp& warp, const FrameScale& frame, int terms) {
    const auto rows = static_cast<Eigen::Index>(2 * tiles.size());
    Eigen::MatrixXd moves(rows, terms);
    Eigen::VectorXd whole(rows);
    for (std::size_t i = 0; i < tiles.size(); ++i) {
        const TileShift& tile = tiles[i];
        const Vec2d u = tile.middle;
        const Vec2d to = warp(u + tile.shift_px / frame.half_diagonal_px);
        const auto basis = displacements(u);
        // The information's root, so that χ² is a sum of squares.
        const SymmetricEigen axes = symmetric_eigen(tile.information);
        const Eigen::Matrix2d root =
            frame.half_diagonal_px * axes.values.cwiseMax(0.0).cwiseSqrt().asDiagonal() * axes.vectors.transpose();
        const auto row = static_cast<Eigen::Index>(2 * i);
        whole.segment<2>(row) = root * Eigen::Vector2d(to.x - u.x, to.y - u.y);
        for (int k = 0; k < terms; ++k) {
            const Vec2d& move = basis[static_cast<std::size_t>(k)];
            moves.block<2, 1>(row, k) = root * Eigen::Vector2d(move.x, move.y);
        }
    }
    TermFit fit{.chi_squared = whole.squaredNorm()};
    if (terms > 0) {
        const Eigen::VectorXd found = least_norm_solution(moves, whole);
        std::copy(found.begin(), found.end(), fit.terms.begin());
        fit.chi_squared = (whole - moves * found).squaredNorm();
    }
    return fit;
}

struct ChosenWarp {
    WarpModel model = WarpModel::none;
    Warp start;
};

/// By Schwarz's criterion; of few tiles only simple models.
ChosenWarp choose(const std::vector<TileShift>& tiles, const Warp& warp, const FrameScale& frame) {
    ChosenWarp best;
    const auto n = static_cast<double>(2 * tiles.size());
    double least = std::numeric_limits<double>::infinity();
    for (const WarpModel model :
         {WarpModel::none, WarpModel::translation, WarpModel::similarity, WarpModel::affine, WarpModel::homography}) {
        const int terms = term_count(model);
        if (n < 3.0 * terms || n == 0.0) {
            break;
        }
        const TermFit fit = fit_terms(tiles, warp, frame, terms);
        const double criterion = n * std::log(std::max(fit.chi_squared, 1e-12) / n) + terms * std::log(n);
        if (criterion < least) {
            least = criterion;
            best = {.model = model, .start = small_warp(fit.terms)};
        }
    }
    return best;
}

std::vector<WarpParameter> parameters_of(const FittedLevel& fit, WarpModel model, const FrameScale& frame) {
    const auto values = warp_parameters(fit.warp, frame);
    const int terms = term_count(model);
    Eigen::MatrixXd slopes(terms, terms);
    constexpr double kStep = 1e-6;
    for (int k = 0; k < terms; ++k) {
        WarpTerms small{};
        small[static_cast<std::size_t>(k)] = kStep;
        const auto moved = warp_parameters(composed(fit.warp, small_warp(small)), frame);
        for (int i = 0; i < terms; ++i) {
            const auto at = static_cast<std::size_t>(i);
            slopes(i, k) = (moved[at] - values[at]) / kStep;
        }
    }
    std::vector<WarpParameter> result;
    for (int i = 0; i < terms; ++i) {
        const double variance = slopes.row(i) * fit.step.covariance * slopes.row(i).transpose();
        result.push_back({.name = kWarpParameterNames[static_cast<std::size_t>(i)],
                          .estimate = {.value = values[static_cast<std::size_t>(i)],
                                       .standard_error = std::sqrt(std::max(0.0, variance))}});
    }
    return result;
}

/// From a model and a warp near by to the whole resolution.
FittedLevel refined(const std::vector<WarpLevel>& levels, std::size_t from, const ChosenWarp& choice, int threads) {
    FittedLevel fit{.warp = choice.start};
    for (std::size_t i = from + 1; i-- > 0;) {
        fit = fitted(levels[i], fit.warp, choice.model, threads);
        if (!fit.is_determined) {
            return fit;
        }
    }
    return fit;
}

}  // namespace

Registration register_pictures(const formats::Image& a, const formats::Image& b, std::optional<WarpModel> wanted,
                               int threads) {
    Registration result;
    const FrameScale frame(a.width, a.height);
    if (std::min(a.width, a.height) < kSmallestSide_px) {
        result.reason = fmt::format("pictures of fewer than {} px a side are not registered", kSmallestSide_px);
        return result;
    }
    const std::vector<WarpLevel> levels = warp_levels(a, b);
    const auto choosing = static_cast<std::size_t>(
        std::ranges::find_if(levels,
                             [](const WarpLevel& level) {
                                 return static_cast<double>(level.a.width) * level.a.height <= kMostPixelsToChoose;
                             }) -
        levels.begin());
    const bool turns = !wanted || *wanted > WarpModel::translation;
    const WarpModel coarse_model = turns ? WarpModel::similarity : WarpModel::translation;
    const WarpStarts starts = warp_starts(levels, turns, threads);
    FittedLevel coarse;
    result.correlation = -1.0;
    for (const Warp& start : starts.warps) {
        const FittedLevel from_there = best_at(levels[starts.level], start, coarse_model, threads);
        const double correlation = detail_correlation(levels[starts.level], from_there.warp, threads);
        if (correlation > result.correlation) {
            result.correlation = correlation;
            coarse = from_there;
        }
    }
    for (std::size_t i = starts.level; i-- > choosing;) {
        coarse = best_at(levels[i], coarse.warp, coarse_model, threads);
        result.correlation = std::max(result.correlation, detail_correlation(levels[i], coarse.warp, threads));
    }
    if (result.correlation < kLeastCorrelation || !coarse.is_determined) {
        const bool both_say = has_structure(a) && has_structure(b);
        result.likeness = both_say ? Likeness::unlike : Likeness::untold;
        result.reason = fmt::format("the pictures' detail has a correlation of {:.2f}, less than {}{}",
                                    result.correlation, kLeastCorrelation,
                                    both_say ? "" : ", and one of them has nothing but noise, or nothing, in it");
        return result;
    }
    result.likeness = Likeness::alike;
    const WarpLevel& chosen_at = levels[choosing];
    ChosenWarp choice =
        choose(tile_shifts(coarse.tiles, coarse.step.contrast, FrameScale(chosen_at.a.width, chosen_at.a.height)),
               coarse.warp, FrameScale(chosen_at.a.width, chosen_at.a.height));
    result.reason = "by Schwarz's criterion";
    if (wanted) {
        choice = {.model = *wanted, .start = coarse.warp};
        result.reason = "as asked for";
    }
    FittedLevel fit = refined(levels, choosing, choice, threads);
    if (!wanted && choice.model != WarpModel::none && fit.is_determined &&
        farthest_move_px(fit.warp, a.width, a.height) < kLeastMove_px) {
        result.reason = fmt::format("a {} would move no corner by {} px", warp_model_name(choice.model), kLeastMove_px);
        choice = {};
        fit = fitted(levels[0], {}, WarpModel::none, threads);
    }
    if (!fit.is_determined) {
        result.likeness = Likeness::unlike;
        result.reason = "what the pictures have in common is too little";
        return result;
    }
    result.model = choice.model;
    result.warp = fit.warp;
    result.parameters = parameters_of(fit, choice.model, frame);
    result.residual_px = rms_shift_px(tile_shifts(fit.tiles, fit.step.contrast, frame));
    result.overlap = result.model == WarpModel::none ? 1.0 : overlap_of(fit.tiles, levels[0].a);
    return result;
}

WarpedPicture warped(formats::Image b, const Registration& registration, int threads) {
    WarpedPicture result{.image = std::move(b), .overlap = {}};
    formats::Image& image = result.image;
    result.overlap = whole_frame(image);
    if (registration.model == WarpModel::none) {
        return result;
    }
    const FrameScale frame(image.width, image.height);
    for (int channel = 0; channel < image.channel_count(); ++channel) {
        const SplineSurface surface(image, channel, threads);
        parallel_for(image.height, threads, [&](int y) {
            for (int x = 0; x < image.width; ++x) {
                const Vec2d place = frame.px(registration.warp(frame.unit(x, y)));
                const bool is_covered = surface.covers(place);
                image.at(x, y, channel) = is_covered ? static_cast<float>(surface.at(place)) : 0.0F;
                result.overlap[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                               static_cast<std::size_t>(x)] = is_covered ? 255 : 0;
            }
        });
    }
    return result;
}

}  // namespace lensproof::calibration
