#include "calibration/comparison/structural_similarity.h"

#include <opencv2/imgproc.hpp>

#include "calibration/comparison/stripes.h"

namespace lensproof::calibration {

namespace {

constexpr double kSigma_px = 1.5;
constexpr double kC1 = 0.01 * 0.01;
constexpr double kC2 = 0.03 * 0.03;

/// One channel of rows, in double precision: variances are differences of squares.
cv::Mat channel_rows(const formats::Image& image, std::size_t channel, const Stripe& stripe) {
    cv::Mat rows(stripe.padded_last - stripe.padded_first, image.width, CV_64F);
    for (int y = 0; y < rows.rows; ++y) {
        for (int x = 0; x < rows.cols; ++x) {
            rows.at<double>(y, x) = image.at(x, y + stripe.padded_first, static_cast<int>(channel));
        }
    }
    return rows;
}

cv::Mat windowed(const cv::Mat& rows) {
    const cv::Mat kernel = cv::getGaussianKernel(2 * kSsimReach_px + 1, kSigma_px, CV_64F);
    cv::Mat means;
    cv::sepFilter2D(rows, means, CV_64F, kernel, kernel, {-1, -1}, 0.0, cv::BORDER_REFLECT);
    return means;
}

/// Adds a channel's part of the mean over channels.
void add_channel(const formats::Image& a, const formats::Image& b, std::size_t channel, const Stripe& stripe,
                 formats::Image& map) {
    const cv::Mat rows_a = channel_rows(a, channel, stripe);
    const cv::Mat rows_b = channel_rows(b, channel, stripe);
    const cv::Mat mean_a = windowed(rows_a);
    const cv::Mat mean_b = windowed(rows_b);
    const cv::Mat squares = windowed(rows_a.mul(rows_a) + rows_b.mul(rows_b));
    const cv::Mat products = windowed(rows_a.mul(rows_b));
    for (int y = stripe.first; y < stripe.last; ++y) {
        const int row = y - stripe.padded_first;
        for (int x = 0; x < a.width; ++x) {
            const double ma = mean_a.at<double>(row, x);
            const double mb = mean_b.at<double>(row, x);
            const double similarity =
                (2.0 * ma * mb + kC1) * (2.0 * (products.at<double>(row, x) - ma * mb) + kC2) /
                ((ma * ma + mb * mb + kC1) * (squares.at<double>(row, x) - ma * ma - mb * mb + kC2));
            map.at(x, y, 0) += static_cast<float>(similarity / static_cast<double>(a.channels.size()));
        }
    }
}

}  // namespace

formats::Image structural_similarity(const formats::Image& a, const formats::Image& b, int threads) {
    formats::Image map = formats::make_image(a.width, a.height, {"ssim"});
    for_stripes(a.height, kSsimReach_px, threads, [&](const Stripe& stripe) {
        for (std::size_t channel = 0; channel < a.channels.size(); ++channel) {
            add_channel(a, b, channel, stripe, map);
        }
    });
    return map;
}

}  // namespace lensproof::calibration
