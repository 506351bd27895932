#include "experiments/studies/measurement_floor/floor_point.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"

namespace lensproof::studies {

FloorPoint rms_point(double value, const std::vector<double>& errors) {
    std::vector<double> squares;
    for (const double error : errors) {
        if (std::isfinite(error)) {
            squares.push_back(error * error);
        }
    }
    FloorPoint point{.value = value, .error = kNaN, .sigma = 0.0};
    point.trials = static_cast<int>(errors.size());
    point.failed = static_cast<int>(errors.size() - squares.size());
    point.found_percent = 100.0 * static_cast<double>(squares.size()) / static_cast<double>(errors.size());
    if (squares.empty()) {
        return point;
    }
    const auto n = static_cast<double>(squares.size());
    double mean = 0.0;
    for (const double square : squares) {
        mean += square / n;
    }
    double variance = 0.0;
    for (const double square : squares) {
        variance += (square - mean) * (square - mean) / std::max(1.0, n - 1.0);
    }
    point.error = std::sqrt(mean);
    point.sigma = n < 2.0             ? kNaN  // one number does not scatter
                  : point.error > 0.0 ? std::sqrt(variance / n) / (2.0 * point.error)
                                      : 0.0;
    return point;
}

std::string failed_in_words(const FloorPoint& point) {
    return point.failed == 0 ? "" : fmt::format(" {} of {} failed.", point.failed, point.trials);
}

}  // namespace lensproof::studies
