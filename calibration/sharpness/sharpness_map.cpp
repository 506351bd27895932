#include "calibration/sharpness/sharpness_map.h"

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"

namespace lensproof::calibration {
namespace {

constexpr int kColumns = 31;
constexpr int kRows = 21;
constexpr double kMapReach = 1.0 / 12.0;  // of the diagonal

struct WeighedValue {
    double value = 0.0;
    double weight = 0.0;
};

// The first value up to which lies half the weight; NaN of none.
double weighed_median(std::vector<WeighedValue> values) {
    std::ranges::sort(values, {}, &WeighedValue::value);
    double left = 0.0;
    for (const WeighedValue& v : values) {
        left += 0.5 * v.weight;
    }
    for (const WeighedValue& v : values) {
        left -= v.weight;
        if (left <= 0.0) {
            return v.value;
        }
    }
    return kNaN;
}

}  // namespace

SharpnessMap sharpness_map(const std::vector<EdgeMtf>& edges, int width_px, int height_px) {
    SharpnessMap map{.columns = kColumns, .rows = kRows, .mtf50_cycles_per_px = {}};
    const double sigma = kMapReach * std::hypot(width_px, height_px);
    for (int row = 0; row < kRows; ++row) {
        for (int column = 0; column < kColumns; ++column) {
            const Vec2d knot{(width_px - 1.0) * column / (kColumns - 1), (height_px - 1.0) * row / (kRows - 1)};
            std::vector<WeighedValue> near;
            for (const EdgeMtf& edge : edges) {
                const double apart = length(edge.centre_px - knot) / sigma;
                if (edge.mtf50 && apart < 2.0) {
                    near.push_back({edge.mtf50->cycles_per_px, std::exp(-0.5 * apart * apart)});
                }
            }
            map.mtf50_cycles_per_px.push_back(weighed_median(std::move(near)));
        }
    }
    return map;
}

}  // namespace lensproof::calibration
