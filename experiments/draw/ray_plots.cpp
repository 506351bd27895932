// Plots of rays: fans, field curves, longitudinal aberration, lateral colour, light against the field.
#include <algorithm>
#include <cmath>

#include "experiments/draw/analysis_plots.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/chart_axes.h"
#include "experiments/draw/palette.h"
#include "experiments/draw/plot_words.h"

namespace lensproof::draw {

namespace {

// Less than these is rounding, or of no use to know: such curves are shown as the straight lines that they are.
constexpr double kLeastErrorSpan = 0.2;        // µm, of a ray fan
constexpr double kLeastFocusSpan = 2e-3;       // mm
constexpr double kLeastDistortionSpan = 0.02;  // percent
constexpr double kLeastColourSpan = 0.2;       // µm
constexpr double kLeastFieldSpan = 1.0;        // degrees

/// The axis of fields that begins on the optical axis.
ChartAxis field_axis() {
    return {.label = "Field angle", .unit = "°", .least_span = kLeastFieldSpan, .holds_zero = true};
}

/// Curves of one field are as far apart as its wavelengths; one that has a single field is a mark.
void mark_single_points(PlotChart& chart) {
    for (ChartCurve& curve : chart.curves) {
        if (curve.points.size() == 1) {
            curve.marker = curve.line == CurveLine::dashed ? CurveMarker::ring : CurveMarker::dot;
        }
    }
}

std::vector<Vec2d> turned(std::vector<Vec2d> points) {
    for (Vec2d& point : points) {
        std::swap(point.x, point.y);
    }
    return points;
}

/// The pupil from −1 to 1, and farther where a beam is.
void hold_pupil(ChartAxis& axis, const std::vector<analysis::FieldFans>& fields) {
    double reach = 1.0;
    for (const analysis::FieldFans& field : fields) {
        for (const auto* curves : {&field.tangential, &field.sagittal}) {
            for (const analysis::WavelengthCurve& curve : *curves) {
                for (const Vec2d point : curve.points) {
                    reach = std::isfinite(point.x) ? std::max(reach, std::abs(point.x)) : reach;
                }
            }
        }
    }
    axis.low = -reach;
    axis.high = reach;
}

PlotChart fan_chart(const std::vector<analysis::WavelengthCurve>& curves, const std::string& pupil,
                    const ChartAxis& pupil_axis) {
    PlotChart chart{.x = pupil_axis,
                    .y = {.label = "Ray error", .unit = "µm", .least_span = kLeastErrorSpan, .is_symmetric = true},
                    .references = {zero_line(ReferenceDirection::horizontal), zero_line(ReferenceDirection::vertical)},
                    .empty_message = kNoLight};
    chart.x.label = pupil;
    std::ranges::transform(curves, std::back_inserter(chart.curves), wavelength_curve);
    return chart;
}

struct FieldCurvePanels {
    PlotChart astigmatism;
    PlotChart distortion;
};

FieldCurvePanels empty_field_curves(const std::string& projection) {
    FieldCurvePanels panels;
    panels.astigmatism = {
        .title = "Astigmatism",
        .x = {.label = "Focus from the image plane", .unit = "mm", .least_span = kLeastFocusSpan, .is_symmetric = true},
        .y = field_axis(),
        .references = {zero_line(ReferenceDirection::vertical)},
        .curves = {legend_only("tangential", CurveLine::solid), legend_only("sagittal", CurveLine::dashed)},
        .empty_message = kNoLight};
    panels.distortion = {.title = "Distortion",
                         .x = {.label = projection.empty() ? "Distortion" : "Distortion from " + projection,
                               .unit = "%",
                               .least_span = kLeastDistortionSpan,
                               .is_symmetric = true},
                         .y = field_axis(),
                         .references = {zero_line(ReferenceDirection::vertical)},
                         .empty_message = kNoLight};
    return panels;
}

}  // namespace

std::string ray_fans_svg(const PlotHeading& heading, const std::vector<analysis::FieldFans>& fields) {
    ChartGrid grid{.title = plot_title(heading, "ray fans"),
                   .caption = heading.conditions,
                   .columns = 2,
                   .frame = {300.0, fields.size() > 6 ? 96.0 : 130.0}};
    ChartAxis pupil;
    hold_pupil(pupil, fields);
    for (const analysis::FieldFans& field : fields) {
        grid.panels.push_back(fan_chart(field.tangential, "Normalised pupil, y", pupil));
        grid.panels.push_back(fan_chart(field.sagittal, "Normalised pupil, x", pupil));
        grid.row_labels.push_back(field_text(field.field_deg));
    }
    if (!fields.empty()) {
        grid.panels[0].title = "Tangential";
        grid.panels[1].title = "Sagittal";
    }
    return chart_grid_svg(grid);
}

std::string field_curves_svg(const PlotHeading& heading, const std::vector<analysis::FieldCurve>& curves,
                             const std::string& projection) {
    FieldCurvePanels panels = empty_field_curves(projection);
    for (const analysis::FieldCurve& curve : curves) {
        std::vector<analysis::FieldCurve::Point> points = curve.points;
        std::ranges::stable_sort(points, {}, &analysis::FieldCurve::Point::field_deg);
        analysis::WavelengthCurve tangential{.wavelength_nm = curve.wavelength_nm};
        analysis::WavelengthCurve sagittal = tangential;
        analysis::WavelengthCurve distortion = tangential;
        for (const analysis::FieldCurve::Point& point : points) {
            tangential.points.push_back({point.tangential_mm, point.field_deg});
            sagittal.points.push_back({point.sagittal_mm, point.field_deg});
            distortion.points.push_back({point.distortion_percent, point.field_deg});
        }
        panels.astigmatism.curves.push_back(wavelength_curve(tangential));
        ChartCurve dashed = wavelength_curve(sagittal);
        dashed.line = CurveLine::dashed;
        dashed.label.clear();
        panels.astigmatism.curves.push_back(std::move(dashed));
        panels.distortion.curves.push_back(wavelength_curve(distortion));
    }
    mark_single_points(panels.astigmatism);
    mark_single_points(panels.distortion);
    return chart_grid_svg({.title = plot_title(heading, "field curves"),
                           .caption = heading.conditions,
                           .panels = {std::move(panels.astigmatism), std::move(panels.distortion)},
                           .columns = 2,
                           .has_common_x = false,
                           .frame = {300.0, 360.0}});
}

std::string longitudinal_aberration_svg(const PlotHeading& heading,
                                        const std::vector<analysis::WavelengthCurve>& zones) {
    PlotChart chart{.title = plot_title(heading, "longitudinal aberration"),
                    .caption = heading.conditions,
                    .x = {.label = "Axis crossing from the image plane",
                          .unit = "mm",
                          .least_span = kLeastFocusSpan,
                          .is_symmetric = true},
                    .y = {.label = "Pupil zone", .low = 0.0, .high = 1.0},
                    .references = {zero_line(ReferenceDirection::vertical)},
                    .empty_message = kNoLight};
    for (const analysis::WavelengthCurve& zone : zones) {
        ChartCurve curve = wavelength_curve(zone);
        curve.points = turned(in_order(std::move(curve.points)));
        chart.curves.push_back(std::move(curve));
    }
    return chart_svg(chart, {600.0, 540.0});
}

std::string lateral_colour_svg(const PlotHeading& heading, const std::vector<analysis::WavelengthCurve>& curves,
                               const std::vector<Vec2d>& airy_radius) {
    PlotChart chart{.title = plot_title(heading, "lateral colour"),
                    .caption = heading.conditions,
                    .x = {.label = "Chief-ray height from the reference wavelength's",
                          .unit = "µm",
                          .least_span = kLeastColourSpan,
                          .is_symmetric = true},
                    .y = field_axis(),
                    .references = {zero_line(ReferenceDirection::vertical)},
                    .empty_message = kNoLight};
    ChartArea band{.label = "Airy radius"};
    const std::vector<Vec2d> edge = in_order(airy_radius);
    for (const Vec2d point : edge) {
        band.outline.push_back({point.y, point.x});
    }
    for (auto point = edge.rbegin(); point != edge.rend(); ++point) {
        band.outline.push_back({-point->y, point->x});
    }
    for (const analysis::WavelengthCurve& colour : curves) {
        ChartCurve curve = wavelength_curve(colour);
        curve.points = turned(in_order(std::move(curve.points)));
        chart.curves.push_back(std::move(curve));
    }
    if (edge.size() > 1 && !is_empty(chart)) {
        chart.areas.push_back(std::move(band));
    }
    mark_single_points(chart);
    return chart_svg(chart, {480.0, 540.0});
}

std::string illumination_svg(const PlotHeading& heading, const std::vector<analysis::FieldBrightness>& points) {
    PlotChart chart{.title = plot_title(heading, "relative illumination"),
                    .caption = heading.conditions,
                    .x = field_axis(),
                    .y = {.label = "Relative to the axis", .low = 0.0, .least_span = 1.0, .holds_zero = true},
                    .empty_message = kNoLight};
    ChartCurve illumination{.label = "relative illumination", .colour = series_colour(0), .width = 2.0};
    ChartCurve vignetting{
        .label = "beam's cross-section (vignetting)", .colour = series_colour(1), .line = CurveLine::dashed};
    for (const analysis::FieldBrightness& point : points) {
        illumination.points.push_back({point.field_deg, point.relative_illumination});
        vignetting.points.push_back({point.field_deg, point.vignetting});
    }
    illumination.points = in_order(std::move(illumination.points));
    vignetting.points = in_order(std::move(vignetting.points));
    chart.curves = {std::move(illumination), std::move(vignetting)};
    mark_single_points(chart);
    return chart_svg(chart, {640.0, 420.0});
}

}  // namespace lensproof::draw
