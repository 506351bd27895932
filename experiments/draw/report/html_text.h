// experiments/draw/report/html_text.h — data and numbers as a page has them.
#pragma once
#include <optional>
#include <string>

#include "engine/base/json.h"

namespace lensproof::draw {

/// The compact JSON as it can stand inside <script type="application/json">: <, > and & are written \u003c, \u003e and
/// \u0026, so that no string can end the element or open a comment. A NaN becomes null, bytes that are not UTF-8 become
/// U+FFFD. JSON.parse gives the same value back.
std::string json_for_script(const Json& json);

/// A number for a reader: up to six significant digits, no trailing zeros, a real minus sign; "—" for NaN and ±inf.
std::string number_text(double value);

/// An error for a reader: two significant digits.
std::string floor_text(double value);

/// "0.0421 ± 0.0031": the uncertainty with two significant digits and the value to the same place. Without a usable
/// `sigma` (none, zero, NaN) the value alone.
std::string measurement_text(double value, std::optional<double> sigma);

}  // namespace lensproof::draw
