// engine/optics/surface_axes.h — a surface of a traced lens by itself: its shape, in its own axes about its vertex.
#pragma once
#include "engine/optics/trace.h"

namespace lensproof::optics {

/// What a surface has beyond a centred sphere; null where it is one.
template <class OfLens, class T>
constexpr const typename OfLens::Special* special_of(const OfLens& lens, const TraceSurface<T>& surface) {
    return surface.special < 0 ? nullptr : &lens.specials[static_cast<std::size_t>(surface.special)];
}

/// Its shape, of a sphere too.
template <class T>
SurfaceShape<T> shape_of(const TraceLens<T>& lens, const TraceSurface<T>& surface) {
    const SpecialSurface<T>* special = special_of(lens, surface);
    return special != nullptr && special->has_shape ? special->shape : SurfaceShape<T>{.curvature = surface.curvature};
}

/// A point of lens space in the surface's own axes, mm; and back.
template <class OfLens, class T>
constexpr Vec3<T> to_own_axes(const OfLens& lens, const TraceSurface<T>& surface, const Vec3<T>& point) {
    const Vec3<T> from_vertex{point.x, point.y, point.z - surface.vertex_z};
    const typename OfLens::Special* special = special_of(lens, surface);
    return special == nullptr ? from_vertex
                              : special->to_own(from_vertex - Vec3<T>{special->vertex.x, special->vertex.y, T(0)});
}

template <class T>
Vec3<T> from_own_axes(const TraceLens<T>& lens, const TraceSurface<T>& surface, Vec3<T> point) {
    if (const SpecialSurface<T>* special = special_of(lens, surface)) {
        point = special->from_own(point) + Vec3<T>{special->vertex.x, special->vertex.y, T(0)};
    }
    point.z = point.z + surface.vertex_z;
    return point;
}

}  // namespace lensproof::optics
