#include "experiments/studies/cameras/residual_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/detection/working_copy.h"
#include "calibration/geometry/projection_uncertainty.h"
#include "experiments/draw/point_crop.h"

namespace lensproof::studies {

namespace {

findings::Map residual_map(const findings::Subject& subject, const std::vector<calibration::PlacedResidual>& residuals,
                           const ResidualFrame& frame, const std::string& what) {
    constexpr int kColumns = 17;
    const int rows = std::max(3, static_cast<int>(std::lround(kColumns * frame.height_px / frame.width_px)));
    draw::FrameMap map{.title = fmt::format("{}, {}", subject.id, subject.label),
                       .heading = "How far the points are off",
                       .label = "residual of a coordinate, rms",
                       .unit = "px",
                       .width_px = frame.width_px,
                       .height_px = frame.height_px,
                       .columns = kColumns,
                       .rows = rows,
                       .values = calibration::local_rms_px(residuals, frame.width_px, frame.height_px, kColumns, rows)};
    double least = INFINITY;
    double most = 0.0;
    for (const double value : map.values) {
        map.covered.push_back(!std::isnan(value));
        least = std::isnan(value) ? least : std::min(least, value);
        most = std::isnan(value) ? most : std::max(most, value);
    }
    for (const calibration::PlacedResidual& residual : residuals) {
        map.points.push_back(residual.at_px);
    }
    map.hull = calibration::convex_hull(map.points);
    return {.name = subject.id + "/residuals.svg",
            .subject = subject.id,
            .caption = fmt::format("{}, rms of a coordinate about each place: {:.2g} to {:.2g} px.", what, least, most),
            .frame = std::move(map)};
}

}  // namespace

void add_residuals(findings::Findings& found, findings::Subject& subject,
                   const std::vector<calibration::PlacedResidual>& residuals, const ResidualFrame& frame,
                   const std::string& what) {
    const bool has_any =
        std::ranges::any_of(residuals, [](const auto& residual) { return dot(residual.by_px, residual.by_px) > 0.0; });
    if (residuals.size() < calibration::kLeastResiduals || !has_any) {
        return;
    }
    const double half_diagonal = 0.5 * std::hypot(frame.width_px, frame.height_px);
    const calibration::ResidualCurves curves = calibration::residual_curves(residuals, frame.centre_px, half_diagonal);
    subject.points = {.centre_px = frame.centre_px, .half_diagonal_px = half_diagonal, .rms_px = curves.rms_px};
    subject.facts.push_back(
        {"residuals beyond three times their rms",
         fmt::format("{:.2g} % of the coordinates (of a Gaussian 0.27 %)", 100.0 * curves.beyond_3)});
    const auto series = [&](const std::string& suffix, const char* style, const calibration::Curve& curve) {
        return findings::Series{.label = subject.id + suffix, .subject = subject.id, .style = style, .curve = curve};
    };
    found.plots.push_back({.id = "residual-distribution",
                           .title = "Residuals: how they are spread",
                           .subtitle = "both coordinates, over their rms; dashed: a Gaussian",
                           .y_label = "density",
                           .y_unit = "",
                           .series = {series("", "measured", curves.density),
                                      series(", Gaussian", "reference", calibration::gaussian_density(curves.density))},
                           .over = findings::PlotOver::residual});
    const auto add_means = [&](const std::string& id, const std::string& title, const std::string& subtitle,
                               const calibration::Curve& radial, const calibration::Curve& tangential,
                               findings::PlotOver over) {
        found.plots.push_back(
            {.id = id,
             .title = title,
             .subtitle = subtitle,
             .y_label = "mean residual",
             .y_unit = "px",
             .series = {series(", radial", "measured", radial), series(", tangential", "measured", tangential)},
             .over = over});
    };
    add_means("residual-radius", "Residuals along the radius", "means over the points of a bin, with their 95 % bounds",
              curves.radial, curves.tangential, findings::PlotOver::image_height);
    add_means("residual-azimuth", "Residuals around the centre",
              "means; one wave around: decentred; two: tilted, or pixels not square", curves.radial_azimuth,
              curves.tangential_azimuth, findings::PlotOver::azimuth);
    findings::Map map = residual_map(subject, residuals, frame, what);
    if (std::ranges::find(map.frame.covered, true) != map.frame.covered.end()) {
        found.maps.push_back(std::move(map));
    }
}

void fields(JsonArchive& json, FarPoint& point) {
    json.field("off_px", point.off_px).field("caption", point.caption).field("svg", point.svg);
}

std::vector<FarPoint> far_points(const calibration::Profile& profile,
                                 const std::vector<calibration::Picture>& pictures) {
    struct Found {
        double off_px;
        std::string picture;
        calibration::ProfilePoint point;
    };
    std::vector<Found> worst;
    for (const calibration::ProfileView& view : profile.views) {
        for (const calibration::ProfilePoint& point : view.points) {
            worst.push_back({length(point.residual_px), view.image, point});
        }
    }
    std::ranges::sort(worst, std::ranges::greater{}, &Found::off_px);
    worst.resize(std::min(worst.size(), kWorstPoints));
    std::ranges::stable_sort(worst, {}, &Found::picture);  // each picture is read once
    std::vector<FarPoint> points;
    std::string loaded;
    formats::Image image;
    for (const auto& [off_px, name, point] : worst) {
        const auto picture = std::ranges::find(pictures, name, &calibration::Picture::name);
        if (picture == pictures.end()) {
            continue;
        }
        if (loaded != name) {
            image = picture->load();
            loaded = name;
        }
        const std::string file = std::filesystem::path(name).filename().string();
        points.push_back({.off_px = off_px,
                          .caption = fmt::format("{} at ({:.1f}, {:.1f}) px: {:.3f} px off{}", file, point.image_px.x,
                                                 point.image_px.y, off_px, point.used ? "" : ", left out by the fit"),
                          .svg = draw::point_crops_svg(
                              {draw::PointCrop(file, image, calibration::reference_channel(image), point.image_px)},
                              {{.at_px = point.image_px - point.residual_px, .label = "the model", .is_expected = true},
                               {.at_px = point.image_px, .label = "measured"}})});
    }
    return points;
}

void keep_worst(std::vector<FarPoint>& points) {
    std::ranges::sort(points, std::ranges::greater{}, &FarPoint::off_px);
    points.resize(std::min(points.size(), kWorstPoints));
}

void add_worst(findings::Subject& subject, std::vector<FarPoint> points) {
    keep_worst(points);
    for (FarPoint& point : points) {
        subject.worst.push_back({.name = fmt::format("{}/worst-{:02}.svg", subject.id, subject.worst.size() + 1),
                                 .caption = std::move(point.caption),
                                 .bytes = std::move(point.svg)});
    }
}

}  // namespace lensproof::studies
