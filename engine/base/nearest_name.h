// engine/base/nearest_name.h — what a misspelt name may have meant.
#pragma once
#include <string>
#include <vector>

namespace lensproof {

/// "; did you mean \"white\"?" for the known name with the fewest letters to change, add or drop (Levenshtein's
/// distance), where those are at most a third of its letters, and at least one; else, of ten names at most, "; known
/// are: white, red"; else nothing.
std::string name_hint(const std::string& name, const std::vector<std::string>& known);

}  // namespace lensproof
