#include "experiments/draw/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "experiments/draw/chart_axes.h"
#include "experiments/draw/chart_legend.h"
#include "experiments/draw/clipping.h"
#include "experiments/draw/label_row.h"
#include "experiments/draw/palette.h"

namespace lensproof::draw {

namespace {

constexpr double kAxisTextSize = 12.0;
constexpr double kTitleSize = 13.5;
constexpr double kSmallSize = 11.0;
constexpr double kMajorMark = 5.0;
constexpr double kMinorMark = 2.5;
constexpr double kNumberGap = 3.0;  // between a mark and its number
constexpr double kLine = 16.0;      // of text, px
constexpr double kHatchStep = 7.0;  // along x

std::size_t letters_in(double width, double size) {
    return static_cast<std::size_t>(std::max(8.0, std::floor(width / svg_text_width("x", size))));
}

std::vector<std::string> small_lines(const std::string& text, double width) {
    return text.empty() ? std::vector<std::string>{} : wrapped(text, letters_in(width, kSmallSize), 3);
}

std::vector<std::string> notes(const PlotChart& chart, double width) {
    std::string text = chart.note;
    if (const std::size_t dropped = count_not_positive(chart); dropped > 0) {
        text += fmt::format("{}{} {} not above zero and cannot stand on a logarithmic axis.", text.empty() ? "" : " ",
                            dropped, dropped == 1 ? "point is" : "points are");
    }
    return small_lines(text, width);
}

double widest_number(const ResolvedAxis& axis) {
    double width = 0.0;
    for (const std::string& label : axis.ticks.labels) {
        width = std::max(width, svg_text_width(label, kTickTextSize));
    }
    return width;
}

/// The labelled reference lines of one direction that are within the axis.
std::vector<const ReferenceLine*> labelled(const PlotChart& chart, const ChartFrame& frame,
                                           ReferenceDirection direction) {
    std::vector<const ReferenceLine*> found;
    const ResolvedAxis& axis = direction == ReferenceDirection::vertical ? frame.x : frame.y;
    for (const ReferenceLine& line : chart.references) {
        const double fraction = axis.fraction(line.at);
        if (line.direction == direction && !line.label.empty() && fraction >= 0.0 && fraction <= 1.0) {
            found.push_back(&line);
        }
    }
    return found;
}

constexpr std::size_t kMostReferenceLetters = 26;

/// Across the frame where an axis has that fraction: downwards, to the right.
std::vector<SvgPoint> across(const PageBox& box, bool is_x, double fraction) {
    const double x = box.x + fraction * box.width;
    const double y = box.y + (1.0 - fraction) * box.height;
    return is_x ? std::vector<SvgPoint>{{x, box.y}, {x, box.y + box.height}}
                : std::vector<SvgPoint>{{box.x, y}, {box.x + box.width, y}};
}

/// Where a mark and its number stand: on the lower or left edge.
SvgPoint on_edge(const PageBox& box, bool is_x, double fraction) {
    return across(box, is_x, fraction)[is_x ? 1 : 0];
}

void draw_mark_lines(Svg& svg, const ChartFrame& frame, bool is_x) {
    const ResolvedAxis& axis = is_x ? frame.x : frame.y;
    std::vector<std::vector<SvgPoint>> lines;
    for (const double value : axis.ticks.major) {
        lines.push_back(across(frame.box, is_x, axis.fraction(value)));
    }
    svg.paths(lines, {.stroke = kGridLine, .width = 1.0, .class_name = "grid"});
}

void draw_marks(Svg& svg, const ChartFrame& frame, bool is_x) {
    const ResolvedAxis& axis = is_x ? frame.x : frame.y;
    std::vector<std::vector<SvgPoint>> lines;
    const auto add = [&](double value, double length) {
        const SvgPoint edge = on_edge(frame.box, is_x, axis.fraction(value));
        lines.push_back({edge, is_x ? SvgPoint{edge.x, edge.y + length} : SvgPoint{edge.x - length, edge.y}});
    };
    for (const double value : axis.ticks.major) {
        add(value, kMajorMark);
    }
    for (const double value : axis.ticks.minor) {
        add(value, kMinorMark);
    }
    svg.paths(lines, {.stroke = kQuiet, .width = 0.9, .class_name = "marks"});
}

void draw_numbers(Svg& svg, const ChartFrame& frame, bool is_x) {
    const ResolvedAxis& axis = is_x ? frame.x : frame.y;
    for (std::size_t i = 0; i < axis.ticks.major.size(); ++i) {
        SvgPoint at = on_edge(frame.box, is_x, axis.fraction(axis.ticks.major[i]));
        at.x -= is_x ? 0.0 : kMajorMark + kNumberGap;
        at.y += is_x ? kMajorMark + kNumberGap + 0.8 * kTickTextSize : 0.35 * kTickTextSize;
        svg.text(at, axis.ticks.labels[i],
                 {.size = kTickTextSize,
                  .fill = kInk,
                  .anchor = is_x ? SvgAnchor::middle : SvgAnchor::end,
                  .class_name = "number"});
    }
}

void draw_axis_titles(Svg& svg, const PlotChart& chart, const ChartFrame& frame, const PanelLook& look) {
    const PageBox& box = frame.box;
    if (look.has_x_numbers) {
        const std::string title = shortened(axis_title(chart.x, frame.x), letters_in(box.width + 60.0, kAxisTextSize));
        svg.text({box.x + 0.5 * box.width, box.y + box.height + kMajorMark + kNumberGap + kLine + kLine}, title,
                 {.size = kAxisTextSize, .fill = kInk, .anchor = SvgAnchor::middle, .class_name = "axis-title"});
    }
    if (look.has_y_numbers) {
        const std::string title = shortened(axis_title(chart.y, frame.y), letters_in(box.height + 20.0, kAxisTextSize));
        svg.text({box.x - kMajorMark - kNumberGap - widest_number(frame.y) - 10.0, box.y + 0.5 * box.height}, title,
                 {.size = kAxisTextSize,
                  .fill = kInk,
                  .anchor = SvgAnchor::middle,
                  .rotation_deg = -90.0,
                  .class_name = "axis-title"});
    }
}

void draw_references(Svg& svg, const PlotChart& chart, const ChartFrame& frame) {
    for (const ReferenceLine& line : chart.references) {
        const bool is_vertical = line.direction == ReferenceDirection::vertical;
        const double fraction = (is_vertical ? frame.x : frame.y).fraction(line.at);
        if (!(fraction >= 0.0 && fraction <= 1.0)) {
            continue;
        }
        svg.path(across(frame.box, is_vertical, fraction), {.stroke = line.colour,
                                                            .width = 1.0,
                                                            .dashes = dash_pattern(line.line),
                                                            .class_name = "reference",
                                                            .description = line.label});
    }
}

void draw_reference_labels(Svg& svg, const PlotChart& chart, const ChartFrame& frame) {
    const PageBox& box = frame.box;
    const auto vertical = labelled(chart, frame, ReferenceDirection::vertical);
    std::vector<PlacedLabel> wishes;
    wishes.reserve(vertical.size());
    for (const ReferenceLine* line : vertical) {
        wishes.push_back({box.x + frame.x.fraction(line->at) * box.width,
                          svg_text_width(shortened(line->label, kMostReferenceLetters), kSmallSize) + 8.0});
    }
    std::vector<double> places = spread_labels(wishes, box.x - 20.0, box.x + box.width + 20.0);
    for (std::size_t i = 0; i < vertical.size(); ++i) {
        svg.text({places[i], box.y - 5.0}, shortened(vertical[i]->label, kMostReferenceLetters),
                 {.size = kSmallSize, .fill = vertical[i]->colour, .anchor = SvgAnchor::middle});
    }
    const auto horizontal = labelled(chart, frame, ReferenceDirection::horizontal);
    wishes.clear();
    for (const ReferenceLine* line : horizontal) {
        wishes.push_back({box.y + (1.0 - frame.y.fraction(line->at)) * box.height, kLine});
    }
    places = spread_labels(wishes, box.y, box.y + box.height);
    for (std::size_t i = 0; i < horizontal.size(); ++i) {
        svg.text({box.x + box.width + 6.0, places[i] + 0.35 * kSmallSize},
                 shortened(horizontal[i]->label, kMostReferenceLetters),
                 {.size = kSmallSize, .fill = horizontal[i]->colour});
    }
}

std::vector<SvgPoint> on_page(const ChartFrame& frame, const std::vector<Vec2d>& points) {
    std::vector<SvgPoint> page;
    page.reserve(points.size());
    std::ranges::transform(points, std::back_inserter(page), [&](Vec2d point) { return frame.to_page(point); });
    return page;
}

void draw_curve(Svg& svg, const ChartCurve& curve, const ChartFrame& frame) {
    const std::vector<SvgPoint> page = on_page(frame, curve.points);
    if (curve.line != CurveLine::none) {
        const std::vector<std::vector<SvgPoint>> pieces = clipped_line(page, frame.box);
        svg.paths(pieces, {.stroke = curve.colour,
                           .width = curve.width,
                           .dashes = dash_pattern(curve.line),
                           .opacity = curve.opacity,
                           .class_name = "curve",
                           .description = curve.label});
        if (curve.marker == CurveMarker::none) {  // a point between two gaps has no line to be seen by
            for (const std::vector<SvgPoint>& piece : pieces) {
                if (piece.size() == 1) {
                    svg.circle(piece.front(), 1.2 * curve.width, {.fill = curve.colour, .class_name = "lone"});
                }
            }
        }
    }
    std::vector<SvgPoint> visible;
    std::ranges::copy_if(page, std::back_inserter(visible), [&](SvgPoint p) { return is_inside(frame.box, p); });
    draw_markers(svg, visible, curve.marker, curve.marker_size, curve.colour);
}

void draw_area(Svg& svg, const ChartArea& area, const ChartFrame& frame) {
    const std::vector<SvgPoint> outline = clipped_polygon(on_page(frame, area.outline), frame.box);
    if (area.is_hatched) {
        svg.paths(hatching({outline}, kHatchStep),
                  {.stroke = area.colour, .width = 0.8, .opacity = area.opacity, .class_name = "hatch"});
    } else {
        svg.path(outline,
                 {.fill = area.colour, .opacity = area.opacity, .class_name = "area", .description = area.label}, true);
    }
}

/// The map as an axis that runs downwards has it: its lowest row at the top.
HeatMap upside_down(HeatMap map) {
    for (std::size_t row = 0; row < map.rows / 2; ++row) {
        const auto first = map.values.begin() + static_cast<std::ptrdiff_t>(row * map.columns);
        const auto last = map.values.begin() + static_cast<std::ptrdiff_t>((map.rows - 1 - row) * map.columns);
        std::swap_ranges(first, first + static_cast<std::ptrdiff_t>(map.columns), last);
    }
    std::swap(map.y.low, map.y.high);
    return map;
}

void draw_data(Svg& svg, const PlotChart& chart, const ChartFrame& frame) {
    if (chart.map) {
        const HeatMap map = frame.y.low > frame.y.high ? upside_down(*chart.map) : *chart.map;
        const SvgPoint corner = frame.to_page({map.x.low, map.y.high});
        const SvgPoint opposite = frame.to_page({map.x.high, map.y.low});
        svg.rectangle({frame.box.x, frame.box.y}, frame.box.width, frame.box.height, {.fill = kMaskColour});
        draw_heat_map(svg, map, {corner.x, corner.y, opposite.x - corner.x, opposite.y - corner.y});
    }
    const auto in_group = [&](const std::string& group, const auto& draw) {
        if (!group.empty()) {
            svg.open_group(group);
        }
        draw();
        if (!group.empty()) {
            svg.close_group();
        }
    };
    for (const ChartArea& area : chart.areas) {
        in_group(area.group, [&] { draw_area(svg, area, frame); });
    }
    draw_references(svg, chart, frame);
    for (const ChartCurve& curve : chart.curves) {
        in_group(curve.group, [&] { draw_curve(svg, curve, frame); });
    }
}

/// Title, caption, legend and reference labels: their heights above the frame.
double heading_height(const PlotChart& chart, const ChartFrame& frame, const PanelLook& look) {
    double height = 6.0;
    height += chart.title.empty() ? 0.0 : 20.0;
    height += kLine * static_cast<double>(small_lines(chart.caption, frame.box.width).size());
    if (look.has_legend) {
        height += legend_height(legend_entries(std::span(&chart, 1)), frame.box.width);
    }
    return height + (labelled(chart, frame, ReferenceDirection::vertical).empty() ? 0.0 : kLine);
}

void draw_heading(Svg& svg, const PlotChart& chart, const ChartFrame& frame, const PanelLook& look) {
    const PageBox& box = frame.box;
    double y = box.y - heading_height(chart, frame, look);
    if (!chart.title.empty()) {
        svg.text({box.x, y + kTitleSize}, shortened(chart.title, letters_in(box.width, kTitleSize)),
                 {.size = kTitleSize, .fill = kInk, .bold = true, .class_name = "title"});
        y += 20.0;
    }
    for (const std::string& line : small_lines(chart.caption, box.width)) {
        svg.text({box.x, y + kSmallSize}, line, {.size = kSmallSize, .fill = kQuiet, .class_name = "caption"});
        y += kLine;
    }
    if (look.has_legend) {
        draw_legend(svg, legend_entries(std::span(&chart, 1)), {box.x, y}, box.width);
    }
}

}  // namespace

SvgPoint ChartFrame::to_page(Vec2d value) const {
    return {box.x + x.fraction(value.x) * box.width, box.y + (1.0 - y.fraction(value.y)) * box.height};
}

ChartFrame chart_frame(const PlotChart& chart, const PageBox& frame) {
    ResolvedAxes axes = resolve_axes(chart, frame.width, frame.height);
    return {frame, std::move(axes.x), std::move(axes.y)};
}

PanelMargins panel_margins(const PlotChart& chart, const ChartFrame& frame, const PanelLook& look) {
    PanelMargins margins{.left = 10.0, .top = heading_height(chart, frame, look), .right = 14.0, .bottom = 10.0};
    if (look.has_y_numbers) {
        margins.left = kMajorMark + kNumberGap + widest_number(frame.y) + 12.0 + kAxisTextSize;
    }
    if (look.has_x_numbers) {
        margins.bottom = kMajorMark + kNumberGap + 2.0 * kLine + 8.0;
        margins.right = std::max(margins.right, 0.5 * widest_number(frame.x) + 4.0);
    }
    margins.bottom += kLine * static_cast<double>(notes(chart, frame.box.width).size());
    for (const ReferenceLine* line : labelled(chart, frame, ReferenceDirection::horizontal)) {
        const double width = svg_text_width(shortened(line->label, kMostReferenceLetters), kSmallSize);
        margins.right = std::max(margins.right, width + 12.0);
    }
    if (chart.map && look.has_colour_bar) {
        margins.right = std::max(margins.right, colour_bar_width(*chart.map, frame.box.height));
    }
    return margins;
}

void draw_chart(Svg& svg, const PlotChart& chart, const ChartFrame& frame, const PanelLook& look) {
    const PageBox& box = frame.box;
    svg.open_group("chart");
    draw_heading(svg, chart, frame, look);
    if (is_empty(chart)) {
        svg.text({box.x + 0.5 * box.width, box.y + 0.5 * box.height}, chart.empty_message,
                 {.size = kAxisTextSize, .fill = kQuiet, .anchor = SvgAnchor::middle, .class_name = "empty"});
    } else {
        if (!chart.map) {
            draw_mark_lines(svg, frame, true);
            draw_mark_lines(svg, frame, false);
        }
        if (look.has_viewport) {
            svg.open_viewport("data", box);
        }
        draw_data(svg, chart, frame);
        if (look.has_viewport) {
            svg.close_viewport();
        }
        draw_reference_labels(svg, chart, frame);
    }
    svg.rectangle({box.x, box.y}, box.width, box.height, {.stroke = kQuiet, .width = 0.9, .class_name = "frame"});
    PanelLook shown = look;
    for (const bool is_x : {true, false}) {
        const ChartAxis& axis = is_x ? chart.x : chart.y;
        if (!is_empty(chart) || (axis.low && axis.high)) {
            draw_marks(svg, frame, is_x);
        } else {
            (is_x ? shown.has_x_numbers : shown.has_y_numbers) = false;
        }
    }
    for (const bool is_x : {true, false}) {
        if (is_x ? shown.has_x_numbers : shown.has_y_numbers) {
            draw_numbers(svg, frame, is_x);
        }
    }
    draw_axis_titles(svg, chart, frame, shown);
    if (chart.map && look.has_colour_bar && !is_empty(chart)) {
        draw_colour_bar(svg, *chart.map, box);
    }
    double y = box.y + box.height + (look.has_x_numbers ? kMajorMark + kNumberGap + 2.0 * kLine + 4.0 : 4.0);
    for (const std::string& line : notes(chart, box.width)) {
        y += kLine;
        svg.text({box.x, y}, line, {.size = kSmallSize, .fill = kQuiet, .class_name = "note"});
    }
    svg.close_group();
}

ChartFrame fitted_frame(const PlotChart& chart, ChartSize size, const PanelLook& look, double edge) {
    constexpr double kLeast = 60.0;
    // Numbers decide the margins, the margins the frame, and the frame the numbers: twice settles it in practice, and
    // the height of the page yields where it does not.
    PageBox box{0.0, 0.0, size.width - 100.0, size.height - 100.0};
    for (int pass = 0; pass < 2; ++pass) {
        const PanelMargins margins = panel_margins(chart, chart_frame(chart, box), look);
        box = {edge + margins.left, edge + margins.top,
               std::max(kLeast, size.width - 2.0 * edge - margins.left - margins.right),
               std::max(kLeast, size.height - 2.0 * edge - margins.top - margins.bottom)};
    }
    return chart_frame(chart, box);
}

std::string chart_svg(const PlotChart& chart, ChartSize size) {
    constexpr double kEdge = 10.0;
    const PanelLook look;
    const ChartFrame frame = fitted_frame(chart, size, look, kEdge);
    const PageBox& box = frame.box;
    const PanelMargins margins = panel_margins(chart, frame, look);
    Svg svg(chart.title);
    draw_chart(svg, chart, frame, look);
    return svg.document(std::max(size.width, box.x + box.width + margins.right + kEdge),
                        std::max(size.height, box.y + box.height + margins.bottom + kEdge));
}

}  // namespace lensproof::draw
