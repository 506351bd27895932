// experiments/draw/chart_axes.h — from what a chart says of its axes and from its data to ranges and marks.
#pragma once
#include "experiments/draw/chart.h"

namespace lensproof::draw {

inline constexpr double kTickTextSize = 11.0;  // px

/// Whether a coordinate can stand on an axis of that scale: finite (and within what arithmetic on ranges holds), and
/// positive where the scale is logarithmic.
bool can_show(AxisScale scale, double value);
bool can_show(const PlotChart& chart, Vec2d point);

/// Points of all curves with two finite coordinates of which a logarithmic axis cannot show one.
std::size_t count_not_positive(const PlotChart& chart);

/// Whether the chart has anything at all to show.
bool is_empty(const PlotChart& chart);

/// The axes of a chart whose frame is so many px wide and high: open ends from the data, marks so many that their
/// numbers keep clear of each other.
struct ResolvedAxes {
    ResolvedAxis x;
    ResolvedAxis y;
};
ResolvedAxes resolve_axes(const PlotChart& chart, double width, double height);

/// "Focus shift (10⁻³ mm)".
std::string axis_title(const ChartAxis& axis, const ResolvedAxis& resolved);

}  // namespace lensproof::draw
