// engine/formats/image/srgb.h — the transfer curve between linear light and sRGB's values (IEC 61966-2-1), full
// scale 1.
#pragma once
#include <algorithm>
#include <cmath>

namespace lensproof::formats {

inline float srgb_to_linear(float encoded) {
    return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

/// What lies outside [0, 1] is clipped.
inline float linear_to_srgb(float linear) {
    const float clipped = std::clamp(linear, 0.0F, 1.0F);
    return clipped <= 0.0031308F ? 12.92F * clipped : 1.055F * std::pow(clipped, 1.0F / 2.4F) - 0.055F;
}

/// The same as a byte, 255 at full scale, to the nearest: by a table, for millions of pixels.
unsigned char linear_to_srgb_byte(float linear);

}  // namespace lensproof::formats
