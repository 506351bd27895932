// engine/base/look_up.h — numbers from tables, for one number or for several in step.
#pragma once
#include <cstdint>

namespace lensproof {

/// An index into tables.
template <class T>
class NumberIndex {
  public:
    /// From whole numbers; of others the whole part.
    constexpr explicit NumberIndex(const T& number) : at_(static_cast<std::int32_t>(number)) {}

    template <class Entry>
    [[nodiscard]] constexpr T look_up(const Entry* table) const {
        return static_cast<T>(table[at_]);
    }

  private:
    std::int32_t at_;
};

namespace look_up_detail {

template <class T>
struct IndexOf {
    using Type = NumberIndex<T>;
};
template <class T>
requires requires {
    typename T::Index;
}
struct IndexOf<T> {
    using Type = typename T::Index;
};

}  // namespace look_up_detail

/// That of a number, or of a Pack's lanes, an index each.
template <class T>
using Index = typename look_up_detail::IndexOf<T>::Type;

/// table[index], where the index is the whole part of a number.
template <class T, class Entry>
constexpr T look_up(const Entry* table, const T& index) {
    return Index<T>(index).look_up(table);
}

/// The whole part of a number that fits 32 bits.
template <class T>
constexpr T whole(const T& number) {
    return static_cast<T>(static_cast<std::int32_t>(number));
}

}  // namespace lensproof
