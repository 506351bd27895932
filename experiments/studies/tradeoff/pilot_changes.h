// experiments/studies/tradeoff/pilot_changes.h — what an effect of the lens does to a picture, done to the picture.
#pragma once
#include <functional>
#include <vector>

#include "engine/base/vec.h"
#include "engine/formats/image/image.h"

namespace lensproof::studies {

/// A number over the image height, linear between the means of rings; beyond the outermost as there.
class RadialMean {
  public:
    struct Sample {
        double image_height = 0.0;
        double value = 0.0;
    };
    RadialMean(std::vector<Sample> samples, int rings);

    [[nodiscard]] double at(double image_height) const;

  private:
    std::vector<Sample> rings_;
};

/// Each returns a changed copy of a linear RGB picture.
using PixelGain = std::function<Vec3d(int x, int y)>;
formats::Image with_gain(const formats::Image& picture, const PixelGain& gain);

/// R, G and B at (x, y) come from `shift(x, y, channel)` px farther on, by bilinear interpolation; from beyond the
/// frame as from its edge.
using PixelShift = std::function<Vec2d(int x, int y, int channel)>;
formats::Image with_shift(const formats::Image& picture, const PixelShift& shift);

/// Each pixel's light is spread as a lattice's Gaussian of that rms radius (√2 of its σ along an axis), px, cut a pixel
/// beyond three σ, with what is spread kept. Narrow ones spread as much as they do at edges that lie anywhere between
/// pixels.
using PixelSpread = std::function<double(int x, int y)>;
formats::Image with_spread(const formats::Image& picture, const PixelSpread& spread);

/// The mean over a picture of R, G and B; and that fraction of it added everywhere.
Vec3d mean_rgb(const formats::Image& picture);
formats::Image with_veil(const formats::Image& picture, double fraction);

}  // namespace lensproof::studies
