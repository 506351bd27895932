// Plots of waves: wavefronts, point images, modulation.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/draw/analysis_plots.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/chart_axes.h"
#include "experiments/draw/palette.h"
#include "experiments/draw/plot_words.h"

namespace lensproof::draw {

namespace {

constexpr double kMapSide = 200.0;  // px

HeatMap square_heat_map(const analysis::SquareMap& map) {
    return {.columns = map.size,
            .rows = map.size,
            .values = map.values,
            .x = {-map.half_width, map.half_width},
            .y = {-map.half_width, map.half_width}};
}

double largest(const std::vector<double>& values) {
    double most = 0.0;
    for (const double value : values) {
        most = std::isfinite(value) ? std::max(most, value) : most;
    }
    return most;
}

std::string why_empty(const std::string& remark) {
    return remark.empty() ? kNoLight : remark;
}

/// The square in the middle that holds all pixels above a hundredth of the peak, and a margin.
analysis::SquareMap bright_middle(const analysis::SquareMap& map) {
    const double least = 0.01 * largest(map.values);
    const auto middle = static_cast<double>(map.size - 1) / 2.0;
    double reach = 4.0;  // px
    for (std::size_t i = 0; i < map.values.size(); ++i) {
        if (map.values[i] > least) {
            const std::size_t row = i / map.size;
            const double x = static_cast<double>(i % map.size) - middle;
            const double y = static_cast<double>(row) - middle;
            reach = std::max({reach, std::abs(x), std::abs(y)});
        }
    }
    const auto cut = static_cast<std::size_t>(std::max(0.0, std::floor(middle - 1.25 * reach)));
    analysis::SquareMap part{.size = map.size - 2 * cut};
    part.half_width = map.half_width * static_cast<double>(part.size) / static_cast<double>(map.size);
    for (std::size_t row = cut; row < map.size - cut; ++row) {
        const auto start = map.values.begin() + static_cast<std::ptrdiff_t>(row * map.size + cut);
        part.values.insert(part.values.end(), start, start + static_cast<std::ptrdiff_t>(part.size));
    }
    return part;
}

bool is_map(const analysis::SquareMap& map) {
    return map.size > 0 && map.values.size() == map.size * map.size;
}

PlotChart psf_chart(const analysis::PsfMap& field, bool is_log) {
    PlotChart chart{.title = field_text(field.field_deg) + (is_log ? ", logarithmic" : ", linear"),
                    .x = {.label = "x", .unit = "µm"},
                    .y = {.label = "y", .unit = "µm"},
                    .empty_message = why_empty(field.remark)};
    if (!is_map(field.intensity)) {
        return chart;
    }
    HeatMap map = square_heat_map(is_log ? field.intensity : bright_middle(field.intensity));
    const double peak = largest(map.values);
    constexpr double kDecades = 1e-5;
    map.range = peak > 0.0 ? AxisRange{is_log ? kDecades * peak : 0.0, peak} : AxisRange{kDecades, 1.0};
    map.scale = is_log ? AxisScale::logarithmic : AxisScale::linear;
    map.label = "Perfect peak = 1";
    chart.map = std::move(map);
    chart.caption = is_empty(chart) ? "" : "Strehl ratio " + short_number(field.strehl, 3);
    return chart;
}

ChartAxis modulation_axis() {
    return {.label = "Modulation", .low = 0.0, .high = 1.0};
}

/// Solid and dashed curves of one colour; only the first is in the legend.
void add_pair(PlotChart& chart, const std::string& label, const std::string& colour,
              const std::vector<Vec2d>& tangential, const std::vector<Vec2d>& sagittal) {
    chart.curves.push_back({.label = label, .points = tangential, .colour = colour});
    chart.curves.push_back({.points = sagittal, .colour = colour, .line = CurveLine::dashed});
}

}  // namespace

std::string wavefront_svg(const PlotHeading& heading, const std::vector<analysis::FieldWavefront>& fields) {
    ChartGrid grid{.title = plot_title(heading, "wavefront"),
                   .caption = heading.conditions,
                   .columns = std::min<std::size_t>(3, std::max<std::size_t>(fields.size(), 1)),
                   .frame = {kMapSide, kMapSide}};
    double reach = 1.0;
    for (const analysis::FieldWavefront& field : fields) {
        reach = is_map(field.opd_waves) ? std::max(reach, field.opd_waves.half_width) : reach;
    }
    constexpr double kLeastWaves = 1e-3;
    for (const analysis::FieldWavefront& field : fields) {
        PlotChart chart{.title = field_text(field.field_deg),
                        .x = {.label = "Pupil x", .low = -reach, .high = reach},
                        .y = {.label = "Pupil y", .low = -reach, .high = reach},
                        .empty_message = why_empty(field.remark)};
        if (is_map(field.opd_waves)) {
            HeatMap map = square_heat_map(field.opd_waves);
            map.colours = ColourMap::diverging;
            map.range = symmetric_range(map.values, kLeastWaves);
            map.unit = "waves";
            chart.map = std::move(map);
        }
        if (!is_empty(chart)) {
            chart.title += ", " + wavelength_text(field.wavelength_nm);
            chart.caption = fmt::format("rms {} λ, P–V {} λ", short_number(field.rms_waves),
                                        short_number(field.peak_to_valley_waves));
        }
        grid.panels.push_back(std::move(chart));
    }
    return chart_grid_svg(grid);
}

std::string psf_svg(const PlotHeading& heading, const std::vector<analysis::PsfMap>& fields) {
    ChartGrid grid{.title = plot_title(heading, "point spread function"),
                   .caption = heading.conditions,
                   .columns = 2,
                   .has_common_x = false,
                   .has_common_y = false,
                   .frame = {kMapSide, kMapSide}};
    for (const analysis::PsfMap& field : fields) {
        grid.panels.push_back(psf_chart(field, false));
        grid.panels.push_back(psf_chart(field, true));
    }
    return chart_grid_svg(grid);
}

std::string mtf_svg(const PlotHeading& heading, const std::vector<analysis::FieldMtf>& fields,
                    const std::vector<Vec2d>& diffraction_limit, const std::string& kind) {
    PlotChart chart{.title = plot_title(heading, "modulation transfer" + (kind.empty() ? "" : ", " + kind)),
                    .caption = heading.conditions,
                    .x = {.label = "Spatial frequency", .unit = "cycles/mm", .low = 0.0},
                    .y = modulation_axis(),
                    .empty_message = kNoLight};
    chart.curves = {legend_only("tangential", CurveLine::solid), legend_only("sagittal", CurveLine::dashed)};
    if (!diffraction_limit.empty()) {
        chart.curves.push_back({.label = "diffraction limit",
                                .points = diffraction_limit,
                                .colour = "#8a909b",
                                .line = CurveLine::dotted});
    }
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const bool is_dark = fields[i].tangential.empty() && fields[i].sagittal.empty();
        const std::string remark = is_dark ? why_empty(fields[i].remark) : fields[i].remark;
        add_pair(chart, field_text(fields[i].field_deg) + (remark.empty() ? "" : " (" + remark + ")"),
                 ordered_colour(i, fields.size()), fields[i].tangential, fields[i].sagittal);
    }
    return chart_svg(chart, {760.0, 480.0});
}

std::string mtf_field_svg(const PlotHeading& heading, const std::vector<analysis::FrequencyMtf>& frequencies) {
    PlotChart chart{.title = plot_title(heading, "modulation against field"),
                    .caption = heading.conditions,
                    .x = {.label = "Field angle", .unit = "°", .least_span = 1.0, .holds_zero = true},
                    .y = modulation_axis(),
                    .empty_message = kNoLight};
    chart.curves = {legend_only("tangential", CurveLine::solid), legend_only("sagittal", CurveLine::dashed)};
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
        const analysis::FrequencyMtf& frequency = frequencies[i];
        add_pair(chart, short_number(frequency.cycles_per_mm) + " cycles/mm", ordered_colour(i, frequencies.size()),
                 in_order(frequency.tangential), in_order(frequency.sagittal));
    }
    return chart_svg(chart, {680.0, 440.0});
}

}  // namespace lensproof::draw
