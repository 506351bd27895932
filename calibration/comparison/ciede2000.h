// calibration/comparison/ciede2000.h — the CIE's colour difference of 2000.
#pragma once
#include "engine/base/vec.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// ΔE00 of two colours in CIELAB, k_L = k_C = k_H = 1 (ISO/CIE 11664-6:2014; Sharma, Wu and Dalal 2005, eq. 2 to 22,
/// whose rule for mean hues is taken: of two that lie more than 180° apart, their sum less than 360°, the opposite).
double ciede2000(const Vec3d& lab_a, const Vec3d& lab_b);

/// At each pixel, of two pictures alike in linear light, clipped to what a display of sRGB shows, against its white.
formats::Image ciede2000_map(const formats::Image& a, const formats::Image& b, int threads);

}  // namespace lensproof::calibration
