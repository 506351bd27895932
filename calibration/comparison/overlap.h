// calibration/comparison/overlap.h — which pixels two pictures have in common, and means over them.
#pragma once
#include <cmath>
#include <functional>
#include <vector>

#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// Of a picture's pixels, rows from the top, whether the other picture shows the same place: 255, else 0.
using Overlap = std::vector<unsigned char>;

Overlap whole_frame(const formats::Image& image);

/// Of a whole frame only those pixels stay that lie `margin` px or farther from the frame's edge and from any that is
/// not in common.
Overlap shrunk(const Overlap& overlap, int width, int height, int margin);

/// A number with one standard error.
struct Estimate {
    double value = std::nan("");
    double standard_error = 0.0;
};

/// Sums over the blocks into which a picture is divided, 8 × 8 or as many as have 8 px a side.
class BlockSums {
  public:
    BlockSums(int width, int height, int sums);

    [[nodiscard]] int block_count() const { return across_ * down_; }
    /// The first row and the one behind the last of a row of blocks, and how many such rows there are.
    [[nodiscard]] int first_row(int band) const { return static_cast<int>(static_cast<long>(height_) * band / down_); }
    [[nodiscard]] int bands() const { return down_; }

    /// The sums of the block of pixel x in a row of blocks.
    [[nodiscard]] double* at(int x, int band) {
        const auto block = static_cast<std::size_t>(band) * static_cast<std::size_t>(across_) +
                           static_cast<std::size_t>(static_cast<long>(x) * across_ / width_);
        return sums_.data() + block * static_cast<std::size_t>(size_);
    }

    /// `statistic` of the sums over all blocks. Its standard error is that of the jackknife, which leaves one block out
    /// after another (Miller 1974), so that what neighbouring pixels have in common counts once.
    [[nodiscard]] Estimate estimate(const std::function<double(const std::vector<double>&)>& statistic) const;

  private:
    int width_;
    int height_;
    int size_;
    int across_;
    int down_;
    std::vector<double> sums_;
};

/// The mean of a map of one channel over what is in common. NaN where nothing is.
Estimate mean_over(const formats::Image& map, const Overlap& overlap);

}  // namespace lensproof::calibration
