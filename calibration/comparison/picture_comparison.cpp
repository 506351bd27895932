#include "calibration/comparison/picture_comparison.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calibration/comparison/ciede2000.h"
#include "calibration/comparison/colour_planes.h"
#include "calibration/comparison/noise_ratio.h"
#include "calibration/comparison/radial_difference.h"
#include "calibration/comparison/structural_similarity.h"
#include "engine/base/order_statistics.h"

namespace lensproof::calibration {

namespace {

/// Where nothing is in common `b` is to differ from `a` in nothing, so that no window sees an edge there.
void fill_uncovered(const formats::Image& a, formats::Image& b, const Overlap& overlap) {
    const std::size_t channels = a.channels.size();
    for (std::size_t i = 0; i < overlap.size(); ++i) {
        if (overlap[i] == 0) {
            std::copy_n(a.pixels.begin() + static_cast<std::ptrdiff_t>(i * channels), channels,
                        b.pixels.begin() + static_cast<std::ptrdiff_t>(i * channels));
        }
    }
}

/// The value that 99 of 100 pixels in common do not exceed, and the standard error of where the cut lies: between the
/// quantiles one standard error of a fraction away, the fraction's error that of pixels over blocks.
Estimate percentile_99(const formats::Image& map, const Overlap& overlap) {
    std::vector<float> values;
    for (std::size_t i = 0; i < overlap.size(); ++i) {
        if (overlap[i] != 0) {
            values.push_back(map.pixels[i]);
        }
    }
    if (values.empty()) {
        return {};
    }
    constexpr double kFraction = 0.99;
    const auto cut = quantile(values, kFraction);
    formats::Image above = formats::make_image(map.width, map.height, {"above"});
    for (std::size_t i = 0; i < above.pixels.size(); ++i) {
        above.pixels[i] = map.pixels[i] > cut ? 1.0F : 0.0F;
    }
    const double error = mean_over(above, overlap).standard_error;
    const auto at = [&](double fraction) {
        return static_cast<double>(quantile(values, std::clamp(fraction, 0.0, 1.0)));
    };
    return {.value = static_cast<double>(cut), .standard_error = 0.5 * (at(kFraction + error) - at(kFraction - error))};
}

}  // namespace

PictureComparison compare_pictures(const formats::Image& a, formats::Image b, const ComparisonWishes& wishes) {
    PictureComparison result;
    const int threads = wishes.threads;
    if (wishes.registers) {
        result.registration = register_pictures(a, b, wishes.model, threads);
        if (result.registration.likeness == Likeness::unlike) {
            return result;
        }
    } else {
        result.registration.reason = "as asked for";
    }
    auto [other, overlap] = warped(std::move(b), result.registration, threads);
    result.exposure.reason = "as asked for";
    if (wishes.matches_exposure) {
        result.exposure = match_exposure(a, other, overlap, wishes.clipped);
        apply(result.exposure, other);
    }
    fill_uncovered(a, other, overlap);
    {
        const formats::Image shown_a = displayed(a, threads);
        const formats::Image shown_b = displayed(other, threads);
        result.rms = rms_difference(shown_a, shown_b, overlap);
        result.psnr_db = peak_signal_to_noise_db(result.rms);
        result.ssim = mean_over(structural_similarity(shown_a, shown_b, threads),
                                shrunk(overlap, a.width, a.height, kSsimReach_px));
    }
    formats::Image flip_map;
    if (wishes.is_high_range) {
        result.flip_exposures = flip_exposures(a);
        flip_map = flip_high_range(a, other, wishes.pixels_per_degree, *result.flip_exposures, threads);
    } else {
        flip_map = flip_low_range(a, other, wishes.pixels_per_degree, threads);
    }
    result.flip = mean_over(flip_map, overlap);
    formats::Image colours = ciede2000_map(a, other, threads);
    result.ciede2000_mean = mean_over(colours, overlap);
    result.ciede2000_p99 = percentile_99(colours, overlap);
    result.curves = radial_differences(a, other, colours, overlap);
    if (wishes.makes_maps) {
        result.flip_map = std::move(flip_map);
        result.ciede2000_map = std::move(colours);
        result.difference = denoised_difference(a, other, overlap);
        result.b_over_a = std::move(other);
    }
    return result;
}

}  // namespace lensproof::calibration
