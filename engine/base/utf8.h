// engine/base/utf8.h — the letters of a text in UTF-8 (RFC 3629).
#pragma once
#include <cstddef>
#include <string_view>

namespace lensproof {

inline constexpr char32_t kNoLetter = 0xfffd;

struct Letter {
    char32_t code = kNoLetter;
    std::size_t bytes = 1;
};

/// The letter that `text`, which is not empty, begins with; the replacement, of one byte, where that is no UTF-8.
Letter first_letter(std::string_view text);

}  // namespace lensproof
