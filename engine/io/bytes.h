// engine/io/bytes.h — numbers as this machine's bytes: what caches are keyed by and hold.
#pragma once
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace lensproof {

template <class T>
concept Number = std::is_arithmetic_v<T> || std::is_enum_v<T>;

template <Number T>
void append_bytes(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace lensproof
