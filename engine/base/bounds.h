// engine/base/bounds.h — what a number that is read may be.
#pragma once
#include <string>

namespace lensproof {

/// Bounds on a number, both inclusive unless said otherwise.
struct Bounds {
    double min = -1e300;
    double max = 1e300;
    bool min_excluded = false;

    /// Whether `value` lies inside. NaN and the infinities never do.
    [[nodiscard]] bool hold(double value) const {
        return value >= min && value <= max && !(min_excluded && value == min);
    }
    /// In words, to stand behind "expected": "a finite number above 0".
    [[nodiscard]] std::string expectation() const;
};

inline constexpr Bounds kAnyNumber{};
inline constexpr Bounds kPositive{.min = 0.0, .min_excluded = true};
inline constexpr Bounds kNotNegative{.min = 0.0};

}  // namespace lensproof
