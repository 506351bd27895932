#include "experiments/draw/chart_axes.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/base/infinity.h"

namespace lensproof::draw {

namespace {

/// The range of what can be shown of a chart along one axis.
struct Extent {
    double low = kInfinity;
    double high = -kInfinity;

    [[nodiscard]] bool is_empty() const { return !(low <= high); }
    void hold(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    void hold(const Extent& other) {
        low = std::min(low, other.low);
        high = std::max(high, other.high);
    }
};

bool is_within(const ChartAxis& axis, double value) {
    const double a = axis.low.value_or(-kInfinity);
    const double b = axis.high.value_or(kInfinity);
    return value >= std::min(a, b) && value <= std::max(a, b);
}

/// `for_y_range`: only what sets the range of an open y axis.
void for_each_point(const PlotChart& chart, bool for_y_range, const std::function<void(Vec2d)>& visit) {
    for (const ChartCurve& curve : chart.curves) {
        if (curve.sets_y_range || !for_y_range) {
            std::ranges::for_each(curve.points, visit);
        }
    }
    for (const ChartArea& area : chart.areas) {
        if (area.sets_y_range || !for_y_range) {
            std::ranges::for_each(area.outline, visit);
        }
    }
}

Extent extent_along(const PlotChart& chart, bool along_x) {
    const ChartAxis& axis = along_x ? chart.x : chart.y;
    const ChartAxis& other = along_x ? chart.y : chart.x;
    Extent extent;
    for_each_point(chart, !along_x, [&](Vec2d point) {
        if (can_show(chart, point) && is_within(other, along_x ? point.y : point.x)) {
            extent.hold(along_x ? point.x : point.y);
        }
    });
    const ReferenceDirection across = along_x ? ReferenceDirection::vertical : ReferenceDirection::horizontal;
    for (const ReferenceLine& reference : chart.references) {
        if (reference.direction == across && can_show(axis.scale, reference.at)) {
            extent.hold(reference.at);
        }
    }
    return extent;
}

/// Half the span that a single value is shown on.
double half_span_about(double value, double least_span) {
    if (least_span > 0.0) {
        return 0.5 * least_span;
    }
    return value == 0.0 ? 1.0 : 0.1 * std::abs(value);
}

AxisRange open_linear_range(const ChartAxis& axis, Extent extent) {
    if (extent.is_empty()) {
        extent = {0.0, 1.0};
    }
    if (axis.holds_zero) {
        extent.hold(0.0);
    }
    if (axis.is_symmetric) {
        const double half = std::max(std::abs(extent.low), std::abs(extent.high));
        extent = {-half, half};
    }
    const double missing = axis.least_span - (extent.high - extent.low);
    if (missing > 0.0) {
        const bool from_zero = axis.holds_zero && !axis.is_symmetric && extent.low == 0.0;
        extent.low -= from_zero ? 0.0 : 0.5 * missing;
        extent.high += from_zero ? missing : 0.5 * missing;
    }
    return {extent.low, extent.high};
}

/// A range between ends that are apart by more than doubles are, so that marks between them have values of their own.
AxisRange apart(AxisRange range, double least_span) {
    constexpr double kFewestDigits = 1e-11;
    const double largest = std::max(std::abs(range.low), std::abs(range.high));
    if (range.high - range.low > std::max(kFewestDigits * largest, 1e-290)) {
        return range;
    }
    const double middle = 0.5 * (range.low + range.high);
    const double half = std::max(half_span_about(largest < 1e-290 ? 0.0 : middle, least_span), kFewestDigits * largest);
    return {middle - half, middle + half};
}

AxisRange linear_range(const ChartAxis& axis, const Extent& extent, int most) {
    const AxisRange open = open_linear_range(axis, extent);
    const AxisRange round = rounded_outwards(apart(open, axis.least_span), most);
    AxisRange range{axis.low.value_or(round.low), axis.high.value_or(round.high)};
    if (!axis.low || !axis.high) {  // one given end may lie beyond all data
        if (range.high <= range.low) {
            const double span = round.high - round.low;
            (axis.low ? range.high : range.low) = axis.low ? range.low + span : range.high - span;
        }
    }
    return range;
}

AxisRange log_range(const ChartAxis& axis, const Extent& extent) {
    AxisRange open = extent.is_empty() ? AxisRange{1.0, 10.0} : AxisRange{extent.low, extent.high};
    if (open.high < 1.01 * open.low) {
        open = {0.5 * open.low, 2.0 * open.high};
    }
    const AxisRange round = log_rounded_outwards(open);
    const auto usable = [](const std::optional<double>& end) { return end && can_show(AxisScale::logarithmic, *end); };
    AxisRange range{usable(axis.low) ? *axis.low : round.low, usable(axis.high) ? *axis.high : round.high};
    if (range.high <= range.low && !(usable(axis.low) && usable(axis.high))) {
        (usable(axis.low) ? range.high : range.low) = usable(axis.low) ? 10.0 * range.low : 0.1 * range.high;
    }
    return range;
}

/// Ends that the caller fixed to one value or to none are taken as open.
ChartAxis with_usable_ends(ChartAxis axis) {
    const auto drop_bad = [&](std::optional<double>& end) {
        if (end && !can_show(axis.scale, *end)) {
            end.reset();
        }
    };
    drop_bad(axis.low);
    drop_bad(axis.high);
    if (axis.low && axis.high) {
        const AxisRange given{std::min(*axis.low, *axis.high), std::max(*axis.low, *axis.high)};
        const AxisRange wide = apart(given, axis.least_span);
        if (wide.low != given.low) {
            axis.low = wide.low > 0.0 || axis.scale == AxisScale::linear ? wide.low : 0.5 * given.low;
            axis.high = wide.high;
        }
    }
    return axis;
}

Ticks ticks_on(AxisScale scale, AxisRange range, int most) {
    const double low = std::min(range.low, range.high);
    const double high = std::max(range.low, range.high);
    return scale == AxisScale::linear ? linear_ticks(low, high, most) : log_ticks(low, high, most);
}

bool numbers_keep_clear(const ResolvedAxis& axis, double length, bool is_horizontal) {
    constexpr double kGap = 9.0;
    constexpr double kLineHeight = 1.45 * kTickTextSize;
    for (std::size_t i = 0; i + 1 < axis.ticks.major.size(); ++i) {
        const double distance =
            std::abs(axis.fraction(axis.ticks.major[i + 1]) - axis.fraction(axis.ticks.major[i])) * length;
        const double needed = is_horizontal ? kGap + 0.5 * (svg_text_width(axis.ticks.labels[i], kTickTextSize) +
                                                            svg_text_width(axis.ticks.labels[i + 1], kTickTextSize))
                                            : kLineHeight;
        if (distance < needed) {
            return false;
        }
    }
    return true;
}

ResolvedAxis resolve(const ChartAxis& given, const Extent& extent, double length, bool is_horizontal) {
    const ChartAxis axis = with_usable_ends(given);
    const double px_per_mark = is_horizontal ? 44.0 : 34.0;
    ResolvedAxis resolved{.scale = axis.scale};
    for (int most = std::clamp(static_cast<int>(length / px_per_mark), 2, 12); most >= 2; --most) {
        const AxisRange range =
            axis.scale == AxisScale::linear ? linear_range(axis, extent, most) : log_range(axis, extent);
        resolved.low = range.low;
        resolved.high = range.high;
        resolved.ticks = ticks_on(axis.scale, range, most);
        if (numbers_keep_clear(resolved, length, is_horizontal)) {
            break;
        }
    }
    return resolved;
}

/// Widens the axis that has more px per unit than the other.
void equalise(ResolvedAxes& axes, double width, double height) {
    const double x_scale = width / std::abs(axes.x.high - axes.x.low);
    const double y_scale = height / std::abs(axes.y.high - axes.y.low);
    const auto widen = [](ResolvedAxis& axis, double length, double factor, bool is_horizontal) {
        const double middle = 0.5 * (axis.low + axis.high);
        const double half = 0.5 * factor * (axis.high - axis.low);
        const ChartAxis wider{.scale = axis.scale, .low = middle - half, .high = middle + half};
        axis = resolve(wider, {}, length, is_horizontal);
    };
    if (x_scale > y_scale) {
        widen(axes.x, width, x_scale / y_scale, true);
    } else if (y_scale > x_scale) {
        widen(axes.y, height, y_scale / x_scale, false);
    }
}

void unite_ranges(std::vector<PlotChart>& charts, bool along_x) {
    Extent all;
    const auto axis_of = [&](PlotChart& chart) -> ChartAxis& { return along_x ? chart.x : chart.y; };
    ChartAxis joined;
    for (PlotChart& chart : charts) {
        const ChartAxis& axis = axis_of(chart);
        all.hold(extent_along(chart, along_x));
        joined.scale = axis.scale;
        joined.least_span = std::max(joined.least_span, axis.least_span);
        joined.holds_zero = joined.holds_zero || axis.holds_zero;
        joined.is_symmetric = joined.is_symmetric || axis.is_symmetric;
    }
    constexpr int kMarks = 5;
    const AxisRange range =
        joined.scale == AxisScale::linear ? linear_range(joined, all, kMarks) : log_range(joined, all);
    for (PlotChart& chart : charts) {
        ChartAxis& axis = axis_of(chart);
        axis.low = axis.low.value_or(range.low);
        axis.high = axis.high.value_or(range.high);
    }
}

}  // namespace

bool can_show(AxisScale scale, double value) {
    constexpr double kLargest = 1e280;
    constexpr double kSmallest = 1e-280;
    return scale == AxisScale::linear ? std::abs(value) <= kLargest : value >= kSmallest && value <= kLargest;
}

bool can_show(const PlotChart& chart, Vec2d point) {
    return can_show(chart.x.scale, point.x) && can_show(chart.y.scale, point.y);
}

std::size_t count_not_positive(const PlotChart& chart) {
    std::size_t count = 0;
    for (const ChartCurve& curve : chart.curves) {
        count += static_cast<std::size_t>(std::ranges::count_if(curve.points, [&](Vec2d point) {
            return std::isfinite(point.x) && std::isfinite(point.y) && !can_show(chart, point);
        }));
    }
    return count;
}

bool is_empty(const PlotChart& chart) {
    bool found = false;
    for_each_point(chart, false, [&](Vec2d point) { found = found || can_show(chart, point); });
    const bool has_map = chart.map && std::ranges::any_of(chart.map->values, [](double v) { return std::isfinite(v); });
    return !found && !has_map;
}

double ResolvedAxis::fraction(double value) const {
    if (!can_show(scale, value)) {
        return kNaN;
    }
    return scale == AxisScale::linear ? (value - low) / (high - low) : std::log(value / low) / std::log(high / low);
}

ResolvedAxes resolve_axes(const PlotChart& chart, double width, double height) {
    ChartAxis x = chart.x;
    ChartAxis y = chart.y;
    if (chart.map) {
        x = {.low = std::min(chart.map->x.low, x.low.value_or(kInfinity)),
             .high = std::max(chart.map->x.high, x.high.value_or(-kInfinity))};
        const bool runs_down = y.low && y.high && *y.low > *y.high;
        y = {.low = std::min(chart.map->y.low, y.low.value_or(kInfinity)),
             .high = std::max(chart.map->y.high, y.high.value_or(-kInfinity))};
        if (runs_down) {
            y = {.low = std::max(chart.map->y.high, *chart.y.low), .high = std::min(chart.map->y.low, *chart.y.high)};
        }
    }
    ResolvedAxes axes{resolve(x, extent_along(chart, true), width, true),
                      resolve(y, extent_along(chart, false), height, false)};
    const bool are_linear = axes.x.scale == AxisScale::linear && axes.y.scale == AxisScale::linear;
    if (chart.has_equal_scales && are_linear) {
        equalise(axes, width, height);
    }
    return axes;
}

std::string axis_title(const ChartAxis& axis, const ResolvedAxis& resolved) {
    std::string unit = axis.unit;
    if (resolved.ticks.exponent != 0) {
        unit = power_of_ten_text(resolved.ticks.exponent) + (unit.empty() ? "" : " " + unit);
    }
    return unit.empty() ? axis.label : axis.label.empty() ? unit : axis.label + " (" + unit + ")";
}

void unite_x_ranges(std::vector<PlotChart>& charts) {
    unite_ranges(charts, true);
}

void unite_colour_ranges(std::vector<PlotChart>& charts) {
    Extent all;
    for (const PlotChart& chart : charts) {
        if (chart.map) {
            all.hold(Extent{chart.map->range.low, chart.map->range.high});
        }
    }
    for (PlotChart& chart : charts) {
        if (chart.map) {
            chart.map->range = {all.low, all.high};
        }
    }
}

void unite_y_ranges(std::vector<PlotChart>& charts) {
    unite_ranges(charts, false);
}

}  // namespace lensproof::draw
