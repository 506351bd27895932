// engine/optics/ray_course.h — where rays are to go, where that is known only when a program runs.
#pragma once
#include "engine/optics/ghost_path.h"

namespace lensproof::optics {

/// Through the lens, or along a ghost where there are reflections, which rays then enter forward.
template <class T, class Path = GhostPath>
struct RayCourse {
    Direction direction = Direction::forward;
    Rims rims = Rims::clip;
    Path reflections{};
    StrayMirrors<T> mirrors{};
};

/// `trace`, or `trace_ghost`.
template <class OfLens, class T, class Path, class Visitor>
constexpr TracedRay<T> trace_along(const OfLens& lens, const RayCourse<T, Path>& course, const Ray<T>& ray,
                                   Visitor&& visit) {
    const auto with_rims = [&]<Rims rims>() {
        if (!course.reflections.empty()) {
            return trace_ghost<Direction::forward, rims>(lens, course.reflections, ray, course.mirrors, visit);
        }
        return course.direction == Direction::forward
                   ? trace_through<Direction::forward, rims, LensMakeup::any>(lens, ray, visit)
                   : trace_through<Direction::reverse, rims, LensMakeup::any>(lens, ray, visit);
    };
    return course.rims == Rims::clip ? with_rims.template operator()<Rims::clip>()
                                     : with_rims.template operator()<Rims::follow>();
}

}  // namespace lensproof::optics
