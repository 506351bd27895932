// engine/optics/select.h — choosing without a branch, so that one tracer serves scalars and packets alike.
#pragma once

namespace lensproof {

/// `a` where `mask` holds, else `b`. Packets overload it with a blend.
template <class T>
T select(bool mask, const T& a, const T& b) {
    return mask ? a : b;
}

/// Whether a mask holds in any lane, in all lanes.
constexpr bool any(bool mask) {
    return mask;
}
constexpr bool all(bool mask) {
    return mask;
}

}  // namespace lensproof
