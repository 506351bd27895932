// engine/base/select.h — choosing without a branch, so that one tracer serves scalars and packets alike.
#pragma once
#include <concepts>

#include "engine/base/vec.h"

namespace lensproof {

/// What a comparison of two T gives: bool, or of a packet a truth value for each lane.
template <class T>
using MaskOf = decltype(T() < T());

/// Several numbers in step.
template <class T>
concept Packet = !std::same_as<MaskOf<T>, bool>;

/// `a` where `mask` holds, else `b`. Packets overload it with a blend.
template <class T>
constexpr T select(bool mask, const T& a, const T& b) {
    return mask ? a : b;
}

/// The type of a packet's lanes; of a single number its own.
template <class T>
struct LaneOf {
    using Number = T;
};
template <Packet T>
struct LaneOf<T> {
    using Number = typename T::Number;
};

template <Packet T>
constexpr Vec3<T> select(const MaskOf<T>& mask, const Vec3<T>& a, const Vec3<T>& b) {
    return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

/// Puts `value` into `to` where `mask` holds. For what is too large to be copied for a choice.
template <class T>
constexpr void assign_where(bool mask, T& to, const T& value) {
    if (mask) {
        to = value;
    }
}

/// Whether a mask holds in any lane, in all lanes. Packets' masks overload them.
constexpr bool any(bool mask) {
    return mask;
}
constexpr bool all(bool mask) {
    return mask;
}

}  // namespace lensproof
