// engine/scene/geometry/packet/analytic_kernels.h — rays against a scene's spheres, quads and few triangles, a loop
// for each width of packets.
#pragma once
#include <array>
#include <optional>
#include <span>

#include "engine/base/simd_level.h"
#include "engine/scene/geometry/packet/analytic_meeting.h"

namespace lensproof::scene {

/// Rays side by side, a column a number. World frame, mm.
struct alignas(64) RayColumns {
    static constexpr std::size_t kMost = 64;
    using Column = std::array<double, kMost>;

    Column origin_x, origin_y, origin_z;
    Column direction_x, direction_y, direction_z;
    Column from;
    Column to;      // the end of the stretch; then the nearest meeting, if there is one
    Column object;  // which of the objects was met; −1: none
    Column b1, b2;  // as Meeting has them
    std::size_t size = 0;

    /// The i-th ray; it has met nothing.
    void set(std::size_t i, const Stretch<double>& ray);
    [[nodiscard]] Meeting<double> meeting(std::size_t i) const { return {.at = to[i], .b1 = b1[i], .b2 = b2[i]}; }
};

/// The first of many triangles on a ray; −1: none.
struct TriangleMeeting {
    Meeting<double> meeting;
    int triangle = -1;
};

/// The loops of one level; all levels yield the same bits.
struct AnalyticKernels {
    /// Which of the objects each ray meets first; of two that are equally far, the one before.
    void (*meet_nearest)(std::span<const AnalyticObject> objects, RayColumns& rays);
    /// Which of the triangles one ray meets first, as above. `reach_mm`: of the ray's origin and the triangles.
    TriangleMeeting (*meet_first_triangle)(std::span<const TriangleBlock> blocks, const Stretch<double>& ray,
                                           double reach_mm);
};

/// Those of a level, or of the widest; throws as `LoopsByLevel` does.
const AnalyticKernels& analytic_kernels(std::optional<SimdLevel> level = {});

/// Compiled for each level by itself (.ci/rooms.cmake).
template <SimdLevel level>
AnalyticKernels analytic_kernels_at();

}  // namespace lensproof::scene
