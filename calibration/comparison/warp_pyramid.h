// calibration/comparison/warp_pyramid.h — two pictures at several resolutions, as a registration looks at them.
#pragma once
#include <cstddef>
#include <vector>

#include "calibration/comparison/warp.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// Below which two pictures' detail does not say that they show the same: of photographs that have nothing in common,
/// turned and scaled until they fit best, it reaches 0.31.
inline constexpr double kLeastCorrelation = 0.4;

/// Both pictures at one resolution: luminance v as v / (v + s), s the square of the mean root of v, so that lamps do
/// not decide and an exposure makes no difference; smoothed before by σ = 1 px.
struct WarpLevel {
    formats::Image a;
    formats::Image b;
};

/// From the whole resolution on each at half the one before it, down to 48 px a side.
std::vector<WarpLevel> warp_levels(const formats::Image& a, const formats::Image& b);

/// `b` as it is seen from `a`'s places, and whether it covers them.
struct SeenThrough {
    formats::Image image;
    std::vector<unsigned char> covered;
};
SeenThrough seen_through(const formats::Image& b, const Warp& warp, int threads);

/// Pearson's correlation of the pictures' detail (all but what σ = 2 px leaves) where both are seen; 0 where that is
/// less than a twentieth of the frame, or there is none in one of them.
double detail_correlation(const WarpLevel& level, const Warp& warp, int threads);

/// Warps to start from, at one of the levels: none, the shift by phase correlation (Kuglin and Hines 1975), and where
/// neither of these fits and `turns`, the likeliest of the same for `b` turned by multiples of 5° and scaled by 0.8, 1
/// and 1.25.
struct WarpStarts {
    std::size_t level = 0;
    std::vector<Warp> warps;
};
WarpStarts warp_starts(const std::vector<WarpLevel>& levels, bool turns, int threads);

/// Whether what stands 3 or 5 px apart has more to do with each other than noise has: only such a picture can be unlike
/// another. The picture has more than 5 px a side.
bool has_structure(const formats::Image& image);

}  // namespace lensproof::calibration
