#include "calibration/comparison/exposure_match.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lensproof::calibration {

namespace {

constexpr double kStandardErrors = 3.0;

bool is_clipped(const float* values, std::size_t channels, double from) {
    return std::any_of(values, values + channels, [from](float value) { return static_cast<double>(value) >= from; });
}

}  // namespace

ExposureMatch match_exposure(const formats::Image& a, const formats::Image& b, const Overlap& overlap,
                             const ClippedFrom& clipped) {
    const std::size_t channels = a.channels.size();
    BlockSums sums(a.width, a.height, static_cast<int>(2 * channels));
    for (int band = 0; band < sums.bands(); ++band) {
        for (int y = sums.first_row(band); y < sums.first_row(band + 1); ++y) {
            for (int x = 0; x < a.width; ++x) {
                const auto pixel =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(a.width) + static_cast<std::size_t>(x);
                const float* one = a.pixels.data() + pixel * channels;
                const float* other = b.pixels.data() + pixel * channels;
                if (overlap[pixel] == 0 || is_clipped(one, channels, clipped.a) ||
                    is_clipped(other, channels, clipped.b)) {
                    continue;
                }
                double* block = sums.at(x, band);
                for (std::size_t c = 0; c < channels; ++c) {
                    block[2 * c] += static_cast<double>(one[c]);
                    block[2 * c + 1] += static_cast<double>(other[c]);
                }
            }
        }
    }
    ExposureMatch match;
    bool is_usable = true;
    for (std::size_t c = 0; c < channels; ++c) {
        match.gains.push_back(
            sums.estimate([c](const std::vector<double>& sum) { return sum[2 * c] / sum[2 * c + 1]; }));
        const auto& [gain, error] = match.gains.back();
        is_usable = is_usable && std::isfinite(gain) && gain > 0.0;
        match.is_matched = match.is_matched || (std::abs(gain - 1.0) > kStandardErrors * error &&
                                                std::abs(std::log2(gain)) > kLeastExposure_ev);
    }
    if (!is_usable) {
        match.is_matched = false;
        match.gains.clear();
        match.reason = "one of the pictures is black, or clipped, wherever they can be compared";
    } else if (match.is_matched) {
        match.reason = "a gain a channel";
    } else {
        match.reason =
            fmt::format("no channel differs by {:g} standard errors and {} EV", kStandardErrors, kLeastExposure_ev);
    }
    return match;
}

void apply(const ExposureMatch& match, formats::Image& image) {
    if (!match.is_matched) {
        return;
    }
    const std::size_t channels = image.channels.size();
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        image.pixels[i] = static_cast<float>(match.gains[i % channels].value * static_cast<double>(image.pixels[i]));
    }
}

}  // namespace lensproof::calibration
