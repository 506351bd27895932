#include "experiments/draw/coating_plots.h"

#include <algorithm>

#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"
#include "experiments/draw/plot_words.h"

namespace lensproof::draw {

std::string reflectance_spectrum_svg(const PlotHeading& heading, const analysis::CoatingCurves& curves,
                                     const analysis::CoatingCurves& bare) {
    PlotChart chart{
        .title = plot_title(heading, "reflectance"),
        .caption = heading.conditions + ", unpolarised",
        .x = {.label = "Wavelength", .unit = "nm", .low = analysis::kShortestNm, .high = analysis::kLongestNm},
        .y = {.label = "Reflectance", .unit = "%", .low = 0.0}};
    for (std::size_t i = 0; i < curves.spectra.size(); ++i) {
        chart.curves.push_back({.label = field_text(curves.spectra[i].angle_deg),
                                .points = curves.spectra[i].points,
                                .colour = ordered_colour(i, curves.spectra.size())});
    }
    chart.curves.push_back({.label = "bare, " + field_text(bare.spectra.front().angle_deg),
                            .points = bare.spectra.front().points,
                            .colour = kQuiet,
                            .line = CurveLine::dotted});
    return chart_svg(chart);
}

std::string reflectance_by_angle_svg(const PlotHeading& heading, const analysis::CoatingCurves& curves) {
    constexpr double kLeastPercent = 0.01;
    PlotChart chart{
        .title = plot_title(heading, "reflectance by angle"),
        .caption = heading.conditions,
        .x = {.label = "Angle of incidence", .unit = "°", .low = 0.0, .high = 90.0},
        .y = {
            .label = "Reflectance", .unit = "%", .scale = AxisScale::logarithmic, .low = kLeastPercent, .high = 100.0}};
    chart.curves = {legend_only("unpolarised", CurveLine::solid), legend_only("s", CurveLine::dashed),
                    legend_only("p", CurveLine::dotted)};
    for (const analysis::ReflectanceByAngle& of : curves.angles) {
        const std::string colour = wavelength_colour(of.wavelength_nm);
        chart.curves.push_back(
            {.label = wavelength_text(of.wavelength_nm), .points = of.unpolarised, .colour = colour});
        chart.curves.push_back({.points = of.s, .colour = colour, .line = CurveLine::dashed, .width = 1.0});
        chart.curves.push_back({.points = of.p, .colour = colour, .line = CurveLine::dotted, .width = 1.2});
    }
    return chart_svg(chart);
}

}  // namespace lensproof::draw
