#include "calibration/self_test/blur_filter.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace lensproof::calibration {

BlurFilter::BlurFilter(double blur_px) {
    constexpr double kReach = 4.0;  // standard deviations
    const double sigma = blur_px * kSubpixels;
    reach_ = static_cast<int>(std::ceil(kReach * sigma));
    const cv::Mat gaussian =
        blur_px > 0.0 ? cv::getGaussianKernel(2 * reach_ + 1, sigma, CV_64F) : cv::Mat::ones(1, 1, CV_64F);
    weights_.resize(gaussian.total() + kSubpixels - 1);
    for (std::size_t i = 0; i < gaussian.total(); ++i) {
        for (std::size_t j = 0; j < kSubpixels; ++j) {
            weights_[i + j] += static_cast<float>(gaussian.at<double>(static_cast<int>(i)) / kSubpixels);
        }
    }
}

// First down the columns, a row of sub-pixels at a time, then along what is left, a column of pixels at a time: so both
// loops that count run over neighbours in memory.
void BlurFilter::apply(const cv::Mat& fine, const cv::Point& first, cv::Mat pixels) const {
    const auto rows = static_cast<std::size_t>(pixels.rows);
    const auto width = static_cast<std::size_t>(pixels.cols) * kSubpixels + 2 * static_cast<std::size_t>(reach_);
    std::vector<float> line(width);
    std::vector<float> down(width * rows);  // by column
    for (std::size_t y = 0; y < rows; ++y) {
        std::ranges::fill(line, 0.0F);
        const int top = first.y - reach_ + static_cast<int>(y) * kSubpixels;
        for (std::size_t k = 0; k < weights_.size(); ++k) {
            const float* from = fine.ptr<float>(top + static_cast<int>(k)) + (first.x - reach_);
            const float weight = weights_[k];
            for (std::size_t i = 0; i < width; ++i) {
                line[i] += weight * from[i];
            }
        }
        for (std::size_t i = 0; i < width; ++i) {
            down[i * rows + y] = line[i];
        }
    }
    std::vector<float> sums(rows);
    for (int x = 0; x < pixels.cols; ++x) {
        std::ranges::fill(sums, 0.0F);
        const float* column = down.data() + static_cast<std::size_t>(x) * kSubpixels * rows;
        for (const float weight : weights_) {
            for (std::size_t y = 0; y < rows; ++y) {
                sums[y] += weight * column[y];
            }
            column += rows;
        }
        for (std::size_t y = 0; y < rows; ++y) {
            pixels.at<float>(static_cast<int>(y), x) = sums[y];
        }
    }
}

}  // namespace lensproof::calibration
