#include "engine/base/hash.h"

#include <OpenImageIO/hash.h>
#include <fmt/format.h>

namespace lensproof {

std::uint64_t hash_of(std::string_view bytes, std::uint64_t seed) {
    return OIIO::xxhash::XXH64(bytes.data(), bytes.size(), seed);
}

std::string hash_text(std::string_view bytes) {
    return fmt::format("{:016x}", hash_of(bytes));
}

}  // namespace lensproof
