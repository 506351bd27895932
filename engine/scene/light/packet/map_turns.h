// engine/scene/light/packet/map_turns.h — which direction a picture of all directions shows where.
//
// The picture's frame: z towards its top row, x towards its middle column, columns to the left of it counter-clockwise.
// Points of the unit square from its top left corner, x to the right, y down. Of a number or of a packet's lanes.
#pragma once
#include "engine/base/angle.h"
#include "engine/base/elementary.h"

namespace lensproof::scene {

/// A direction in the picture's frame, unit length, and the sine of its angle from the poles.
template <class T>
struct MapDirection {
    Vec3<T> direction;
    T sine;
};

template <class T>
constexpr MapDirection<T> map_direction(const Vec2<T>& at) {
    const Vec2<T> down = cos_sin_within(T(kPi) * at.y);
    const Vec2<T> left = cos_sin_within(T(2.0 * kPi) * (T(0.5) - at.x));
    return {{down.y * left.x, down.y * left.y, down.x}, down.y};
}

/// The point that shows a direction, and its sine.
template <class T>
struct MapPoint {
    Vec2<T> at;
    T sine;
};

template <class T>
constexpr MapPoint<T> map_point(const Vec3<T>& direction) {
    using std::sqrt;
    const T sine = sqrt(direction.x * direction.x + direction.y * direction.y);  // exact near the poles too
    const T x = T(0.5) - turns_of(direction.x, direction.y);
    return {{select(x < T(1.0), x, T(0.0)), T(2.0) * turns_of(direction.z, sine)}, sine};
}

}  // namespace lensproof::scene
