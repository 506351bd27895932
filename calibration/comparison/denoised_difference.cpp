#include "calibration/comparison/denoised_difference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calibration/comparison/colour_planes.h"
#include "engine/base/order_statistics.h"

namespace lensproof::calibration {

namespace {

constexpr std::size_t kTones = 16;
constexpr double kWindow_px = 2.0;
constexpr double kThreshold = 2.0;      // standard deviations
constexpr double kNoiseMaskNorm = 6.0;  // root of the sum of the mask's squares

cv::Mat matrix_of(formats::Image& image) {
    return {image.height, image.width, CV_32F, image.pixels.data()};
}

/// The tones between the classes, ascending.
std::vector<float> tone_limits(const formats::Image& luminance) {
    std::vector<float> sample;
    const std::size_t step = std::max<std::size_t>(1, luminance.pixels.size() / 65536);
    for (std::size_t i = 0; i < luminance.pixels.size(); i += step) {
        sample.push_back(luminance.pixels[i]);
    }
    std::ranges::sort(sample);
    std::vector<float> limits;
    for (std::size_t i = 1; i < kTones; ++i) {
        limits.push_back(sample[i * sample.size() / kTones]);
    }
    return limits;
}

std::size_t tone_of(const std::vector<float>& limits, float value) {
    return static_cast<std::size_t>(std::ranges::upper_bound(limits, value) - limits.begin());
}

/// The noise's standard deviation by tone.
std::array<double, kTones> noise_by_tone(formats::Image& difference, const formats::Image& tones,
                                         const std::vector<float>& limits, const Overlap& overlap) {
    const cv::Mat mask = (cv::Mat_<float>(3, 3) << 1, -2, 1, -2, 4, -2, 1, -2, 1);
    cv::Mat response;
    cv::filter2D(matrix_of(difference), response, CV_32F, mask, {-1, -1}, 0.0, cv::BORDER_REFLECT_101);
    std::array<std::vector<float>, kTones> responses;
    for (int y = 1; y + 1 < difference.height; ++y) {
        for (int x = 1; x + 1 < difference.width; ++x) {
            const auto pixel =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(difference.width) + static_cast<std::size_t>(x);
            if (overlap[pixel] != 0) {
                responses[tone_of(limits, tones.pixels[pixel])].push_back(std::abs(response.at<float>(y, x)));
            }
        }
    }
    std::array<double, kTones> noise{};
    for (std::size_t tone = 0; tone < kTones; ++tone) {
        noise[tone] = responses[tone].empty()
                          ? 0.0
                          : kSigmaPerMedian / kNoiseMaskNorm * static_cast<double>(median(responses[tone]));
    }
    return noise;
}

}  // namespace

DenoisedDifference denoised_difference(const formats::Image& a, const formats::Image& b, const Overlap& overlap) {
    DenoisedDifference result{.map = luminance_of(b)};
    const formats::Image tones = luminance_of(a);
    formats::Image& map = result.map;
    for (std::size_t i = 0; i < map.pixels.size(); ++i) {
        map.pixels[i] = overlap[i] == 0 ? 0.0F : map.pixels[i] - tones.pixels[i];
    }
    const std::vector<float> limits = tone_limits(tones);
    std::array<double, kTones> noise = noise_by_tone(map, tones, limits, overlap);
    cv::Mat means;
    cv::GaussianBlur(matrix_of(map), means, {0, 0}, kWindow_px, kWindow_px, cv::BORDER_REFLECT);
    const double variance_left = 1.0 / (4.0 * std::numbers::pi * kWindow_px * kWindow_px);
    double quiet = 0.0;
    double common = 0.0;
    for (std::size_t i = 0; i < map.pixels.size(); ++i) {
        const auto mean = static_cast<double>(means.ptr<float>()[i]);
        const double sigma = noise[tone_of(limits, tones.pixels[i])];
        const double left =
            mean == 0.0 ? 0.0 : 1.0 - kThreshold * kThreshold * sigma * sigma * variance_left / (mean * mean);
        map.pixels[i] = overlap[i] == 0 ? 0.0F : static_cast<float>(mean * std::max(0.0, left));
        common += overlap[i] == 0 ? 0.0 : 1.0;
        quiet += overlap[i] != 0 && left <= 0.0 ? 1.0 : 0.0;
    }
    std::vector<double> all(noise.begin(), noise.end());
    result.noise = median(all);
    result.noise_fraction = common > 0.0 ? quiet / common : 0.0;
    return result;
}

}  // namespace lensproof::calibration
