// engine/optics/paraxial_ghost.h — a ghost in first order: the folded system as a matrix, its focus and its pupil.
#pragma once
#include <optional>

#include "engine/optics/ghost_path.h"
#include "engine/optics/paraxial.h"

namespace lensproof::optics {

/// A ray of height y (mm) and slope u = dy/dz, whichever way the light runs, becomes
///     y' = A y + B u,   u' = C y + D u
/// (Lee & Eisemann 2013, of flare; Brouwer 1964, of lenses). In air at both ends A D − B C = 1.
template <class T>
struct RayTransfer {
    T a = T(1);
    T b = T(0);
    T c = T(0);
    T d = T(1);

    void cross(const T& distance) {
        a += distance * c;
        b += distance * d;
    }
    /// At a vertex, where heights stay: u' = slope · u + height · y.
    void turn(const T& height, const T& slope) {
        c = height * a + slope * c;
        d = height * b + slope * d;
    }
};

/// From the plane of the first vertex, in front of it, along the path to the image plane, and to the stop where the
/// light passes it for the last time: after the reflections, but for those whose last one lies behind it.
template <class T>
struct FoldedSystem {
    RayTransfer<T> to_stop;
    RayTransfer<T> to_image;
};

/// A reflection at curvature c makes u' = −u − 2 c y, a refraction n' u' = n u − y c (n' − n).
template <class T>
FoldedSystem<T> folded_system(const TraceLens<T>& lens, const GhostPath& path) {
    FoldedSystem<T> system;
    const int count = static_cast<int>(lens.surfaces.size());
    RayTransfer<T>& here = system.to_image;
    T z = lens.surfaces.front().vertex_z;
    const auto go_to = [&](const T& to) {
        here.cross(to - z);
        z = to;
    };
    auto next = path.begin();
    int step = 1;
    for (int index = 0; index >= 0 && index <= count; index += step) {
        const bool reflects = next != path.end() && *next == index;
        go_to(index == count ? lens.image_z : lens.surfaces[static_cast<std::size_t>(index)].vertex_z);
        if (index == count && !reflects) {
            break;
        }
        if (reflects) {
            here.turn(index == count ? T(0) : T(-2) * lens.surfaces[static_cast<std::size_t>(index)].curvature, T(-1));
            step = -step;
            ++next;
            continue;
        }
        const TraceSurface<T>& surface = lens.surfaces[static_cast<std::size_t>(index)];
        if (surface.is_stop) {
            system.to_stop = here;
        }
        const T& before = step > 0 ? surface.index_before : surface.index_after;
        const T& after = step > 0 ? surface.index_after : surface.index_before;
        here.turn(-surface.curvature * (after - before) / after, before / after);
    }
    return system;
}

/// What a ghost is in first order; mm. What lies at infinity is infinite.
struct ParaxialGhost {
    double marginal_ray_height = 0.0;        // at the image plane, of the ray parallel to the axis at the edge of the
                                             // lens's entrance pupil
    std::optional<double> chief_ray_height;  // of the ray that passes the stop's centre (FoldedSystem); nothing where
                                             // no ray of that angle does
    double efl = 0.0;                        // of the folded system
    double focus = 0.0;                      // from the image plane, positive beyond it
    double pupil = 0.0;                      // likewise, where the chief rays cross the axis
    double f_number = 0.0;                   // efl over the diameter of the lens's entrance pupil, with efl's sign
};

/// `field_angle` (radians) is the chief ray's.
ParaxialGhost paraxial_ghost(const TraceLens<double>& lens, const GhostPath& path, double field_angle);

}  // namespace lensproof::optics
