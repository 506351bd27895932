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

/// What a report says where it may lack anything: a finite number, and whatever it is as a reader has it.
std::optional<double> as_number(const Json& value);
std::string as_text(const Json& value);

/// The member of an object as it can stand in the page; "" where it has none.
std::string text(const Json& object, const char* key);

/// 21°, but 5 % and 3 px.
std::string with_unit(const std::string& number, const std::string& unit);

inline constexpr std::size_t kSubjectColours = 7;  // --c0 … --c6 in the template

/// Which of the page's colours a subject has; none for an id that no subject has.
std::optional<std::size_t> subject_colour(const Json& report, const Json& id);

/// The class that gives the verdict of a report or a check its shape and colour. A word this page does not know is no
/// pass.
std::string verdict_class(const Json& object);

/// "0.0421 ± 0.0031": the uncertainty with two significant digits and the value to the same place. Without a usable
/// `sigma` (none, zero, NaN) the value alone.
std::string measurement_text(double value, std::optional<double> sigma);

}  // namespace lensproof::draw
