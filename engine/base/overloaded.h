// engine/base/overloaded.h — several functions as one, for std::visit.
#pragma once

namespace lensproof {

template <class... Functions>
struct Overloaded : Functions... {
    using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;  // clang 14 does not deduce it by itself

}  // namespace lensproof
