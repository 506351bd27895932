#include "calibration/picture/flat_field_traits.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "calibration/detection/pixel_noise.h"

namespace lensproof::calibration {

FlatFieldTraits flat_field_traits(const formats::Image& image, int channel) {
    constexpr int kSmallest_px = 8;
    constexpr int kParts = 40;  // of a side, of which the middle two are looked at
    if (image.width < kSmallest_px || image.height < kSmallest_px) {
        return {};
    }
    const int from_x = image.width / 2 - std::max(1, image.width / kParts);
    const int from_y = image.height / 2 - std::max(1, image.height / kParts);
    double sum = 0.0;
    int count = 0;
    for (int y = from_y; y <= image.height - 1 - from_y; ++y) {
        for (int x = from_x; x <= image.width - 1 - from_x; ++x) {
            const auto light = static_cast<double>(image.at(x, y, channel));
            sum += std::isfinite(light) ? light : 0.0;
            count += std::isfinite(light) ? 1 : 0;
        }
    }
    if (count == 0) {
        return {};
    }
    return {.white = sum / count, .noise = pixel_noise(image, channel)};
}

}  // namespace lensproof::calibration
