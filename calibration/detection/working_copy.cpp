#include "calibration/detection/working_copy.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calibration/statistics/order_statistics.h"

namespace lensproof::calibration {
namespace {

constexpr double kWhitePercentile = 0.995;
constexpr double kLeastStretch = 0.02;  // of white, in linear light: less than a chart's black and white ever differ by

double srgb_encode(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

}  // namespace

cv::Mat channel_plane(const formats::Image& image, int channel) {
    cv::Mat plane(image.height, image.width, CV_32F);
    for (int y = 0; y < image.height; ++y) {
        auto* row = plane.ptr<float>(y);
        for (int x = 0; x < image.width; ++x) {
            const float value = image.at(x, y, channel);
            row[x] = std::isfinite(value) ? value : 0.0F;
        }
    }
    return plane;
}

cv::Mat detector_copy(const formats::Image& image) {
    cv::Mat mean = cv::Mat::zeros(image.height, image.width, CV_32F);
    for (int channel = 0; channel < image.channel_count(); ++channel) {
        mean += channel_plane(image, channel) / static_cast<double>(image.channel_count());
    }
    std::vector<float> values(mean.begin<float>(), mean.end<float>());
    if (values.empty()) {
        return {};
    }
    const float white = quantile(values, kWhitePercentile);
    const float black = quantile(values, 1.0 - kWhitePercentile);
    if (!(white > 0.0F) || white - black < kLeastStretch * white) {
        return {};
    }
    cv::Mat encoded(image.height, image.width, CV_8U);
    std::transform(mean.begin<float>(), mean.end<float>(), encoded.begin<uchar>(), [white](float value) {
        return static_cast<uchar>(std::lround(255.0 * srgb_encode(std::clamp(value / white, 0.0F, 1.0F))));
    });
    return encoded;
}

double light_at(const cv::Mat& plane, const Vec2d& p) {
    const double fx = std::floor(p.x);
    const double fy = std::floor(p.y);
    if (!(fx >= 0.0 && fy >= 0.0 && fx + 1.0 < plane.cols && fy + 1.0 < plane.rows)) {
        return 0.0;
    }
    const int x = static_cast<int>(fx);
    const int y = static_cast<int>(fy);
    const auto at = [&](int i, int j) { return static_cast<double>(plane.at<float>(y + j, x + i)); };
    return std::lerp(std::lerp(at(0, 0), at(1, 0), p.x - fx), std::lerp(at(0, 1), at(1, 1), p.x - fx), p.y - fy);
}

int reference_channel(const formats::Image& image) {
    const int green = formats::find_channel(image, "G");
    return green >= 0 ? green : image.channel_count() / 2;
}

bool all_channels_alike(const formats::Image& image) {
    const auto count = static_cast<std::size_t>(image.channel_count());
    for (std::size_t i = 0; i < image.pixels.size(); i += count) {
        for (std::size_t c = 1; c < count; ++c) {
            if (image.pixels[i + c] != image.pixels[i]) {
                return false;
            }
        }
    }
    return true;
}

}  // namespace lensproof::calibration
