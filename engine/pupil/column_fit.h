// engine/pupil/column_fit.h — regions in columns that hold given outlines.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "engine/pupil/pupil_outline.h"
#include "engine/pupil/pupil_region.h"

namespace lensproof::pupil {

/// The smallest and the largest x of outlines.
struct Extent {
    double left;
    double right;
};
Extent extent_of(std::span<const PupilOutline> outlines);

/// By how much the columns of a region have to grow to hold outlines, mm.
struct ColumnGrowth {
    std::array<double, kPupilPanels + 1> down{};
    std::array<double, kPupilPanels + 1> up{};

    ColumnGrowth() = default;
    /// The same at every end.
    explicit ColumnGrowth(double everywhere) {
        down.fill(everywhere);
        up.fill(everywhere);
    }

    /// The larger of both, column by column.
    void include(const ColumnGrowth& other);
};

/// What `region` misses of the outlines, whose extent it has to hold.
ColumnGrowth missing_growth(const PupilRegion& region, std::span<const PupilOutline> outlines, PupilSymmetry symmetry);

/// Makes the columns longer, by `scale` times the growth; the areas are summed again.
void grow(PupilRegion& region, const ColumnGrowth& growth, double scale, PupilSymmetry symmetry);

/// A region over `extent`, which holds the outlines' own, that holds them. At least one outline is not empty.
PupilRegion region_around(std::span<const PupilOutline> outlines, const Extent& extent, PupilSymmetry symmetry);

}  // namespace lensproof::pupil
