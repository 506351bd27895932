#include "calibration/statistics/curve.h"

#include <algorithm>
#include <cmath>

namespace lensproof::calibration {

std::vector<double> standard_image_heights() {
    constexpr int steps = 40;
    std::vector<double> heights;
    for (int i = 0; i <= steps; ++i) {
        heights.push_back(static_cast<double>(i) / steps);
    }
    return heights;
}

void append(Curve& curve, double image_height, const Banded& sample) {
    curve.image_height.push_back(image_height);
    curve.value.push_back(sample.value);
    curve.lower_95.push_back(sample.lower_95);
    curve.upper_95.push_back(sample.upper_95);
}

void append_exact(Curve& curve, double image_height, double value) {
    append(curve, image_height, {.value = value, .lower_95 = value, .upper_95 = value});
    curve.covered_image_height = image_height;
}

std::optional<Banded> sample(const Curve& curve, double image_height) {
    const auto& heights = curve.image_height;
    if (heights.empty() || !(image_height >= heights.front() && image_height <= heights.back())) {
        return std::nullopt;
    }
    const auto upper = std::lower_bound(heights.begin(), heights.end(), image_height) - heights.begin();
    const auto lower = std::max<std::ptrdiff_t>(upper - 1, 0);
    const double span = heights[upper] - heights[lower];
    const double fraction = span > 0.0 ? (image_height - heights[lower]) / span : 0.0;
    const auto between = [&](const std::vector<double>& v) { return std::lerp(v[lower], v[upper], fraction); };
    return Banded{between(curve.value), between(curve.lower_95), between(curve.upper_95)};
}

}  // namespace lensproof::calibration
