// Spot diagrams through focus: a matrix of fields and planes on one scale.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/draw/analysis_plots.h"
#include "experiments/draw/chart_legend.h"
#include "experiments/draw/clipping.h"
#include "experiments/draw/palette.h"
#include "experiments/draw/plot_words.h"
#include "experiments/draw/ticks.h"

namespace lensproof::draw {

namespace {

constexpr double kSpotEdge = 12.0;
constexpr double kCell = 132.0;
constexpr double kGap = 8.0;
constexpr double kUnder = 18.0;  // the line of text under a cell
constexpr double kSpotTitleSize = 16.0;
constexpr double kSpotTextSize = 11.0;
constexpr double kLabelSize = 12.5;
constexpr double kDot = 2.6;

/// The markers of the wavelengths in turn.
CurveMarker wavelength_marker(std::size_t index) {
    static constexpr std::array kMarkers = {CurveMarker::dot,  CurveMarker::plus,   CurveMarker::cross,
                                            CurveMarker::ring, CurveMarker::square, CurveMarker::triangle};
    return kMarkers[index % kMarkers.size()];
}

/// All wavelengths in the order of their first appearance.
std::vector<double> wavelengths_of(const std::vector<analysis::FieldSpots>& fields) {
    std::vector<double> found;
    for (const analysis::FieldSpots& field : fields) {
        for (const analysis::Spot& spot : field.spots) {
            for (const analysis::WavelengthCurve& rays : spot.rays) {
                if (std::ranges::find(found, rays.wavelength_nm) == found.end()) {
                    found.push_back(rays.wavelength_nm);
                }
            }
        }
    }
    return found;
}

/// Half the side of every cell, µm: the farthest ray or the Airy disc, rounded up to 1, 2 or 5 times a power of ten or
/// a fifth of it.
double half_side(const std::vector<analysis::FieldSpots>& fields) {
    constexpr double kLeast = 0.1;
    constexpr double kMost = 1e9;
    double most = kLeast;
    const auto hold = [&](double value) { most = std::isfinite(value) ? std::max(most, std::abs(value)) : most; };
    for (const analysis::FieldSpots& field : fields) {
        hold(1.1 * field.airy_radius_um);
        for (const analysis::Spot& spot : field.spots) {
            for (const analysis::WavelengthCurve& rays : spot.rays) {
                for (const Vec2d point : rays.points) {
                    hold(point.x);
                    hold(point.y);
                }
            }
        }
    }
    return rounded_outwards({0.0, std::min(1.04 * most, kMost)}, 4).high;
}

bool has_rays(const analysis::Spot& spot) {
    return std::ranges::any_of(spot.rays, [](const analysis::WavelengthCurve& rays) { return !rays.points.empty(); });
}

struct SpotScale {
    double half_side_um = 1.0;
    std::vector<double> wavelengths{};

    [[nodiscard]] double px(double um) const { return um * 0.5 * kCell / half_side_um; }
};

void draw_spot(Svg& svg, const analysis::Spot& spot, double airy_radius_um, const PageBox& cell,
               const SpotScale& scale) {
    const SvgPoint middle{cell.x + 0.5 * cell.width, cell.y + 0.5 * cell.height};
    svg.open_group("spot");
    svg.rectangle({cell.x, cell.y}, cell.width, cell.height, {.fill = "#fbfbfc", .stroke = kFaint, .width = 0.9});
    if (!has_rays(spot)) {
        svg.text(middle, "no light", {.size = kSpotTextSize, .fill = kQuiet, .anchor = SvgAnchor::middle});
        svg.close_group();
        return;
    }
    svg.paths(
        {{{middle.x, cell.y}, {middle.x, cell.y + cell.height}}, {{cell.x, middle.y}, {cell.x + cell.width, middle.y}}},
        {.stroke = kGridLine, .width = 0.8});
    for (const analysis::WavelengthCurve& rays : spot.rays) {
        std::vector<SvgPoint> dots;
        for (const Vec2d point : rays.points) {
            const SvgPoint dot{middle.x + scale.px(point.x), middle.y - scale.px(point.y)};
            if (is_inside(cell, dot)) {
                dots.push_back(dot);
            }
        }
        const auto index = std::ranges::find(scale.wavelengths, rays.wavelength_nm) - scale.wavelengths.begin();
        draw_markers(svg, dots, wavelength_marker(static_cast<std::size_t>(index)), kDot,
                     wavelength_colour(rays.wavelength_nm));
    }
    svg.circle(middle, scale.px(airy_radius_um), {.stroke = kInk, .width = 0.9, .class_name = "airy"});
    svg.text({middle.x, cell.y + cell.height + 12.5}, "rms " + short_number(spot.rms_um) + " µm",
             {.size = kSpotTextSize, .fill = kInk, .anchor = SvgAnchor::middle, .class_name = "rms"});
    svg.close_group();
}

std::vector<PlotChart> legend_of(const SpotScale& scale) {
    PlotChart chart;
    for (std::size_t i = 0; i < scale.wavelengths.size(); ++i) {
        chart.curves.push_back({.label = wavelength_text(scale.wavelengths[i]),
                                .colour = wavelength_colour(scale.wavelengths[i]),
                                .line = CurveLine::none,
                                .marker = wavelength_marker(i)});
    }
    return {chart};
}

/// The bar of known length that stands above the matrix, and what the circles are; returns where they end.
double draw_scale_bar(Svg& svg, const SpotScale& scale, double y) {
    const double length_um = linear_ticks(0.0, scale.half_side_um, 3).major.at(1);
    const double length = scale.px(length_um);
    const double middle = y + 9.0;
    svg.paths({{{kSpotEdge, middle}, {kSpotEdge + length, middle}},
               {{kSpotEdge, middle - 3.5}, {kSpotEdge, middle + 3.5}},
               {{kSpotEdge + length, middle - 3.5}, {kSpotEdge + length, middle + 3.5}}},
              {.stroke = kInk, .width = 1.2, .class_name = "scale-bar"});
    svg.text({kSpotEdge + length + 8.0, middle + 0.35 * kSpotTextSize},
             fmt::format("{} µm; circle: Airy disc; columns: defocus from the image plane", short_number(length_um)),
             {.size = kSpotTextSize, .fill = kInk});
    return y + 22.0;
}

double draw_heading(Svg& svg, const PlotHeading& heading, const SpotScale& scale, double width) {
    const auto letters = [&](double size) { return static_cast<std::size_t>(width / svg_text_width("x", size)); };
    double y = kSpotEdge;
    svg.text({kSpotEdge, y + kSpotTitleSize},
             shortened(plot_title(heading, "spots through focus"), letters(kSpotTitleSize)),
             {.size = kSpotTitleSize, .fill = kInk, .bold = true, .class_name = "title"});
    y += 24.0;
    if (!heading.conditions.empty()) {
        for (const std::string& line : wrapped(heading.conditions, letters(kSpotTextSize), 3)) {
            svg.text({kSpotEdge, y + kSpotTextSize}, line,
                     {.size = kSpotTextSize, .fill = kQuiet, .class_name = "caption"});
            y += 16.0;
        }
    }
    const std::vector<PlotChart> legend = legend_of(scale);
    const std::vector<LegendEntry> entries = legend_entries(legend);
    draw_legend(svg, entries, {kSpotEdge, y + 2.0}, width);
    return draw_scale_bar(svg, scale, y + 4.0 + legend_height(entries, width));
}

}  // namespace

std::string spots_svg(const PlotHeading& heading, const std::vector<double>& defocus_mm,
                      const std::vector<analysis::FieldSpots>& fields) {
    const SpotScale scale{half_side(fields), wavelengths_of(fields)};
    double label_width = 0.0;
    for (const analysis::FieldSpots& field : fields) {
        label_width = std::max(label_width, svg_text_width(field_text(field.field_deg), kLabelSize) + 10.0);
    }
    constexpr double kLeastWidth = 380.0;
    const double left = kSpotEdge + label_width;
    const double width =
        std::max(kLeastWidth, left + static_cast<double>(defocus_mm.size()) * (kCell + kGap) - kGap - kSpotEdge);
    Svg svg(plot_title(heading, "spots through focus"));
    double y = draw_heading(svg, heading, scale, width) + 16.0;
    const auto cell_x = [&](std::size_t column) { return left + static_cast<double>(column) * (kCell + kGap); };
    for (std::size_t i = 0; i < defocus_mm.size(); ++i) {
        const std::string sign = defocus_mm[i] > 0.0 ? "+" : "";
        svg.text({cell_x(i) + 0.5 * kCell, y}, sign + short_number(defocus_mm[i]) + " mm",
                 {.size = kSpotTextSize, .fill = kInk, .anchor = SvgAnchor::middle, .class_name = "number"});
    }
    y += 8.0;
    for (const analysis::FieldSpots& field : fields) {
        svg.text({kSpotEdge, y + 0.5 * kCell + 0.35 * kLabelSize}, field_text(field.field_deg),
                 {.size = kLabelSize, .fill = kInk, .bold = true, .class_name = "row-label"});
        for (std::size_t i = 0; i < defocus_mm.size(); ++i) {
            const analysis::Spot none;
            draw_spot(svg, i < field.spots.size() ? field.spots[i] : none, field.airy_radius_um,
                      {cell_x(i), y, kCell, kCell}, scale);
        }
        y += kCell + kUnder + kGap;
    }
    if (fields.empty() || defocus_mm.empty()) {
        svg.text({kSpotEdge, y + 12.0}, "no data", {.size = kLabelSize, .fill = kQuiet, .class_name = "empty"});
        y += 24.0;
    }
    return svg.document(width + 2.0 * kSpotEdge, y + kSpotEdge - kGap);
}

}  // namespace lensproof::draw
