#include "calibration/comparison/overlap.h"

#include <algorithm>
#include <numeric>
#include <opencv2/imgproc.hpp>

namespace lensproof::calibration {

namespace {

constexpr int kMostBlocks = 8;
constexpr int kSmallestBlock_px = 8;

int blocks_along(int side) {
    return std::clamp(side / kSmallestBlock_px, 1, kMostBlocks);
}

}  // namespace

Overlap whole_frame(const formats::Image& image) {
    return Overlap(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height), 255);
}

Overlap shrunk(const Overlap& overlap, int width, int height, int margin) {
    if (margin == 0) {
        return overlap;
    }
    Overlap result(overlap.size());
    // The library reads through a pointer that it wants to be able to write through.
    const cv::Mat from(height, width, CV_8U, const_cast<unsigned char*>(overlap.data()));
    cv::Mat to(height, width, CV_8U, result.data());
    const int side = 2 * margin + 1;
    cv::erode(from, to, cv::Mat::ones(side, side, CV_8U), {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar::all(0));
    return result;
}

BlockSums::BlockSums(int width, int height, int sums)
    : width_(width),
      height_(height),
      size_(sums),
      across_(blocks_along(width)),
      down_(blocks_along(height)),
      sums_(static_cast<std::size_t>(across_ * down_ * sums), 0.0) {}

Estimate BlockSums::estimate(const std::function<double(const std::vector<double>&)>& statistic) const {
    const auto size = static_cast<std::size_t>(size_);
    std::vector<double> total(size, 0.0);
    for (std::size_t i = 0; i < sums_.size(); ++i) {
        total[i % size] += sums_[i];
    }
    std::vector<double> without;
    std::vector<double> rest(size);
    for (std::size_t block = 0; block < sums_.size(); block += size) {
        for (std::size_t k = 0; k < size; ++k) {
            rest[k] = total[k] - sums_[block + k];
        }
        if (const double one = statistic(rest); rest != total && std::isfinite(one)) {
            without.push_back(one);
        }
    }
    Estimate result{.value = statistic(total)};
    const auto n = static_cast<double>(without.size());
    if (n > 1.0) {
        const double mean = std::accumulate(without.begin(), without.end(), 0.0) / n;
        double squares = 0.0;
        for (const double one : without) {
            squares += (one - mean) * (one - mean);
        }
        result.standard_error = std::sqrt(squares * (n - 1.0) / n);
    }
    return result;
}

Estimate mean_over(const formats::Image& map, const Overlap& overlap) {
    BlockSums sums(map.width, map.height, 2);
    for (int band = 0; band < sums.bands(); ++band) {
        for (int y = sums.first_row(band); y < sums.first_row(band + 1); ++y) {
            for (int x = 0; x < map.width; ++x) {
                const auto pixel =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(x);
                if (overlap[pixel] != 0) {
                    double* block = sums.at(x, band);
                    block[0] += map.pixels[pixel];
                    block[1] += 1.0;
                }
            }
        }
    }
    return sums.estimate([](const std::vector<double>& sum) { return sum[0] / sum[1]; });
}

}  // namespace lensproof::calibration
