// engine/pupil/pupil_slice.h — pupil points at one wavelength or at several at once, drawn without a branch, and the
// pdf of any.
//
// Compiled for each width of packets too: what it defines are templates over the number type, to be inlined.
#pragma once
#include <array>
#include <cstdint>

#include "engine/base/disc.h"
#include "engine/base/look_up.h"
#include "engine/base/select.h"
#include "engine/pupil/pupil_panel.h"

namespace lensproof::pupil {

/// The regions of a PupilSlices as plain arrays. All are their own mirror image in x = 0.
struct PupilSliceTables {
    static constexpr int kPanels = 24;
    static constexpr int kRadiusSteps = 4096;
    static constexpr int kAreaSteps = 128;
    static constexpr int kWidthSteps = 512;
    // Of a region, one after the other: its width, then of each column lower and upper y and the area before it.
    static constexpr int kFirstColumn = 1;
    static constexpr int kPerColumn = 3;
    static constexpr int kNumbers = kFirstColumn + kPerColumn * (kPanels + 1);

    int nodes = 0;                              // in radius
    const double* per_end = nullptr;            // of a slice: 1 / the radius where the light ends, 1/mm
    const double* fractions = nullptr;          // of a node: its radius over the end
    const double* per_step = nullptr;           // 1 / the step to the next fraction
    const std::int32_t* node_below = nullptr;   // for each step in radius, the last node at or below it: none is within
    const double* regions = nullptr;            // [slice][node][number]
    const std::uint8_t* panel_below = nullptr;  // [slice][node][step]: a panel no later than that which each 128th of
                                                // the area begins in, between this node and the next
    const double* panel_fractions = nullptr;    // where the columns stand in a region's width
    const std::int32_t* panel_across = nullptr;  // for each step in the width, the last panel that begins no later
    const double* next_panel = nullptr;          // and where the next begins
    const double* per_panel = nullptr;           // 1 / the fraction that each panel has of the width
    Disc disc;                                   // that the defensive fraction is drawn from
    double disc_radius2 = 0.0;                   // of it, mm²
    double disc_pdf = 0.0;                       // what it adds to the pdf there, 1/mm²
    double defensive_fraction = 0.0;
    double per_other_fraction = 1.0;  // 1 / (1 − the defensive fraction)
};

template <class T>
struct PupilDraw {
    Vec2<T> point;
    T area;  // 1 / the pdf, mm²; 0: no path is to be started
};

/// The region for a sensor point in a slice, or for a packet of each: a mean of two nodes' regions.
///
/// T: double, or a pack of them; every lane has the bits of the double. Indices are kept as whole numbers of T.
template <class T>
class PupilSlice {
    using Mask = MaskOf<T>;

  public:
    constexpr PupilSlice(const PupilSliceTables& tables, const T& slice, const Vec2<T>& sensor_point)
        : tables_(tables) {
        using std::sqrt;
        const T radius = sqrt(sensor_point.x * sensor_point.x + sensor_point.y * sensor_point.y);
        const T fraction_or_none = radius * look_up(tables.per_end, slice);
        is_lit_ = fraction_or_none < T(1.0 + 0x1p-52);
        const T fraction = select(is_lit_, fraction_or_none, T(0));
        const T node = look_up(tables.node_below, fraction * T(PupilSliceTables::kRadiusSteps));
        const Index<T> node_index(node);
        const T t = (fraction - node_index.look_up(tables.fractions)) * node_index.look_up(tables.per_step);
        outer_weight_ = select(t > T(0), select(t < T(1), t, T(1)), T(0));
        inner_weight_ = T(1) - outer_weight_;
        region_ = slice * T(tables.nodes) + node;
        first_number_ = region_ * T(PupilSliceTables::kNumbers);
        const Index<T> first = column(T(0));
        width_ = mean(first, 0);
        whole_area_ = mean(first, kArea + kPerColumn * PupilSliceTables::kPanels);
        is_lit_ = is_lit_ && width_ * whole_area_ > T(0);
        // The frame in which the sensor point lies at (0, r).
        const Mask off_axis = radius > T(0);
        const T per_radius = T(1) / select(off_axis, radius, T(1));
        cosine_ = select(off_axis, sensor_point.y * per_radius, T(1));
        sine_ = sensor_point.x * per_radius;
    }

    /// The point that (u, v) in the unit square maps to, u being at least the defensive fraction.
    [[nodiscard]] constexpr PupilDraw<T> sample(const T& u, const T& v) const {
        constexpr double kBelowOne = 1.0 - 0x1p-53;
        const T rest = (u - T(tables_.defensive_fraction)) * T(tables_.per_other_fraction);
        const T towards_right = T(2) * rest - T(1);
        const Mask is_left = towards_right < T(0);
        const T fraction_or_one = select(is_left, -towards_right, towards_right);
        const T fraction = select(fraction_or_one < T(kBelowOne), fraction_or_one, T(kBelowOne));

        // The last panel with no more area before it than asked for. The areas of a mean lie between those of its
        // parts, so that no earlier panel than the first of the parts' comes into question.
        const T target = fraction * whole_area_;
        T panel = first_panel(fraction);
        T area_before = mean(column(panel), kArea);
        const auto advance = [&] {
            const T area_after = mean(column(panel), kArea + kPerColumn);
            const Mask is_before = is_lit_ && !(area_after > target);
            panel = select(is_before, panel + T(1), panel);
            area_before = select(is_before, area_after, area_before);
            return is_before;
        };
        advance();  // by one in half of all packets, hardly ever by more: a branch would be mispredicted as often
        while (any(advance())) {
        }
        const PupilPanel<T> found = panel_at(panel);
        const Vec2<T> own = found.point(found.cut(target - area_before), v);
        const T x = select(is_left, -width_, width_) * own.x;
        const Vec2<T> point{cosine_ * x + sine_ * own.y, cosine_ * own.y - sine_ * x};
        const Mask is_on_disc = !(point.x * point.x + point.y * point.y > T(tables_.disc_radius2));
        const T of_disc = select(is_on_disc, T(tables_.disc_pdf), T(0));
        return {point, area() / (T(1.0 - tables_.defensive_fraction) + of_disc * area())};
    }

    /// Of the region, mm²; 0 where no light was found.
    [[nodiscard]] constexpr T area() const { return select(is_lit_, T(2) * (width_ * whole_area_), T(0)); }

    [[nodiscard]] constexpr Mask contains(const Vec2<T>& point) const {
        const T x = cosine_ * point.x - sine_ * point.y;
        const T y = sine_ * point.x + cosine_ * point.y;
        const T fraction_or_beyond = select(x < T(0), -x, x) / select(is_lit_, width_, T(1));
        const Mask is_across = is_lit_ && fraction_or_beyond <= T(1);
        const T fraction = select(is_across, fraction_or_beyond, T(0));
        const Index<T> step(fraction * T(PupilSliceTables::kWidthSteps));
        const T no_later = step.look_up(tables_.panel_across);
        const PupilPanel<T> found =
            panel_at(select(step.look_up(tables_.next_panel) <= fraction, no_later + T(1), no_later));
        const T t = (fraction - found.fraction) * found.per_fraction;
        return is_across && !(y < found.lower_at(t)) && !(y > found.upper_at(t));
    }

    /// The pdf of a point that is drawn from the region or in defence, 1/mm²; 0 outside the region and the disc.
    [[nodiscard]] constexpr T pdf(const Vec2<T>& point) const {
        const Mask is_on_disc = !(point.x * point.x + point.y * point.y > T(tables_.disc_radius2));
        return select(is_on_disc, T(tables_.disc_pdf), T(0)) + region_pdf(point);
    }

    /// What the region adds to it.
    [[nodiscard]] constexpr T region_pdf(const Vec2<T>& point) const {
        const Mask is_inside = contains(point);
        return select(is_inside, T(1.0 - tables_.defensive_fraction) / select(is_inside, area(), T(1)), T(0));
    }

  private:
    static constexpr int kLower = PupilSliceTables::kFirstColumn;
    static constexpr int kUpper = kLower + 1;
    static constexpr int kArea = kLower + 2;
    static constexpr int kPerColumn = PupilSliceTables::kPerColumn;

    /// A number of a column of the mean; of column 0, number 0, the width.
    [[nodiscard]] constexpr T mean(const Index<T>& column, int number) const {
        const T inner = column.look_up(tables_.regions + number);
        const T outer = column.look_up(tables_.regions + number + PupilSliceTables::kNumbers);
        return inner_weight_ * inner + outer_weight_ * outer;
    }
    [[nodiscard]] constexpr Index<T> column(const T& panel) const {
        return Index<T>(first_number_ + T(PupilSliceTables::kPerColumn) * panel);
    }

    /// A panel at or before the one that has the fraction of the area before it.
    [[nodiscard]] constexpr T first_panel(const T& fraction) const {
        constexpr int kSteps = PupilSliceTables::kAreaSteps;
        return look_up(tables_.panel_below, region_ * T(kSteps) + whole(fraction * T(kSteps)));
    }

    [[nodiscard]] constexpr PupilPanel<T> panel_at(const T& panel) const {
        const Index<T> index(panel);
        const Index<T> before = column(panel);
        return {.fraction = index.look_up(tables_.panel_fractions),
                .next_fraction = index.look_up(tables_.panel_fractions + 1),
                .per_fraction = index.look_up(tables_.per_panel),
                .lower = mean(before, kLower),
                .upper = mean(before, kUpper),
                .next_lower = mean(before, kLower + kPerColumn),
                .next_upper = mean(before, kUpper + kPerColumn)};
    }

    const PupilSliceTables& tables_;
    Mask is_lit_;
    T region_;
    T first_number_;
    T inner_weight_;
    T outer_weight_;
    T width_;
    T whole_area_;
    T cosine_;
    T sine_;
};

/// The point of a region that (u, v) in the unit square maps to, or in defence of the disc.
constexpr PupilDraw<double> draw_pupil_point(const PupilSliceTables& tables, double slice, const Vec2d& sensor_point,
                                             double u, double v) {
    const PupilSlice<double> region(tables, slice, sensor_point);
    if (u < tables.defensive_fraction) {
        const Vec2d point = tables.disc.warped(u / tables.defensive_fraction, v);
        return {point, 1.0 / (tables.disc_pdf + region.region_pdf(point))};
    }
    return region.sample(u, v);
}

}  // namespace lensproof::pupil
