// engine/base/bytes.h — numbers as this machine's bytes: what caches are keyed by and hold.
#pragma once
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace lensproof {

/// Appends the numbers' bytes, one number after the other.
template <class... Numbers>
requires(... && (std::is_arithmetic_v<Numbers> ||
                 std::is_enum_v<Numbers>)) void append_bytes(std::string& bytes, const Numbers&... numbers) {
    (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof numbers), ...);
}

/// Takes a number from the front of the bytes; nothing where they are too few.
template <class Number>
requires std::is_arithmetic_v<Number> std::optional<Number> take_bytes(std::string_view& bytes) {
    Number number{};
    if (bytes.size() < sizeof number) {
        return std::nullopt;
    }
    std::memcpy(&number, bytes.data(), sizeof number);
    bytes.remove_prefix(sizeof number);
    return number;
}

}  // namespace lensproof
