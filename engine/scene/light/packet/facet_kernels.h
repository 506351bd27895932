// engine/scene/light/packet/facet_kernels.h — a shining surface as many points see it, a loop for each width of
// packets.
#pragma once
#include <array>
#include <cstddef>
#include <optional>

#include "engine/base/simd_level.h"
#include "engine/scene/light/packet/facet_view.h"

namespace lensproof::scene {

/// Points and the numbers that they draw with, and what they see, side by side, a column a number.
struct alignas(64) ViewColumns {
    static constexpr std::size_t kMost = 64;
    using Column = std::array<double, kMost>;
    struct Vectors {
        Column x, y, z;

        [[nodiscard]] Vec3d at(std::size_t i) const { return {x[i], y[i], z[i]}; }
    };

    Vectors from{};
    Column u1{}, u2{};
    Vectors direction, end;
    Column cosine, pdf, per_pdf;
    std::size_t size = 0;

    void add(const Vec3d& point, const Vec2d& numbers) {
        from.x[size] = point.x;
        from.y[size] = point.y;
        from.z[size] = point.z;
        u1[size] = numbers.x;
        u2[size] = numbers.y;
        ++size;
    }
    [[nodiscard]] ShiningView<double> view(std::size_t i) const {
        return {
            .direction = direction.at(i), .end = end.at(i), .cosine = cosine[i], .pdf = pdf[i], .per_pdf = per_pdf[i]};
    }
};

/// The loops of one level; all levels yield the same bits, those of a single point.
struct FacetKernels {
    void (*see)(const ShiningFacets& facets, ViewColumns& columns);
};

/// Those of a level, or of the widest; throws as `LoopsByLevel` does.
const FacetKernels& facet_kernels(std::optional<SimdLevel> level = {});

/// Compiled for each level by itself (.ci/rooms.cmake).
template <SimdLevel level>
FacetKernels facet_kernels_at();

}  // namespace lensproof::scene
