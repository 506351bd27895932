// engine/optics/finding.h — something worth saying about a prescription: by its reader, or by its checker.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace lensproof::optics {

enum class Severity { info, warning, error };

constexpr std::string_view severity_name(Severity severity) {
    switch (severity) {
        case Severity::info:
            return "info";
        case Severity::warning:
            return "warning";
        case Severity::error:
            break;
    }
    return "error";
}

/// One finding. `value` and `limit` are NaN where there is nothing to measure.
struct Finding {
    std::string code;  // "edge-thickness": what scripts ask for
    Severity severity = Severity::warning;
    int surface = 0;  // counted from 1, the stop included; 0: the lens as a whole
    std::string message;
    double value = kNothing;
    double limit = kNothing;
    std::string unit;  // of value and limit; empty: a bare number

    static constexpr double kNothing = __builtin_nan("");
};

}  // namespace lensproof::optics
