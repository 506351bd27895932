// engine/check/digits.h — what else a number in a table may have been, had it been copied or read wrongly.
#pragma once
#include <string>
#include <vector>

namespace lensproof::check {

struct NumberChange {
    double value = 0.0;
    std::string slip;           // in words: "two digits swapped"
    double unlikelihood = 1.0;  // 1 for slips that happen often, more for others
};

/// The numbers one slip away from `value`, whose digits are those of its shortest decimal form: the sign lost, two
/// neighbouring digits swapped, the decimal point moved, a digit misread, left out or typed twice. Without repetitions
/// and without `value` itself; none for a number that is not finite.
std::vector<NumberChange> plausible_changes(double value);

}  // namespace lensproof::check
