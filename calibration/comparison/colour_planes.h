// calibration/comparison/colour_planes.h — pictures' pixels as colours and as the values that a display shows.
#pragma once
#include "engine/base/vec.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// A picture that metrics of images take: R, G, B, or grey. Whether it is one.
bool is_shown(const formats::Image& image);

/// The pixel's linear R, G, B; of a grey one the same three times.
inline Vec3d rgb_at(const formats::Image& image, std::size_t pixel) {
    const std::size_t channels = image.channels.size();
    const float* value = image.pixels.data() + pixel * channels;
    return {static_cast<double>(value[0]), static_cast<double>(value[channels < 3 ? 0 : 1]),
            static_cast<double>(value[channels < 3 ? 0 : 2])};
}

/// Y of linear sRGB (IEC 61966-2-1), white 1.
inline double luminance(const Vec3d& rgb) {
    return 0.212639 * rgb.x + 0.715169 * rgb.y + 0.072192 * rgb.z;
}

/// X, Y, Z of linear sRGB, white's Y 1; and of white.
Vec3d xyz_of(const Vec3d& linear_rgb);
Vec3d rgb_of(const Vec3d& xyz);
extern const Vec3d kWhite;

/// Luminance, one float a pixel.
formats::Image luminance_of(const formats::Image& image);

/// sRGB's values of the picture, 0 to 1: what lies outside is clipped, as on a display.
formats::Image displayed(const formats::Image& image, int threads);

}  // namespace lensproof::calibration
