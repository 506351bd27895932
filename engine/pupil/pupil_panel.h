// engine/pupil/pupil_panel.h — an even draw from one panel of a pupil region.
#pragma once
#include "engine/base/select.h"
#include "engine/base/vec.h"

namespace lensproof::pupil {

/// A trapezoid between two lines parallel to y, which stand at fractions of a region's width; mm.
///
/// T: double, or a packet of panels.
template <class T>
struct PupilPanel {
    T fraction;
    T next_fraction;
    T per_fraction;  // 1 / (next_fraction − fraction)
    T lower;
    T upper;
    T next_lower;
    T next_upper;

    [[nodiscard]] constexpr T lower_at(const T& t) const { return lower + t * (next_lower - lower); }
    [[nodiscard]] constexpr T upper_at(const T& t) const { return upper + t * (next_upper - upper); }

    /// Where it is cut so that `area` (over the region's width, mm) lies before the cut: as a fraction of the panel.
    [[nodiscard]] constexpr T cut(const T& area) const {
        using std::sqrt;
        const T height = upper - lower;
        const T next_height = next_upper - next_lower;
        const T rest = select(area > T(0), area, T(0)) * per_fraction;
        const T square = height * height + T(2) * (next_height - height) * rest;
        const T sum = height + sqrt(select(square > T(0), square, T(0)));
        const T t = T(2) * rest / select(sum > T(0), sum, T(1));
        return select(sum > T(0), select(t < T(1), t, T(1)), T(0.5));
    }

    /// The point at fraction t of the panel and v of the height there: x as a fraction of the region's width, y in mm.
    [[nodiscard]] constexpr Vec2<T> point(const T& t, const T& v) const {
        return {fraction + t * (next_fraction - fraction), (T(1) - v) * lower_at(t) + v * upper_at(t)};
    }
};

}  // namespace lensproof::pupil
