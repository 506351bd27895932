// engine/base/nearest_name.h — what a misspelt name may have meant.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace lensproof {

/// How many letters have to be changed, added, dropped or swapped with their neighbour (each at
/// most once) to make `a` into `b` (Damerau 1964; Levenshtein 1966).
int spelling_distance(std::string_view a, std::string_view b);

/// "; did you mean \"white\"?" for the known name with the fewest letters to change, add, drop or swap, if these are at
/// most a third of its letters, or one; else, of ten names at most, "; known are: white, red"; else nothing.
std::string name_hint(const std::string& name, const std::vector<std::string>& known);

/// "; is \"shuter_s\" meant to be it?" where one of those that stand there is `missing` but for less than a third of
/// its letters; else nothing.
std::string missing_name_hint(const std::string& missing, const std::vector<std::string>& there);

/// The nearest, where there is one, and all that are known, however many.
std::string complete_name_hint(const std::string& name, const std::vector<std::string>& known);

}  // namespace lensproof
