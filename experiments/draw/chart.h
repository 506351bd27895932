// experiments/draw/chart.h — curves over two axes, as an SVG file or as a panel of one.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/vec.h"
#include "experiments/draw/heat_map.h"
#include "experiments/draw/svg.h"
#include "experiments/draw/ticks.h"

namespace lensproof::draw {

/// An axis: what it measures and which part is shown. Where an end is not given, the data say it, rounded outwards to
/// a mark. x runs to the right and y upwards; an axis with `low` > `high` runs the other way.
struct ChartAxis {
    std::string label{};  // "Spatial frequency"
    std::string unit{};   // "cycles/mm"; empty for a number
    AxisScale scale = AxisScale::linear;
    std::optional<double> low{};
    std::optional<double> high{};
    double least_span = 0.0;    // of a linear axis: data that vary less are shown on this span, not blown up
    bool holds_zero = false;    // 0 belongs to the range (linear)
    bool is_symmetric = false;  // about 0 (linear)
};

enum class CurveLine { none, solid, dashed, dotted };
enum class CurveMarker { none, dot, ring, square, triangle, diamond, plus, cross };

/// A curve through `points`. It breaks where one is not finite or, on a logarithmic axis, not positive; the latter are
/// counted in a note under the chart. Outside the axes' range it is cut off at the frame.
struct ChartCurve {
    std::string label{};  // in the legend; empty: not there. Curves of the same label and looks share an entry
    std::vector<Vec2d> points{};
    std::string colour = "#0072b2";  // CSS, see palette.h
    CurveLine line = CurveLine::solid;
    CurveMarker marker = CurveMarker::none;
    double width = 1.6;        // px
    double marker_size = 5.0;  // px across
    double opacity = 1.0;
    bool sets_y_range = true;  // an open y axis holds it
    std::string group{};       // the class of a group around it, for a page's script; empty: none
};

/// An area with a colour: a band around a curve, a tolerance.
struct ChartArea {
    std::string label{};
    std::vector<Vec2d> outline{};  // a polygon that is closed by itself
    std::string colour = "#8a909b";
    double opacity = 0.18;
    bool is_hatched = false;   // lines at 45° instead of a ground: what is not sure
    bool sets_y_range = true;  // as a curve's
    std::string group{};
};

enum class ReferenceDirection { vertical, horizontal };

/// A line across the whole chart, behind the curves; its label stands outside the frame, where nothing is covered.
struct ReferenceLine {
    ReferenceDirection direction = ReferenceDirection::vertical;
    double at = 0.0;
    std::string label{};
    std::string colour = "#5f6672";
    CurveLine line = CurveLine::dashed;
};

struct PlotChart {
    std::string title{};
    std::string caption{};  // small, under the title
    ChartAxis x{};
    ChartAxis y{};
    std::optional<HeatMap> map{};  // behind everything; the axes show all of it, and more where they say so
    std::vector<ChartArea> areas{};
    std::vector<ReferenceLine> references{};
    std::vector<ChartCurve> curves{};       // later ones above earlier ones
    std::string note{};                     // small, under the chart
    std::string empty_message = "no data";  // where no point can be shown
    bool has_equal_scales = false;          // a unit of x is as long as a unit of y: the wider axis shows more
};

/// An axis with everything decided: `low` at the left or bottom end, `high` at the other.
struct ResolvedAxis {
    AxisScale scale = AxisScale::linear;
    double low = 0.0;
    double high = 1.0;
    Ticks ticks{};

    /// 0 at `low`, 1 at `high`; NaN for what a logarithmic axis cannot show.
    [[nodiscard]] double fraction(double value) const;
};

/// Where the data of a chart are on the page.
struct ChartFrame {
    PageBox box{};
    ResolvedAxis x{};
    ResolvedAxis y{};

    [[nodiscard]] SvgPoint to_page(Vec2d value) const;
};

/// One chart in a file of its own, `size` px wide and high, with the legend between title and frame. Any text is shown
/// as text; the same chart gives the same bytes; whatever the numbers are, nothing is thrown but std::bad_alloc and
/// what draw_heat_map throws.
struct ChartSize {
    double width = 760.0;
    double height = 480.0;
};
std::string chart_svg(const PlotChart& chart, ChartSize size = {});

/// Small multiples: panels in rows of `columns`, all frames of one size, with one legend for all.
struct ChartGrid {
    std::string title{};
    std::string caption{};
    std::vector<PlotChart> panels{};  // row by row
    std::size_t columns = 2;
    bool has_common_x = true;               // one range for all panels, its numbers under the lowest only
    bool has_common_y = true;               // … and at the leftmost
    bool has_common_colours = false;        // one range for the panels' maps, its bar at the rightmost
    ChartSize frame{300.0, 200.0};          // of each panel's axes
    std::vector<std::string> row_labels{};  // at the left of each row; may be empty
};
std::string chart_grid_svg(const ChartGrid& grid);

/// The parts that the two above are made of, for files that put charts beside other drawings.

struct PanelLook {
    bool has_x_numbers = true;
    bool has_y_numbers = true;
    bool has_legend = true;
    bool has_colour_bar = true;
    bool has_viewport = false;  // the data stand in a viewport of the class "data", for a page's script to narrow
};

/// The space (px) that a chart needs around its frame.
struct PanelMargins {
    double left = 0.0;
    double top = 0.0;
    double right = 0.0;
    double bottom = 0.0;
};
/// The frame of `chart` in a box of that place and size, and the margins that it leaves.
ChartFrame chart_frame(const PlotChart& chart, const PageBox& frame);
PanelMargins panel_margins(const PlotChart& chart, const ChartFrame& frame, const PanelLook& look);
/// The frame of `chart` on a page of that size, as large as its margins and `edge` px around them leave it.
ChartFrame fitted_frame(const PlotChart& chart, ChartSize size, const PanelLook& look, double edge);
void draw_chart(Svg& svg, const PlotChart& chart, const ChartFrame& frame, const PanelLook& look);

/// One range that holds the data of all charts, put into their axes where they leave it open.
void unite_x_ranges(std::vector<PlotChart>& charts);
void unite_y_ranges(std::vector<PlotChart>& charts);
void unite_colour_ranges(std::vector<PlotChart>& charts);

}  // namespace lensproof::draw
