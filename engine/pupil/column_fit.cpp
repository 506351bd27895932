#include "engine/pupil/column_fit.h"

#include <algorithm>

#include "engine/base/infinity.h"

namespace lensproof::pupil {

namespace {

/// What outlines reach at a region's columns; the columns beside them have what the nearest one has.
struct Reach {
    std::array<double, kPupilPanels + 1> lower;
    std::array<double, kPupilPanels + 1> upper;
};

Reach reach_at_columns(std::span<const PupilOutline> outlines, double left, double width,
                       const PupilFractions& fractions) {
    Reach reach{};
    reach.lower.fill(kInfinity);
    reach.upper.fill(-kInfinity);
    const auto column_at = [&](double x) {
        return std::lower_bound(fractions.at.begin(), fractions.at.end(), (x - left) / width) - fractions.at.begin();
    };
    for (const PupilOutline& outline : outlines) {
        for (std::size_t i = 0; i < outline.points.size(); ++i) {
            Vec2d p = outline.points[i];
            Vec2d q = outline.points[(i + 1) % outline.points.size()];
            if (q.x < p.x) {
                std::swap(p, q);
            }
            for (auto k = column_at(p.x); k <= kPupilPanels && left + width * fractions.at[k] <= q.x; ++k) {
                const double t = q.x > p.x ? (left + width * fractions.at[k] - p.x) / (q.x - p.x) : 0.0;
                const double y = p.y + t * (q.y - p.y);
                reach.lower[k] = std::min(reach.lower[k], y);
                reach.upper[k] = std::max(reach.upper[k], y);
            }
        }
    }
    return reach;
}

}  // namespace

Extent extent_of(std::span<const PupilOutline> outlines) {
    Extent extent{kInfinity, -kInfinity};
    for (const PupilOutline& outline : outlines) {
        for (const Vec2d& point : outline.points) {
            extent = {std::min(extent.left, point.x), std::max(extent.right, point.x)};
        }
    }
    return extent;
}

void ColumnGrowth::include(const ColumnGrowth& other) {
    for (std::size_t i = 0; i < up.size(); ++i) {
        down[i] = std::max(down[i], other.down[i]);
        up[i] = std::max(up[i], other.up[i]);
    }
}

ColumnGrowth missing_growth(const PupilRegion& region, std::span<const PupilOutline> outlines, PupilSymmetry symmetry) {
    ColumnGrowth growth;
    const PupilFractions& fractions = pupil_fractions(symmetry);
    const Reach reach = reach_at_columns(outlines, region.left, region.width, fractions);
    for (std::size_t i = 0; i < growth.up.size(); ++i) {
        growth.down[i] = std::max(0.0, region.columns[i].lower - reach.lower[i]);
        growth.up[i] = std::max(0.0, reach.upper[i] - region.columns[i].upper);
    }
    for (const PupilOutline& outline : outlines) {
        for (const Vec2d& point : outline.points) {
            const double fraction = (point.x - region.left) / region.width;
            const auto i = static_cast<std::size_t>(fractions.panel(fraction));
            const double t = std::clamp((fraction - fractions.at[i]) * fractions.per_width[i], 0.0, 1.0);
            const PupilColumn& a = region.columns[i];
            const PupilColumn& b = region.columns[i + 1];
            const double down = a.lower + t * (b.lower - a.lower) - point.y;
            const double up = point.y - a.upper - t * (b.upper - a.upper);
            for (const std::size_t k : {i, i + 1}) {
                growth.down[k] = std::max(growth.down[k], down);
                growth.up[k] = std::max(growth.up[k], up);
            }
        }
    }
    return growth;
}

void grow(PupilRegion& region, const ColumnGrowth& growth, double scale, PupilSymmetry symmetry) {
    for (std::size_t i = 0; i < region.columns.size(); ++i) {
        region.columns[i].lower -= scale * growth.down[i];
        region.columns[i].upper += scale * growth.up[i];
    }
    region.sum_areas(symmetry);
}

PupilRegion region_around(std::span<const PupilOutline> outlines, const Extent& extent, PupilSymmetry symmetry) {
    PupilRegion region{.left = extent.left, .width = extent.right - extent.left};
    const Reach reach = reach_at_columns(outlines, region.left, region.width, pupil_fractions(symmetry));
    const auto filled = std::ranges::find_if(outlines, [](const PupilOutline& outline) { return !outline.is_empty(); });
    PupilColumn nearest{.lower = filled->points.front().y, .upper = filled->points.front().y};
    for (std::size_t i = region.columns.size(); i-- > 0;) {  // the first that is reached, for those before it
        nearest = reach.lower[i] <= reach.upper[i] ? PupilColumn{reach.lower[i], reach.upper[i]} : nearest;
    }
    for (std::size_t i = 0; i < region.columns.size(); ++i) {
        nearest = reach.lower[i] <= reach.upper[i] ? PupilColumn{reach.lower[i], reach.upper[i]} : nearest;
        region.columns[i] = nearest;
    }
    grow(region, missing_growth(region, outlines, symmetry), 1.0, symmetry);
    return region;
}

}  // namespace lensproof::pupil
