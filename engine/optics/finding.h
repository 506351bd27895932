// engine/optics/finding.h — something worth saying about a prescription: by its reader, or by its checker.
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/infinity.h"

namespace lensproof::optics {

enum class Severity { info, warning, error };

constexpr std::string_view severity_name(Severity severity) {
    constexpr std::array<std::string_view, 3> kNames = {"info", "warning", "error"};
    return kNames[static_cast<std::size_t>(severity)];
}

/// One finding. `value` and `limit` are NaN where there is nothing to measure.
struct Finding {
    std::string code;  // "edge-thickness": what scripts ask for
    Severity severity = Severity::warning;
    int surface = 0;  // counted from 1, the stop included; 0: the lens as a whole
    std::string message;
    double value = kNaN;
    double limit = kNaN;
    std::string unit;  // of value and limit; empty: a bare number
};

}  // namespace lensproof::optics
