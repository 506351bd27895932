// calibration/self_test/blur_filter.h — a lens's blur and the pixels' own box, in one sum.
#pragma once
#include <opencv2/core.hpp>
#include <vector>

namespace lensproof::calibration {

/// Makes pixels of light on a grid of `kSubpixels` × `kSubpixels` places a pixel: a Gaussian, to four standard
/// deviations, and the mean over the pixel's own. Only what arrives in a pixel is summed.
class BlurFilter {
  public:
    static constexpr int kSubpixels = 4;  // along a pixel's side

    /// `blur_px`: the Gaussian's standard deviation; 0: the box alone.
    explicit BlurFilter(double blur_px);

    /// Whole pixels on each side of one that it needs.
    [[nodiscard]] int reach_px() const { return (reach_ + kSubpixels - 1) / kSubpixels; }

    /// Fills `pixels` (CV_32F), whose first one's first sub-pixel is `first` of `fine` (CV_32F), which holds what they
    /// need around them.
    void apply(const cv::Mat& fine, const cv::Point& first, cv::Mat pixels) const;

  private:
    int reach_ = 0;  // sub-pixels on each side of a pixel's own
    std::vector<float> weights_;
};

}  // namespace lensproof::calibration
