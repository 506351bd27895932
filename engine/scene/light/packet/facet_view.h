// engine/scene/light/packet/facet_view.h — a shining surface of flat pieces, as a point sees it.
//
// World frame, mm. Of a number or of a packet's lanes; every lane has the bits of the number.
#pragma once
#include <cmath>
#include <vector>

#include "engine/scene/geometry/packet/triangle_place.h"

namespace lensproof::scene {

/// Flat pieces side by side, few of them, a column a number.
struct ShiningFacets {
    struct Vectors {
        std::vector<double> x, y, z;

        void push_back(const Vec3d& vector) {
            x.push_back(vector.x);
            y.push_back(vector.y);
            z.push_back(vector.z);
        }
    };
    Vectors first, to_second, to_third, normal;
    std::vector<double> error_mm;
    bool is_quad = false;              // one piece; else they are triangles
    std::vector<double> areas_to_mm2;  // of these, as `place_on_triangle` has them
    double pdf_per_mm2 = 0.0;          // with which points are drawn

    [[nodiscard]] bool is_empty() const { return error_mm.empty(); }
};

/// A point of a shining surface.
template <class T>
struct ShiningPoint {
    Vec3<T> point;
    Vec3<T> normal;   // outward
    T error_mm{};     // as SurfaceHit has it
    T pdf_per_mm2{};  // with which it is drawn
};

/// That which two numbers in [0, 1) draw, evenly.
template <class T>
ShiningPoint<T> point_on(const ShiningFacets& facets, const T& u1, const T& u2) {
    const TrianglePlace<T> place = facets.is_quad
                                       ? TrianglePlace<T>{.which = T(0.0), .a = u1, .b = u2}
                                       : place_on_few_triangles(facets.areas_to_mm2.data(), facets.error_mm.size(),
                                                                u1 * T(facets.areas_to_mm2.back()), u2);
    const Index<T> index(place.which);
    const auto at = [&](const ShiningFacets::Vectors& of) {
        return Vec3<T>{index.look_up(of.x.data()), index.look_up(of.y.data()), index.look_up(of.z.data())};
    };
    return {.point = at(facets.first) + place.a * at(facets.to_second) + place.b * at(facets.to_third),
            .normal = at(facets.normal),
            .error_mm = index.look_up(facets.error_mm.data()),
            .pdf_per_mm2 = T(facets.pdf_per_mm2)};
}

/// That point as another sees it.
template <class T>
struct ShiningView {
    Vec3<T> direction;  // to it, unit length
    Vec3<T> end;        // it, off its surface (`ray_origin`)
    T cosine{};         // of that direction, turned round, from the normal; no number where both points are one
    T pdf{};            // per solid angle
    T per_pdf{};        // 1 over it, found beside it
};

template <class T>
ShiningView<T> seen_from(const Vec3<T>& from, const ShiningPoint<T>& light) {
    using std::abs;
    const Vec3<T> to_light = light.point - from;
    const T distance2 = dot(to_light, to_light);
    const Vec3<T> direction = normalized(to_light);
    const T cosine = -dot(light.normal, direction);
    const T per_cosine = light.pdf_per_mm2 * distance2;
    const T off = T(2.0) * light.error_mm;
    return {.direction = direction,
            .end = light.point + select(cosine < T(0.0), -off, off) * light.normal,
            .cosine = cosine,
            .pdf = per_cosine / abs(cosine),
            .per_pdf = abs(cosine) / per_cosine};
}

}  // namespace lensproof::scene
