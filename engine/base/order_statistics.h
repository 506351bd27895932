// engine/base/order_statistics.h — medians and quantiles, which few bad values do not move.
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace lensproof {

/// σ of a normal distribution over the median magnitude of its deviations.
inline constexpr double kSigmaPerMedian = 1.4826;

/// The value at `place`, from 0, were they in order. Both functions below, too, reorder the values, of which there is
/// at least one.
template <class T>
T nth_value(std::vector<T>& values, std::size_t place) {
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(place);
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
}

/// The one below which the fraction `fraction` of the others lies, rounded downwards.
template <class T>
T quantile(std::vector<T>& values, double fraction) {
    return nth_value(values, static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1)));
}

/// The middle one; of an even number the upper of the two.
template <class T>
T median(std::vector<T>& values) {
    return nth_value(values, values.size() / 2);
}

}  // namespace lensproof
