// engine/optics/glass_name.h — how the names of glasses are written, and codes that stand for them.
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace lensproof::optics {

/// Whether two names have the same characters, letter case aside.
bool same_letters(std::string_view a, std::string_view b);

/// Whether two names have the same letters and digits, case and everything else aside: N-LAK9, nlak9, N LAK9.
bool same_spelling(std::string_view a, std::string_view b);

/// A name's letters and digits, in capitals.
std::string bare_name(std::string_view name);

/// n_d and V_d from a six-digit code and its kin: 517642, 517642.251 (SCHOTT, with the density), 517.642 and
/// 516800.641700 (CODE V), 1.517:64.2. A code of three digits drops the 1 of n_d, and above 2 the 2: 001291 is 2.001.
/// Nothing where `text` is no such code.
struct GlassCode {
    double n_d = 1.0;
    double V_d = 0.0;
};
std::optional<GlassCode> parse_glass_code(std::string_view text);

}  // namespace lensproof::optics
