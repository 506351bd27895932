#include "engine/scene/geometry/facet.h"

#include <algorithm>

namespace lensproof::scene {

namespace {

Facet facet_between(const ObjectPlace& place, const SurfaceHit& corner, const SurfaceHit& a, const SurfaceHit& b) {
    // Of a corner, and of two differences of corners, which round in double.
    const double errors = place.epsilon > std::numeric_limits<double>::epsilon() ? 1.0 : 5.0;
    return {.sides = {corner.point, a.point - corner.point, b.point - corner.point},
            .normal = corner.geometric_normal,
            .tangent = corner.tangent,
            .uv = corner.uv,
            .uv_along_a = a.uv - corner.uv,
            .uv_along_b = b.uv - corner.uv,
            .error_mm = errors * std::max({corner.error_mm, a.error_mm, b.error_mm})};
}

}  // namespace

Facet facet_of(const Quad& quad, const ObjectPlace& place) {
    const auto corner = [&](double x_sign, double y_sign) {
        return world_hit(place, shape_point(quad, 0.5 * x_sign * quad.width_mm, 0.5 * y_sign * quad.height_mm));
    };
    return facet_between(place, corner(-1.0, -1.0), corner(1.0, -1.0), corner(-1.0, 1.0));
}

Facet facet_of(const TriangleMesh& mesh, std::uint32_t triangle, const ObjectPlace& place) {
    const auto corner = [&](double b1, double b2) { return world_hit(place, shape_point(mesh, triangle, b1, b2)); };
    return facet_between(place, corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0));
}

}  // namespace lensproof::scene
