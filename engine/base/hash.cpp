#include "engine/base/hash.h"

#include <fmt/format.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace lensproof {

std::uint64_t hash_of(std::string_view bytes, std::uint64_t seed) {
    return XXH64(bytes.data(), bytes.size(), seed);
}

std::string hash_text(std::string_view bytes) {
    return fmt::format("{:016x}", hash_of(bytes));
}

}  // namespace lensproof
