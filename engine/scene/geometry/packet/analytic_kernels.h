// engine/scene/geometry/packet/analytic_kernels.h — rays against a scene's spheres, quads and few triangles, a loop
// for each width of packets.
#pragma once
#include <array>
#include <optional>
#include <span>

#include "engine/base/simd_level.h"
#include "engine/scene/geometry/packet/analytic_meeting.h"
#include "engine/scene/geometry/packet/few_triangles.h"

namespace lensproof::scene {

/// Rays side by side, a column a number. World frame, mm.
struct alignas(64) RayColumns {
    static constexpr std::size_t kMost = 64;
    using Column = std::array<double, kMost>;

    std::array<Column, 3> origin, direction;  // x, y, z
    Column from, to;                          // the stretch that is asked for
    std::size_t size = 0;

    /// The i-th ray.
    void set(std::size_t i, const Stretch<double>& ray) {
        origin[0][i] = ray.origin.x;
        origin[1][i] = ray.origin.y;
        origin[2][i] = ray.origin.z;
        direction[0][i] = ray.direction.x;
        direction[1][i] = ray.direction.y;
        direction[2][i] = ray.direction.z;
        from[i] = ray.from;
        to[i] = ray.to;
    }
    Stretch<double> operator[](std::size_t i) const {
        return {.origin = {origin[0][i], origin[1][i], origin[2][i]},
                .direction = {direction[0][i], direction[1][i], direction[2][i]},
                .from = from[i],
                .to = to[i]};
    }
};

/// The first of a list on a ray.
struct FirstMeeting {
    Meeting<double> meeting;
    int which = -1;  // an index; −1: none

    [[nodiscard]] bool is_one() const { return which >= 0; }
};

/// The same of many rays.
struct alignas(64) MeetingColumns {
    RayColumns::Column at, b1, b2, which;

    [[nodiscard]] FirstMeeting first(std::size_t i) const {
        return {.meeting = {.at = at[i], .b1 = b1[i], .b2 = b2[i]}, .which = static_cast<int>(which[i])};
    }
    [[nodiscard]] bool is_any(std::size_t i) const { return which[i] >= 0.0; }
};

/// The loops of one level; all levels yield the same bits. Of two that are equally far, the one before counts.
struct AnalyticKernels {
    /// What each ray meets of objects, or of triangles.
    struct Meet {
        void (*objects)(std::span<const AnalyticObject> objects, const RayColumns& rays, MeetingColumns& met);
        void (*triangles)(const FewTriangles& triangles, const RayColumns& rays, MeetingColumns& met);
    };
    Meet first;
    Meet any;  // whether it meets one: `which` alone is filled, and says no more
    /// The same of one ray.
    FirstMeeting (*meet_first_triangle)(const FewTriangles& triangles, const Stretch<double>& ray);
};

/// Those of a level, or of the widest; throws as `LoopsByLevel` does.
const AnalyticKernels& analytic_kernels(std::optional<SimdLevel> level = {});

/// Compiled for each level by itself (.ci/rooms.cmake).
template <SimdLevel level>
AnalyticKernels analytic_kernels_at();

}  // namespace lensproof::scene
