// experiments/draw/chart_legend.h — what the curves of charts mean, in rows beside no data.
#pragma once
#include <span>
#include <vector>

#include "experiments/draw/chart.h"

namespace lensproof::draw {

inline constexpr double kLegendRowHeight = 18.0;  // px

struct LegendEntry {
    std::string label{};
    std::string colour{};
    CurveLine line = CurveLine::solid;
    CurveMarker marker = CurveMarker::none;
    bool is_area = false;
    double opacity = 1.0;

    friend bool operator==(const LegendEntry&, const LegendEntry&) = default;
};

/// The labelled curves and areas of the charts, each look once, in the order of their first appearance.
std::vector<LegendEntry> legend_entries(std::span<const PlotChart> charts);

/// The height of the rows that the entries take within `width` px; 0 for none.
double legend_height(const std::vector<LegendEntry>& entries, double width);

void draw_legend(Svg& svg, const std::vector<LegendEntry>& entries, SvgPoint corner, double width);

/// "6 4" for dashed, "1.5 3" for dotted, nothing for solid.
std::string dash_pattern(CurveLine line);

/// Marks of one kind as one element.
void draw_markers(Svg& svg, const std::vector<SvgPoint>& points, CurveMarker marker, double size,
                  const std::string& colour);

}  // namespace lensproof::draw
