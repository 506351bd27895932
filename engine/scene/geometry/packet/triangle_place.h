// engine/scene/geometry/packet/triangle_place.h — points drawn evenly on triangles.
//
// Of a number or of a packet's lanes; every lane has the bits of the number.
#pragma once
#include <cmath>
#include <cstddef>

#include "engine/base/look_up.h"
#include "engine/base/select.h"

namespace lensproof::scene {

/// On one of several triangles: the barycentric coordinates of its second and third vertex.
template <class T>
struct TrianglePlace {
    T which{};
    T a{};
    T b{};
};

/// `areas_to`: the summed areas up to each triangle, 0 first. `sought`, of the last of them, lies on the triangle
/// `which` and draws, by what it is beyond those before, the place together with `u2` in [0, 1).
template <class T>
TrianglePlace<T> place_on_triangle(const double* areas_to, const T& which, const T& sought, const T& u2) {
    using std::sqrt;
    const Index<T> index(which);
    const T before = index.look_up(areas_to);
    const T rest = (sought - before) / (index.look_up(areas_to + 1) - before);
    const T root = sqrt(select(rest < T(1.0), select(rest > T(0.0), rest, T(0.0)), T(1.0)));
    return {.which = which, .a = root * (T(1.0) - u2), .b = root * u2};
}

/// More are searched through.
inline constexpr std::size_t kFewTriangles = 16;

/// The same of few triangles: how many `sought` lies beyond is counted, since no branch of a search can be foreseen.
template <class T>
TrianglePlace<T> place_on_few_triangles(const double* areas_to, std::size_t count, const T& sought, const T& u2) {
    T which(0.0);
    for (std::size_t i = 1; i < count; ++i) {
        which = which + select(sought < T(areas_to[i]), T(0.0), T(1.0));
    }
    return place_on_triangle(areas_to, which, sought, u2);
}

}  // namespace lensproof::scene
