#include "experiments/draw/chart_legend.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/draw/palette.h"

namespace lensproof::draw {

namespace {

constexpr double kTextSize = 11.0;
constexpr double kSample = 24.0;  // px of line
constexpr double kSampleGap = 6.0;
constexpr double kEntryGap = 18.0;

std::string fitting(const std::string& label, double width) {
    const double letters = (width - kSample - kSampleGap) / svg_text_width("x", kTextSize);
    return shortened(label, static_cast<std::size_t>(std::max(4.0, std::floor(letters))));
}

double entry_width(const LegendEntry& entry, double width) {
    return kSample + kSampleGap + svg_text_width(fitting(entry.label, width), kTextSize);
}

/// The upper left corner of each entry, broken into rows like words.
std::vector<SvgPoint> entry_corners(const std::vector<LegendEntry>& entries, double width) {
    std::vector<SvgPoint> corners;
    SvgPoint at;
    for (const LegendEntry& entry : entries) {
        const double needed = entry_width(entry, width);
        if (at.x > 0.0 && at.x + needed > width) {
            at = {0.0, at.y + kLegendRowHeight};
        }
        corners.push_back(at);
        at.x += needed + kEntryGap;
    }
    return corners;
}

using Outline = std::vector<SvgPoint>;

/// A regular polygon of that circumradius; the first corner is at `start_deg` from the right, counted clockwise.
Outline polygon(SvgPoint centre, double radius, int corners, double start_deg) {
    Outline outline;
    for (int i = 0; i < corners; ++i) {
        const double angle = (start_deg / 180.0 + 2.0 * i / corners) * std::numbers::pi;
        outline.push_back({centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)});
    }
    return outline;
}

/// What a mark is made of, at about the same area for every closed kind.
std::vector<Outline> marker_outlines(SvgPoint at, CurveMarker marker, double size) {
    const double r = 0.5 * size;
    switch (marker) {
        case CurveMarker::none:
            return {};
        case CurveMarker::dot:
            return {{at, at}};
        case CurveMarker::ring:
            return {polygon(at, r, 8, 22.5)};
        case CurveMarker::square:
            return {polygon(at, 1.25 * r, 4, 45.0)};
        case CurveMarker::triangle:
            return {polygon(at, 1.35 * r, 3, -90.0)};
        case CurveMarker::diamond:
            return {polygon(at, 1.3 * r, 4, 0.0)};
        case CurveMarker::plus:
            return {{{at.x - r, at.y}, {at.x + r, at.y}}, {{at.x, at.y - r}, {at.x, at.y + r}}};
        case CurveMarker::cross: {
            const double d = 0.8 * r;
            return {{{at.x - d, at.y - d}, {at.x + d, at.y + d}}, {{at.x - d, at.y + d}, {at.x + d, at.y - d}}};
        }
    }
    return {};
}

}  // namespace

std::string dash_pattern(CurveLine line) {
    switch (line) {
        case CurveLine::dashed:
            return "6 4";
        case CurveLine::dotted:
            return "1.5 3";
        default:
            return "";
    }
}

void draw_markers(Svg& svg, const std::vector<SvgPoint>& points, CurveMarker marker, double size,
                  const std::string& colour) {
    std::vector<Outline> outlines;
    for (const SvgPoint& point : points) {
        std::ranges::move(marker_outlines(point, marker, size), std::back_inserter(outlines));
    }
    if (marker == CurveMarker::dot) {
        svg.paths(outlines, {.stroke = colour, .width = size, .has_round_ends = true, .class_name = "marks"});
        return;
    }
    const bool is_open = marker == CurveMarker::plus || marker == CurveMarker::cross;
    const bool is_hollow = marker == CurveMarker::ring;
    SvgStyle style{.fill = is_open ? "none" : is_hollow ? "#fff" : colour, .class_name = "marks"};
    if (is_open || is_hollow) {
        style.stroke = colour;
        style.width = std::clamp(0.22 * size, 0.6, 1.3);
    }
    svg.paths(outlines, style, !is_open);
}

std::vector<LegendEntry> legend_entries(std::span<const PlotChart> charts) {
    std::vector<LegendEntry> entries;
    const auto add = [&](LegendEntry entry) {
        if (!entry.label.empty() && std::ranges::find(entries, entry) == entries.end()) {
            entries.push_back(std::move(entry));
        }
    };
    for (const PlotChart& chart : charts) {
        for (const ChartCurve& curve : chart.curves) {
            add({.label = curve.label, .colour = curve.colour, .line = curve.line, .marker = curve.marker});
        }
    }
    for (const PlotChart& chart : charts) {
        for (const ChartArea& area : chart.areas) {
            add({.label = area.label, .colour = area.colour, .is_area = true, .opacity = area.opacity});
        }
    }
    return entries;
}

double legend_height(const std::vector<LegendEntry>& entries, double width) {
    return entries.empty() ? 0.0 : entry_corners(entries, width).back().y + kLegendRowHeight;
}

void draw_legend(Svg& svg, const std::vector<LegendEntry>& entries, SvgPoint corner, double width) {
    const std::vector<SvgPoint> corners = entry_corners(entries, width);
    svg.open_group("legend");
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const LegendEntry& entry = entries[i];
        const SvgPoint left{corner.x + corners[i].x, corner.y + corners[i].y + 0.5 * kLegendRowHeight};
        if (entry.is_area) {
            svg.rectangle({left.x, left.y - 5.0}, kSample, 10.0, {.fill = entry.colour, .opacity = entry.opacity});
        } else if (entry.line != CurveLine::none) {
            svg.line(left, {left.x + kSample, left.y},
                     {.stroke = entry.colour, .width = 1.8, .dashes = dash_pattern(entry.line)});
        }
        draw_markers(svg, {{left.x + 0.5 * kSample, left.y}}, entry.marker, 7.0, entry.colour);
        svg.text({left.x + kSample + kSampleGap, left.y + 0.35 * kTextSize}, fitting(entry.label, width),
                 {.size = kTextSize, .fill = kInk});
    }
    svg.close_group();
}

}  // namespace lensproof::draw
