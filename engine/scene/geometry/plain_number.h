// engine/scene/geometry/plain_number.h — numbers of meshes' texts as every reader reads them.
#pragma once
#include <fmt/format.h>

#include <string>
#include <string_view>

namespace lensproof::scene {

/// A float of this value, which `word` says: written anew where it is long, since Assimp takes what is past 19 digits
/// for the next number.
inline std::string plain_number(std::string_view word, double value) {
    constexpr std::size_t kShort = 16;
    return word.size() > kShort ? fmt::format("{:.9g}", value) : std::string(word);
}

}  // namespace lensproof::scene
