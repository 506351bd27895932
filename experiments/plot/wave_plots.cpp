// Plots of waves: wavefronts, point images, modulation.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/plot/analysis_plots.h"
#include "experiments/plot/chart.h"
#include "experiments/plot/chart_axes.h"
#include "experiments/plot/palette.h"
#include "experiments/plot/plot_words.h"

namespace lensproof {

namespace {

constexpr const char* kNoLight = "no light";
constexpr double kMapSide = 200.0;  // px

HeatMap square_heat_map(const SquareMap& map) {
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

/// Whether one set of numbers under the lowest panel serves all.
template <class Field>
bool have_one_size(const std::vector<Field>& fields, SquareMap Field::*map) {
    return std::ranges::all_of(
        fields, [&](const Field& field) { return (field.*map).half_width == (fields.front().*map).half_width; });
}

PlotChart psf_chart(const PsfMap& field, bool is_log) {
    PlotChart chart{.title = field_text(field.field_deg) + (is_log ? ", logarithmic" : ", linear"),
                    .x = {.label = "x", .unit = "µm"},
                    .y = {.label = "y", .unit = "µm"},
                    .empty_message = kNoLight};
    HeatMap map = square_heat_map(field.intensity);
    const double peak = largest(map.values);
    constexpr double kDecades = 1e-5;
    map.range = peak > 0.0 ? AxisRange{is_log ? kDecades * peak : 0.0, peak} : AxisRange{kDecades, 1.0};
    map.scale = is_log ? AxisScale::logarithmic : AxisScale::linear;
    map.label = "Intensity, perfect peak = 1";
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

std::string wavefront_svg(const PlotHeading& heading, const std::vector<WavefrontMap>& fields) {
    ChartGrid grid{.title = plot_title(heading, "wavefront"),
                   .caption = heading.conditions,
                   .columns = std::min<std::size_t>(3, std::max<std::size_t>(fields.size(), 1)),
                   .frame = {kMapSide, kMapSide}};
    grid.shares_x = have_one_size(fields, &WavefrontMap::opd_waves);
    grid.shares_y = grid.shares_x;
    constexpr double kLeastWaves = 1e-3;
    for (const WavefrontMap& field : fields) {
        PlotChart chart{.title = field_text(field.field_deg) + ", " + wavelength_text(field.wavelength_nm),
                        .x = {.label = "Pupil x"},
                        .y = {.label = "Pupil y"},
                        .empty_message = kNoLight};
        HeatMap map = square_heat_map(field.opd_waves);
        map.colours = ColourMap::diverging;
        map.range = symmetric_range(map.values, kLeastWaves);
        map.unit = "waves";
        chart.map = std::move(map);
        chart.caption = is_empty(chart) ? ""
                                        : fmt::format("rms {} λ, P–V {} λ", short_number(field.rms_waves),
                                                      short_number(field.peak_to_valley_waves));
        grid.panels.push_back(std::move(chart));
    }
    return chart_grid_svg(grid);
}

std::string psf_svg(const PlotHeading& heading, const std::vector<PsfMap>& fields) {
    ChartGrid grid{.title = plot_title(heading, "point spread function"),
                   .caption = heading.conditions,
                   .columns = 2,
                   .frame = {kMapSide, kMapSide}};
    grid.shares_x = have_one_size(fields, &PsfMap::intensity);
    grid.shares_y = grid.shares_x;
    for (const PsfMap& field : fields) {
        grid.panels.push_back(psf_chart(field, false));
        grid.panels.push_back(psf_chart(field, true));
    }
    return chart_grid_svg(grid);
}

std::string mtf_svg(const PlotHeading& heading, const std::vector<FieldMtf>& fields,
                    const std::vector<Vec2d>& diffraction_limit) {
    PlotChart chart{.title = plot_title(heading, "modulation transfer"),
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
        add_pair(chart, field_text(fields[i].field_deg) + (is_dark ? " (no light)" : ""),
                 ordered_colour(i, fields.size()), fields[i].tangential, fields[i].sagittal);
    }
    return chart_svg(chart, {760.0, 480.0});
}

std::string mtf_field_svg(const PlotHeading& heading, const std::vector<FrequencyMtf>& frequencies) {
    PlotChart chart{.title = plot_title(heading, "modulation against field"),
                    .caption = heading.conditions,
                    .x = {.label = "Field angle", .unit = "°", .least_span = 1.0, .holds_zero = true},
                    .y = modulation_axis(),
                    .empty_message = kNoLight};
    chart.curves = {legend_only("tangential", CurveLine::solid), legend_only("sagittal", CurveLine::dashed)};
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
        const FrequencyMtf& frequency = frequencies[i];
        add_pair(chart, short_number(frequency.cycles_per_mm) + " cycles/mm", ordered_colour(i, frequencies.size()),
                 in_order(frequency.tangential), in_order(frequency.sagittal));
    }
    return chart_svg(chart, {680.0, 440.0});
}

}  // namespace lensproof
