// engine/optics/select.h — choosing without a branch, so that one tracer serves scalars and packets alike.
#pragma once

namespace lensproof {

/// `a` where `mask` holds, else `b`. Packets overload it with a blend.
template <class T>
T select(bool mask, const T& a, const T& b) {
    return mask ? a : b;
}

}  // namespace lensproof
