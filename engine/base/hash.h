// engine/base/hash.h — what tells bytes from other bytes, where nobody means harm.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace lensproof {

/// XXH64 (Y. Collet, xxHash specification 0.1.1). Bytes in pieces: the hash of the pieces before is the next one's
/// seed.
std::uint64_t hash_of(std::string_view bytes, std::uint64_t seed = 0);

/// The same as 16 hexadecimal digits.
std::string hash_text(std::string_view bytes);

}  // namespace lensproof
