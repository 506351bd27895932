#include "engine/base/bounds.h"

#include <fmt/format.h>

namespace lensproof {

std::string Bounds::expectation() const {
    if (min == 0.0 && min_excluded && max >= 1e300) {
        return "a positive number";
    }
    if (min <= -1e300 && max >= 1e300) {
        return "a finite number";
    }
    if (max >= 1e300) {
        return fmt::format("a number of at least {}", min);
    }
    return fmt::format("a number {} {} and at most {}", min_excluded ? "above" : "of at least", min, max);
}

}  // namespace lensproof
