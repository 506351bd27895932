// engine/base/json_number.h — numbers for JSON, which knows neither NaN nor infinity.
#pragma once
#include <cmath>
#include <nlohmann/json.hpp>

namespace lensproof {

/// A number, or null where there is none.
inline nlohmann::ordered_json number_or_null(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace lensproof
