// engine/io/bytes.h — numbers as this machine's bytes: what caches are keyed by and hold.
#pragma once
#include <string>
#include <type_traits>

namespace lensproof {

/// Appends the numbers' bytes, one number after the other.
template <class... Numbers>
requires(... && (std::is_arithmetic_v<Numbers> ||
                 std::is_enum_v<Numbers>)) void append_bytes(std::string& bytes, const Numbers&... numbers) {
    (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof numbers), ...);
}

}  // namespace lensproof
