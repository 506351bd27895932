// engine/base/look_up.h — numbers from tables, for one number or for several in step.
#pragma once
#include <array>
#include <cstdint>

#include "engine/base/pack.h"
#include "engine/base/select.h"

namespace lensproof {

/// An index, or one for each lane of a packet.
template <class T>
class Index {
  public:
    /// From whole numbers; of others the whole part.
    explicit Index(const T& number) : at_(static_cast<std::int32_t>(number)) {}

    template <class Entry>
    [[nodiscard]] T look_up(const Entry* table) const {
        return static_cast<T>(table[at_]);
    }

  private:
    std::int32_t at_;
};

template <class Scalar, class Abi>
class Index<Pack<Scalar, Abi>> {
  public:
    explicit Index(const Pack<Scalar, Abi>& number) { number.store(at_.data()); }

    template <class Entry>
    [[nodiscard]] Pack<Scalar, Abi> look_up(const Entry* table) const {
        return Pack<Scalar, Abi>::gather(table, at_.data());
    }

  private:
    alignas(64) std::array<std::int32_t, Pack<Scalar, Abi>::kLanes> at_;
};

/// table[index], where the index is the whole part of a number.
template <class T, class Entry>
T look_up(const Entry* table, const T& index) {
    return Index<T>(index).look_up(table);
}

/// The whole part of a number that fits 32 bits.
template <class T>
T whole(const T& number) {
    if constexpr (Packet<T>) {
        return T(std::experimental::trunc(number.lanes()));
    } else {
        return static_cast<T>(static_cast<std::int32_t>(number));
    }
}

}  // namespace lensproof
