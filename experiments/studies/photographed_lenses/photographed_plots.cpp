#include "experiments/studies/photographed_lenses/photographed_plots.h"

#include <fmt/format.h>

#include <algorithm>

#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"

namespace lensproof::studies {

namespace {

/// (value, fraction of the values that are not larger), as steps.
std::vector<Vec2d> cumulative(std::vector<double> values) {
    std::ranges::sort(values);
    std::vector<Vec2d> steps;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto n = static_cast<double>(values.size());
        steps.push_back({values[i], static_cast<double>(i) / n});
        steps.push_back({values[i], static_cast<double>(i + 1) / n});
    }
    return steps;
}

std::vector<Vec2d> points_of(const std::vector<calibration::CurvePoint>& curve) {
    std::vector<Vec2d> points;
    std::ranges::transform(curve, std::back_inserter(points), [](const calibration::CurvePoint& point) {
        return Vec2d{point[0], point[1]};
    });
    return points;
}

draw::ChartAxis height_axis() {
    return {.label = "Image height, of the half-diagonal", .low = 0.0, .high = 1.0};
}

}  // namespace

std::string population_chart(const std::vector<PairResult>& results) {
    std::vector<double> right;
    std::vector<double> wrong;
    for (const PairResult& result : results) {
        if (!result.residual_um() || result.comparison.photographed.projection != optics::Projection::rectilinear) {
            continue;
        }
        right.push_back(*result.residual_um());
        std::ranges::transform(result.wrong, std::back_inserter(wrong), &WrongLens::residual_um);
    }
    draw::PlotChart chart{.title = "Distortion of prescriptions against photographed lenses",
                          .caption = "One focal length fitted; fisheyes left out"};
    chart.x = {.label = "Residual, rms", .unit = "µm", .scale = draw::AxisScale::logarithmic};
    chart.y = {.label = "Share that is smaller", .low = 0.0, .high = 1.0};
    chart.curves.push_back(
        {.label = fmt::format("the product's prescription ({})", right.size()), .points = cumulative(right)});
    chart.curves.push_back({.label = fmt::format("other lenses of like focal length and format ({})", wrong.size()),
                            .points = cumulative(wrong),
                            .colour = draw::series_colour(1),
                            .line = draw::CurveLine::dashed});
    return draw::chart_svg(chart, {.width = kPhotographedChartWidth, .height = kPhotographedChartHeight});
}

std::string pair_chart(const PairResult& result) {
    const MeasuredComparison& comparison = result.comparison;
    draw::PlotChart chart{
        .title = comparison.photographed.model,
        .caption = fmt::format("{}; {}", comparison.lens, optics::projection_name(comparison.photographed.projection))};
    chart.x = height_axis();
    chart.y = {.label = "Distortion", .unit = "%", .least_span = 0.2, .holds_zero = true};
    if (const auto& distortion = comparison.distortion) {
        chart.curves.push_back({.label = "photographed (lensfun), focal length fitted",
                                .points = points_of(distortion->photographed_percent),
                                .colour = draw::series_colour(1),
                                .line = draw::CurveLine::dashed,
                                .width = 2.2});
        chart.curves.push_back(
            {.label = "simulated (prescription)", .points = points_of(distortion->simulated_percent)});
    }
    return draw::chart_svg(chart, {.width = kPhotographedChartWidth, .height = kPhotographedChartHeight});
}

}  // namespace lensproof::studies
