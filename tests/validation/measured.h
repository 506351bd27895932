// tests/validation/measured.h — numbers by chance, and how far off they may be.
#pragma once

#include <cmath>
#include <numeric>
#include <span>

namespace lensproof {

/// A number with its standard error.
struct Measured {
    double value = 0.0;
    double error = 0.0;
};

/// Of independent values.
inline Measured mean_of(std::span<const double> values) {
    const auto count = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
    double squares = 0.0;
    for (const double value : values) {
        squares += (value - mean) * (value - mean);
    }
    return {mean, std::sqrt(squares / (count * (count - 1.0)))};
}

}  // namespace lensproof
