// engine/pupil/pupil_region.h — a region of the pupil plane in columns, and how to draw points evenly from it.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "engine/base/vec.h"
#include "engine/pupil/pupil_panel.h"

namespace lensproof::pupil {

/// Whether a region is its own mirror image in x = 0; then its half at x ≥ 0 is stored alone.
enum class PupilSymmetry { none, mirror };

/// How many panels a region is cut into, each a trapezoid between two columns.
inline constexpr int kPupilPanels = 24;

/// Where the columns stand, as fractions of the region's width from its left end: closer together towards an end where
/// an outline that is round there turns, so that equal arcs of an ellipse lie between them.
struct PupilFractions {
    std::array<double, kPupilPanels + 1> at{};
    std::array<double, kPupilPanels> per_width{};  // 1 / (the next fraction − this one)

    explicit PupilFractions(PupilSymmetry symmetry);
    /// The panel that a fraction from 0 to 1 lies in.
    [[nodiscard]] int panel(double fraction) const {
        return static_cast<int>(std::upper_bound(at.begin() + 1, at.end() - 1, fraction) - at.begin()) - 1;
    }
};
inline const PupilFractions kWholeFractions{PupilSymmetry::none};
inline const PupilFractions kHalfFractions{PupilSymmetry::mirror};
inline const PupilFractions& pupil_fractions(PupilSymmetry symmetry) {
    return symmetry == PupilSymmetry::mirror ? kHalfFractions : kWholeFractions;
}

/// A column of a region: the points between two y, mm.
struct PupilColumn {
    double lower = 0.0;
    double upper = 0.0;
    double area_before = 0.0;  // of the panels before it, over the region's width: mm
};

/// A region of a plane, mm: at x = left + fraction · width, with straight lines between the columns. It may bend, and
/// ends may be round, pointed or cut off; a line parallel to y meets it once. A mirror image stores x ≥ 0, and left is
/// 0.
struct PupilRegion {
    double left = 0.0;
    double width = 0.0;
    std::array<PupilColumn, kPupilPanels + 1> columns{};

    /// To be called when lower and upper are set: sums the panels' areas up.
    void sum_areas(PupilSymmetry symmetry);
};

/// The region at t between two, column by column; its sums of area, too, are linear in the columns.
PupilRegion mean_region(const PupilRegion& a, const PupilRegion& b, double t);

/// The panel that each 128th of a region's area begins in: where a search for a panel starts.
inline constexpr int kGuideSteps = 128;
using PanelGuide = std::array<std::uint8_t, kGuideSteps>;
PanelGuide panel_guide(const PupilRegion& region);

/// A mean of `Count` regions by weights that add up to 1, column by column: a region itself, of which nothing has to be
/// made. The sums of areas are linear in the columns, so that the mean's are the mean of theirs. The regions are held
/// by pointer.
template <std::size_t Count>
class BlendedRegion {
  public:
    BlendedRegion(const std::array<const PupilRegion*, Count>& regions, const std::array<double, Count>& weights,
                  PupilSymmetry symmetry)
        : regions_(regions),
          weights_(weights),
          fractions_(&pupil_fractions(symmetry)),
          is_mirror_(symmetry == PupilSymmetry::mirror),
          left_(mean([](const PupilRegion& region) { return region.left; })),
          width_(mean([](const PupilRegion& region) { return region.width; })) {}

    /// mm², of both halves.
    [[nodiscard]] double area() const { return (is_mirror_ ? 2.0 : 1.0) * width_ * area_before(kPupilPanels); }

    /// The point that (u, v) in the unit square maps to, evenly over a region whose area is not 0: u picks the panel by
    /// its area, then x inside it, where the pdf is linear, and v picks y. Any guide yields the same point; a
    /// guide of a similar region yields it sooner.
    [[nodiscard]] Vec2d sample(double u, double v, const PanelGuide& guide) const {
        const double area_fraction = is_mirror_ ? std::abs(2.0 * u - 1.0) : u;
        const double target = area_fraction * area_before(kPupilPanels);
        int panel = guide[std::min(kGuideSteps - 1, static_cast<int>(area_fraction * kGuideSteps))];
        while (panel > 0 && area_before(panel) > target) {
            --panel;
        }
        while (panel + 1 < kPupilPanels && area_before(panel + 1) <= target) {
            ++panel;
        }
        const PupilPanel<double> p = at(panel);
        const Vec2d in_region = p.point(p.cut(target - area_before(panel)), v);
        const double x = left_ + width_ * in_region.x;
        return {is_mirror_ && u < 0.5 ? -x : x, in_region.y};
    }

    [[nodiscard]] bool contains(Vec2d point) const {
        const double fraction = ((is_mirror_ ? std::abs(point.x) : point.x) - left_) / width_;
        if (!(fraction >= 0.0 && fraction <= 1.0)) {
            return false;
        }
        const PupilPanel<double> p = at(fractions_->panel(fraction));
        const double t = (fraction - p.fraction) * p.per_fraction;
        return point.y >= p.lower_at(t) && point.y <= p.upper_at(t);
    }

  private:
    template <class Of>
    [[nodiscard]] double mean(const Of& of) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < Count; ++i) {
            sum += weights_[i] * of(*regions_[i]);
        }
        return sum;
    }

    [[nodiscard]] double area_before(int column) const {
        return mean([&](const PupilRegion& region) { return region.columns[column].area_before; });
    }

    [[nodiscard]] PupilPanel<double> at(int panel) const {
        return {.fraction = fractions_->at[panel],
                .next_fraction = fractions_->at[panel + 1],
                .per_fraction = fractions_->per_width[panel],
                .lower = mean([&](const PupilRegion& region) { return region.columns[panel].lower; }),
                .upper = mean([&](const PupilRegion& region) { return region.columns[panel].upper; }),
                .next_lower = mean([&](const PupilRegion& region) { return region.columns[panel + 1].lower; }),
                .next_upper = mean([&](const PupilRegion& region) { return region.columns[panel + 1].upper; })};
    }

    std::array<const PupilRegion*, Count> regions_;
    std::array<double, Count> weights_;
    const PupilFractions* fractions_;
    bool is_mirror_;
    double left_;
    double width_;
};

}  // namespace lensproof::pupil
