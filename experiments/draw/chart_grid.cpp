// Small multiples: the layout of panels in rows and columns under one heading.
#include <algorithm>
#include <numeric>
#include <span>

#include "experiments/draw/chart.h"
#include "experiments/draw/chart_legend.h"
#include "experiments/draw/palette.h"

namespace lensproof::draw {

namespace {

constexpr double kGridEdge = 12.0;
constexpr double kPanelGap = 10.0;
constexpr double kGridTitleSize = 16.0;
constexpr double kGridTextSize = 11.5;
constexpr double kLineHeight = 17.0;
constexpr double kRowLabelSize = 12.5;

struct GridPanel {
    PanelLook look;
    ChartFrame frame;
    PanelMargins margins;
};

/// The sum of the first `count` sizes with a gap after each.
double offset_of(const std::vector<double>& sizes, std::size_t count) {
    return std::accumulate(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(count), 0.0) +
           kPanelGap * static_cast<double>(count);
}

std::vector<GridPanel> measured_panels(const std::vector<PlotChart>& charts, const ChartGrid& grid,
                                       std::size_t columns) {
    std::vector<GridPanel> panels;
    for (std::size_t i = 0; i < charts.size(); ++i) {
        GridPanel panel;
        panel.look = {
            .has_x_numbers = !grid.has_common_x || i + columns >= charts.size(),
            .has_y_numbers = !grid.has_common_y || i % columns == 0,
            .has_legend = false,
            .has_colour_bar = !grid.has_common_colours || i % columns + 1 == columns || i + 1 == charts.size()};
        panel.frame = chart_frame(charts[i], {0.0, 0.0, grid.frame.width, grid.frame.height});
        panel.margins = panel_margins(charts[i], panel.frame, panel.look);
        panels.push_back(std::move(panel));
    }
    return panels;
}

/// The widest margins of each column and of each row, so that frames stand in line.
struct GridMargins {
    std::vector<double> left;
    std::vector<double> right;
    std::vector<double> top;
    std::vector<double> bottom;
};

GridMargins widest_margins(const std::vector<GridPanel>& panels, std::size_t columns) {
    const std::size_t rows = (panels.size() + columns - 1) / columns;
    GridMargins widest{std::vector<double>(columns), std::vector<double>(columns), std::vector<double>(rows),
                       std::vector<double>(rows)};
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const PanelMargins& margins = panels[i].margins;
        const auto widen = [](double& side, double needed) { side = std::max(side, needed); };
        widen(widest.left[i % columns], margins.left);
        widen(widest.right[i % columns], margins.right);
        widen(widest.top[i / columns], margins.top);
        widen(widest.bottom[i / columns], margins.bottom);
    }
    return widest;
}

/// Title, caption and legend from `top` on; returns where they end.
double draw_grid_heading(Svg& svg, const ChartGrid& grid, double top, double width) {
    const auto letters = [&](double size) {
        return static_cast<std::size_t>(std::max(8.0, width / svg_text_width("x", size)));
    };
    if (!grid.title.empty()) {
        svg.text({kGridEdge, top + kGridTitleSize}, shortened(grid.title, letters(kGridTitleSize)),
                 {.size = kGridTitleSize, .fill = kInk, .bold = true, .class_name = "title"});
        top += 24.0;
    }
    if (!grid.caption.empty()) {
        for (const std::string& line : wrapped(grid.caption, letters(kGridTextSize), 4)) {
            svg.text({kGridEdge, top + kGridTextSize}, line,
                     {.size = kGridTextSize, .fill = kQuiet, .class_name = "caption"});
            top += kLineHeight;
        }
    }
    const std::vector<LegendEntry> entries = legend_entries(grid.panels);
    draw_legend(svg, entries, {kGridEdge, top + 2.0}, width);
    return top + 8.0 + legend_height(entries, width);
}

}  // namespace

std::string chart_grid_svg(const ChartGrid& grid) {
    std::vector<PlotChart> charts = grid.panels;
    const std::size_t columns = std::clamp<std::size_t>(grid.columns, 1, std::max<std::size_t>(charts.size(), 1));
    if (grid.has_common_x) {
        unite_x_ranges(charts);
    }
    if (grid.has_common_y) {
        unite_y_ranges(charts);
    }
    if (grid.has_common_colours) {
        unite_colour_ranges(charts);
    }
    std::vector<GridPanel> panels = measured_panels(charts, grid, columns);
    const GridMargins margins = widest_margins(panels, columns);
    std::vector<double> widths(columns);
    std::vector<double> heights(margins.top.size());
    for (std::size_t i = 0; i < widths.size(); ++i) {
        widths[i] = margins.left[i] + grid.frame.width + margins.right[i];
    }
    for (std::size_t i = 0; i < heights.size(); ++i) {
        heights[i] = margins.top[i] + grid.frame.height + margins.bottom[i];
    }
    double label_width = 0.0;
    for (const std::string& label : grid.row_labels) {
        label_width = std::max(label_width, svg_text_width(label, kRowLabelSize) + 8.0);
    }
    constexpr double kLeastWidth = 300.0;
    const double width = std::max(kLeastWidth, label_width + offset_of(widths, columns) - kPanelGap);

    Svg svg(grid.title);
    const double top = draw_grid_heading(svg, grid, kGridEdge, width);
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const std::size_t column = i % columns;
        const std::size_t row = i / columns;
        panels[i].frame.box.x = kGridEdge + label_width + offset_of(widths, column) + margins.left[column];
        panels[i].frame.box.y = top + offset_of(heights, row) + margins.top[row];
        draw_chart(svg, charts[i], panels[i].frame, panels[i].look);
        if (column == 0 && row < grid.row_labels.size()) {
            svg.text({kGridEdge, panels[i].frame.box.y + 0.5 * grid.frame.height + 0.35 * kRowLabelSize},
                     grid.row_labels[row],
                     {.size = kRowLabelSize, .fill = kInk, .bold = true, .class_name = "row-label"});
        }
    }
    return svg.document(width + 2.0 * kGridEdge, top + offset_of(heights, heights.size()) + kGridEdge);
}

}  // namespace lensproof::draw
