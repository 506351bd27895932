// experiments/draw/ticks.h — where an axis has its marks, and the numbers beside them.
#pragma once
#include <string>
#include <vector>

namespace lensproof::draw {

enum class AxisScale { linear, logarithmic };

/// Marks of an axis, ascending and all within its range.
struct Ticks {
    std::vector<double> major;
    std::vector<double> minor;        // none of them is a major one
    std::vector<std::string> labels;  // one for each major mark, all with the same number of decimals
    int exponent = 0;                 // labels are to be multiplied by 10^exponent, which belongs beside the unit
};

/// Major marks every 1, 2 or 5 times a power of ten, at most `most` (at least 2) of them; minor ones at a fifth, a
/// quarter or a fifth of that. Each mark is the double nearest to the decimal number it is labelled with. `low` <
/// `high`, both finite. The exponent is a multiple of 3, and 0 for numbers between 0.001 and 100 000.
Ticks linear_ticks(double low, double high, int most);

/// Major marks at powers of ten (every second, third, fifth … decade where there are many), minor ones at 2 … 9 times
/// them; over less than two decades at 1, 2 and 5, and over less than a factor of about 5 as on a linear axis. 0 <
/// `low` < `high`.
Ticks log_ticks(double low, double high, int most);

/// The smallest range that holds [low, high] and ends at minor marks of its own.
struct AxisRange {
    double low = 0.0;
    double high = 1.0;
};
AxisRange rounded_outwards(AxisRange range, int most);

/// The whole decades around [low, high], or 1-2-5 steps where it spans less than one. 0 < low <= high.
AxisRange log_rounded_outwards(AxisRange range);

/// A number with `decimals` digits after the point and a true minus sign; never "-0".
std::string decimal_text(double value, int decimals);

/// 10ⁿ, with the exponent raised: "10⁻⁹".
std::string power_of_ten_text(int exponent);

/// A number for a caption: `digits` significant ones, trailing zeros dropped, a true minus sign, from 10⁵ on and below
/// 10⁻³ as "1.2×10⁻⁶"; "—" for what is not finite.
std::string short_number(double value, int digits = 3);

}  // namespace lensproof::draw
