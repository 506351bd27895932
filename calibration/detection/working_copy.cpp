#include "calibration/detection/working_copy.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/order_statistics.h"
#include "engine/formats/image/srgb.h"

namespace lensproof::calibration {
namespace {

constexpr double kWhitePercentile = 0.995;
constexpr double kLeastStretch = 0.02;  // of white, in linear light: less than a chart's black and white ever differ by

// The channels' mean in each pixel. What is not finite becomes 0.
cv::Mat mean_plane(const formats::Image& image) {
    cv::Mat mean(image.height, image.width, CV_32F);
    const auto count = static_cast<std::size_t>(image.channel_count());
    const float* value = image.pixels.data();
    std::generate_n(mean.ptr<float>(), mean.total(), [&] {
        float sum = 0.0F;
        for (std::size_t c = 0; c < count; ++c, ++value) {
            sum += std::isfinite(*value) ? *value : 0.0F;
        }
        return sum / static_cast<float>(count);
    });
    return mean;
}

// Values of pixels that are spread over the plane, so that columns and rows of what it shows do not matter: a million,
// which say a percentile as well as all do.
std::vector<float> spread_values(const cv::Mat& plane) {
    const auto step = static_cast<int>(plane.total() / 1'000'000 + 1);
    std::vector<float> values;
    for (int y = 0; y < plane.rows; ++y) {
        for (int x = 7 * y % step; x < plane.cols; x += step) {
            values.push_back(plane.at<float>(y, x));
        }
    }
    return values;
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
    const cv::Mat mean = mean_plane(image);
    std::vector<float> values = spread_values(mean);
    if (values.empty()) {
        return {};
    }
    const float white = quantile(values, kWhitePercentile);
    const float black = quantile(values, 1.0 - kWhitePercentile);
    if (!(white > 0.0F) || white - black < kLeastStretch * white) {
        return {};
    }
    cv::Mat encoded(image.height, image.width, CV_8U);
    std::transform(mean.ptr<float>(), mean.ptr<float>() + mean.total(), encoded.ptr<uchar>(),
                   [white](float value) { return formats::linear_to_srgb_byte(value / white); });
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
