#include "calibration/comparison/warp_pyramid.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "calibration/comparison/colour_planes.h"
#include "calibration/comparison/spline_surface.h"
#include "engine/base/angle.h"
#include "engine/base/parallel.h"

namespace lensproof::calibration {

namespace {

constexpr int kCoarsestSide_px = 48;
constexpr double kDetail_px = 2.0;  // σ of what is no detail
constexpr int kDetailReach_px = 6;
constexpr double kLeastFraction = 0.05;
constexpr int kStartSide_px = 256;  // phases are correlated at this size, or below
constexpr int kTurnSide_px = 128;
constexpr std::size_t kMostStarts = 8;

/// A header over the picture's memory.
cv::Mat matrix(formats::Image& image) {
    return {image.height, image.width, CV_32F, image.pixels.data()};
}

cv::Mat matrix(const formats::Image& image) {
    return {image.height, image.width, CV_32F, const_cast<float*>(image.pixels.data())};
}

formats::Image grey(int width, int height) {
    return formats::make_image(width, height, {"Y"});
}

formats::Image halved(const formats::Image& image) {
    formats::Image half = grey((image.width + 1) / 2, (image.height + 1) / 2);
    cv::Mat out = matrix(half);
    cv::pyrDown(matrix(image), out);
    return half;
}

/// s of WarpLevel.
double typical_light(const formats::Image& luminance) {
    double roots = 0.0;
    for (const float value : luminance.pixels) {
        roots += std::sqrt(std::max(static_cast<double>(value), 0.0));
    }
    return std::max(std::pow(roots / static_cast<double>(luminance.pixels.size()), 2.0), 1e-12);
}

formats::Image compressed(const formats::Image& luminance, double typical) {
    formats::Image result = grey(luminance.width, luminance.height);
    cv::Mat out = matrix(result);
    cv::GaussianBlur(matrix(luminance), out, {0, 0}, 1.0, 1.0, cv::BORDER_REFLECT);
    for (float& value : result.pixels) {
        const double light = std::max(static_cast<double>(value), 0.0);
        value = static_cast<float>(light / (light + typical));
    }
    return result;
}

cv::Mat detail(const formats::Image& image) {
    cv::Mat smooth;
    cv::GaussianBlur(matrix(image), smooth, {0, 0}, kDetail_px, kDetail_px, cv::BORDER_REFLECT);
    return matrix(image) - smooth;
}

/// The shift by which b's copy lies away from a, px.
Warp phase_shift(const formats::Image& a, const formats::Image& b, double& response) {
    cv::Mat window;
    cv::createHanningWindow(window, {a.width, a.height}, CV_32F);
    const cv::Mat one = matrix(a) - cv::mean(matrix(a))[0];
    const cv::Mat other = matrix(b) - cv::mean(matrix(b))[0];
    const cv::Point2d shift = cv::phaseCorrelate(one, other, window, &response);
    const double size = FrameScale(a.width, a.height).half_diagonal_px;
    return small_warp({shift.x / size, shift.y / size});
}

/// The finest level that has no longer side than `side_px`, or the coarsest.
std::size_t level_of(const std::vector<WarpLevel>& levels, int side_px) {
    const auto found = std::ranges::find_if(
        levels, [&](const WarpLevel& level) { return std::max(level.a.width, level.a.height) <= side_px; });
    return std::min(static_cast<std::size_t>(found - levels.begin()), levels.size() - 1);
}

/// The likeliest turned and scaled copies, best first.
std::vector<Warp> turned_starts(const WarpLevel& level, int threads) {
    std::vector<std::pair<double, Warp>> candidates;
    for (int turn = 0; turn < 72; ++turn) {
        for (const double scale : {0.8, 1.0, 1.25}) {
            const double angle = radians(5.0 * turn);
            const Warp first = small_warp({0.0, 0.0, scale * std::cos(angle) - 1.0, scale * std::sin(angle)});
            double response = 0.0;
            const Warp shift = phase_shift(level.a, seen_through(level.b, first, 1).image, response);
            const Warp warp = composed(first, shift);
            candidates.emplace_back(detail_correlation(level, warp, threads), warp);
        }
    }
    std::ranges::stable_sort(candidates, [](const auto& one, const auto& other) { return one.first > other.first; });
    std::vector<Warp> best;
    for (std::size_t i = 0; i < kMostStarts; ++i) {
        best.push_back(candidates[i].second);
    }
    return best;
}

}  // namespace

std::vector<WarpLevel> warp_levels(const formats::Image& a, const formats::Image& b) {
    formats::Image light_a = luminance_of(a);
    formats::Image light_b = luminance_of(b);
    const double typical_a = typical_light(light_a);
    const double typical_b = typical_light(light_b);
    std::vector<WarpLevel> levels;
    for (;;) {
        levels.push_back({.a = compressed(light_a, typical_a), .b = compressed(light_b, typical_b)});
        if (std::min(light_a.width, light_a.height) < 2 * kCoarsestSide_px) {
            return levels;
        }
        light_a = halved(light_a);
        light_b = halved(light_b);
    }
}

SeenThrough seen_through(const formats::Image& b, const Warp& warp, int threads) {
    const FrameScale frame(b.width, b.height);
    const SplineSurface surface(b, 0, threads);
    const auto mean = static_cast<float>(cv::mean(matrix(b))[0]);
    SeenThrough result{.image = grey(b.width, b.height), .covered = std::vector<unsigned char>(b.pixels.size(), 0)};
    parallel_for(b.height, threads, [&](int y) {
        for (int x = 0; x < b.width; ++x) {
            const Vec2d place = frame.px(warp(frame.unit(x, y)));
            const bool is_covered = surface.covers(place);
            result.image.at(x, y, 0) = is_covered ? static_cast<float>(surface.at(place)) : mean;
            result.covered[static_cast<std::size_t>(y) * static_cast<std::size_t>(b.width) +
                           static_cast<std::size_t>(x)] = is_covered ? 255 : 0;
        }
    });
    return result;
}

double detail_correlation(const WarpLevel& level, const Warp& warp, int threads) {
    const SeenThrough seen = seen_through(level.b, warp, threads);
    cv::Mat both(level.a.height, level.a.width, CV_8U, const_cast<unsigned char*>(seen.covered.data()));
    cv::Mat inner;
    const int side = 2 * kDetailReach_px + 1;
    cv::erode(both, inner, cv::Mat::ones(side, side, CV_8U), {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar::all(0));
    if (cv::countNonZero(inner) < kLeastFraction * static_cast<double>(inner.total())) {
        return 0.0;
    }
    const cv::Mat one = detail(level.a);
    const cv::Mat other = detail(seen.image);
    const double products = cv::mean(one.mul(other), inner)[0] - cv::mean(one, inner)[0] * cv::mean(other, inner)[0];
    cv::Scalar mean;
    cv::Scalar sigma_one;
    cv::Scalar sigma_other;
    cv::meanStdDev(one, mean, sigma_one, inner);
    cv::meanStdDev(other, mean, sigma_other, inner);
    constexpr double kNoDetail = 1e-6;
    return sigma_one[0] > kNoDetail && sigma_other[0] > kNoDetail ? products / (sigma_one[0] * sigma_other[0]) : 0.0;
}

WarpStarts warp_starts(const std::vector<WarpLevel>& levels, bool turns, int threads) {
    WarpStarts result{.level = level_of(levels, kStartSide_px)};
    const WarpLevel& level = levels[result.level];
    double response = 0.0;
    result.warps = {Warp{}, phase_shift(level.a, level.b, response)};
    const double fit = std::max(detail_correlation(level, result.warps[0], threads),
                                detail_correlation(level, result.warps[1], threads));
    if (fit < kLeastCorrelation && turns) {
        result.level = level_of(levels, kTurnSide_px);
        const std::vector<Warp> turned = turned_starts(levels[result.level], threads);
        result.warps.insert(result.warps.end(), turned.begin(), turned.end());
    }
    return result;
}

bool has_structure(const formats::Image& image) {
    constexpr double kLeast = 0.1;
    const formats::Image light = luminance_of(image);
    cv::Mat smooth;
    cv::GaussianBlur(matrix(light), smooth, {0, 0}, 8.0, 8.0, cv::BORDER_REFLECT);
    const cv::Mat rest = matrix(light) - smooth;
    const double squares = rest.dot(rest);
    double largest = 0.0;
    for (const int apart : {3, 5}) {
        const cv::Rect left(0, 0, image.width - apart, image.height);
        const cv::Rect top(0, 0, image.width, image.height - apart);
        largest = std::max({largest, std::abs(rest(left).dot(rest(left + cv::Point(apart, 0)))),
                            std::abs(rest(top).dot(rest(top + cv::Point(0, apart))))});
    }
    return squares > 1e-12 * static_cast<double>(rest.total()) && largest > kLeast * squares;
}

}  // namespace lensproof::calibration
