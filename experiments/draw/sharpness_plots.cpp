#include "experiments/draw/sharpness_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/colour_map.h"
#include "experiments/draw/palette.h"
#include "experiments/draw/svg.h"

namespace lensproof::draw {

namespace {

constexpr double kMtfPageWidth = 1200.0;  // of the picture
constexpr double kMtfMargin = 12.0;
constexpr double kMtfTitleHeight = 30.0;
constexpr double kMtfTextSize = 10.0;
constexpr double kMtfCasing = 2.6;  // px, white under a coloured line
constexpr double kMtfLine = 1.3;
constexpr const char* kEdgeOnMap = "#ffffff";
constexpr const char* kMtfLabel = "MTF50";
constexpr const char* kMtfUnit = "cycles/px";

Vec2d along(const MarkedEdge& edge) {
    const double angle = radians(edge.normal_deg);
    return {-std::sin(angle), std::cos(angle)};
}

// The corners of what was measured, in turn.
std::vector<Vec2d> outline(const MarkedEdge& edge) {
    const Vec2d u = 0.5 * edge.length_px * along(edge);
    const double angle = radians(edge.normal_deg);
    const Vec2d v = 0.5 * edge.width_px * Vec2d{std::cos(angle), std::sin(angle)};
    const Vec2d& c = edge.centre_px;
    return {c - u - v, c + u - v, c + u + v, c - u + v};
}

HeatMap colours_of(const AxisRange& range) {
    return {.colours = ColourMap::sequential, .range = range, .label = kMtfLabel, .unit = kMtfUnit};
}

}  // namespace

AxisRange sharpness_range(const std::vector<MarkedEdge>& edges) {
    std::vector<double> values;
    values.reserve(edges.size());
    for (const MarkedEdge& edge : edges) {
        values.push_back(edge.mtf50_cycles_per_px);
    }
    if (values.empty()) {
        return {0.0, 0.5};
    }
    std::ranges::sort(values);
    const double last = static_cast<double>(values.size() - 1);
    const double low = values[static_cast<std::size_t>(0.05 * last)];
    const double high = values[static_cast<std::size_t>(std::ceil(0.95 * last))];
    return rounded_outwards({0.98 * low, 1.02 * high}, 6);
}

std::string sharpness_map_svg(const FrameMap& mtf50, const std::vector<MarkedEdge>& edges, const AxisRange& range) {
    PlotChart chart = frame_chart(mtf50, mtf50.title);
    chart.caption = fmt::format("{} edges", edges.size());
    chart.map = frame_heat_map(mtf50, range, AxisScale::linear);
    ChartCurve lines{.colour = kEdgeOnMap, .width = 1.2, .opacity = 0.8};
    const double shortest = 0.012 * mtf50.width_px;  // what can be seen on the page
    for (const MarkedEdge& edge : edges) {
        const Vec2d half = 0.5 * std::max(edge.length_px, shortest) * along(edge);
        lines.points.insert(lines.points.end(), {edge.centre_px - half, edge.centre_px + half, {kNaN, kNaN}});
    }
    chart.curves = {lines};
    chart.has_equal_scales = true;
    return chart_svg(chart, {.width = 760.0, .height = 120.0 + 640.0 * mtf50.height_px / mtf50.width_px});
}

std::string marked_edges_svg(const std::string& title, int width_px, int height_px, std::string_view png,
                             const std::vector<MarkedEdge>& edges, const AxisRange& range) {
    const double scale = kMtfPageWidth / width_px;
    const PageBox box{kMtfMargin, kMtfTitleHeight, kMtfPageWidth, scale * height_px};
    const auto on_page = [&](const Vec2d& px) {
        return SvgPoint{box.x + scale * (px.x + 0.5), box.y + scale * (px.y + 0.5)};
    };
    Svg svg(title);
    svg.text({kMtfMargin, 20.0}, shortened(title, 120), {.size = 14.0, .fill = kInk, .bold = true});
    svg.picture(box, png, title);
    for (const MarkedEdge& edge : edges) {
        std::vector<SvgPoint> corners;
        for (const Vec2d& corner : outline(edge)) {
            corners.push_back(on_page(corner));
        }
        const double fraction = (edge.mtf50_cycles_per_px - range.low) / (range.high - range.low);
        const std::string colour = map_colour_text(ColourMap::sequential, std::clamp(fraction, 0.0, 1.0));
        const std::string value = fmt::format("{:.3f}", edge.mtf50_cycles_per_px);
        svg.path(corners, {.stroke = "#fff", .width = kMtfCasing}, true);
        svg.path(corners, {.stroke = colour, .width = kMtfLine, .description = value + " cycles/px"}, true);
        const SvgPoint at = on_page(edge.centre_px);
        svg.rectangle({at.x - 14.0, at.y - 7.0}, 28.0, 12.0, {.fill = "#fff", .opacity = 0.8});
        svg.text({at.x, at.y + 2.5}, value, {.size = kMtfTextSize, .fill = kInk, .anchor = SvgAnchor::middle});
    }
    const HeatMap colours = colours_of(range);
    draw_colour_bar(svg, colours, box);
    return svg.document(box.x + box.width + colour_bar_width(colours, box.height) + kMtfMargin,
                        box.y + box.height + kMtfMargin);
}

}  // namespace lensproof::draw
