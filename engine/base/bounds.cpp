#include "engine/base/bounds.h"

#include <fmt/format.h>

namespace lensproof {

std::string Bounds::expectation() const {
    const char* const from = min_excluded ? "above" : "of at least";
    if (min <= -1e300 && max >= 1e300) {
        return "a finite number";
    }
    if (max >= 1e300) {
        return fmt::format("a finite number {} {}", from, min);
    }
    return fmt::format("a number {} {} and at most {}", from, min, max);
}

}  // namespace lensproof
