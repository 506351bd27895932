// engine/base/ray.h — rays.
#pragma once
#include "engine/base/vec.h"

namespace lensproof {

/// A half-line: `origin` in mm, `direction` of unit length.
template <class T>
struct Ray {
    Vec3<T> origin;
    Vec3<T> direction;
};

}  // namespace lensproof
