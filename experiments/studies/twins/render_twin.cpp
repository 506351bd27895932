#include "experiments/studies/twins/render_twin.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/detection/refine.h"
#include "calibration/detection/working_copy.h"
#include "calibration/picture/picture_traits.h"
#include "engine/render/film/film_image.h"
#include "engine/render/integrators/chart_tracer.h"
#include "engine/render/integrators/integrators.h"
#include "engine/render/progressive.h"
#include "experiments/draw/coloured_image.h"
#include "experiments/draw/point_crop.h"
#include "experiments/findings/shown_picture.h"

namespace lensproof::studies {

namespace {

constexpr double kLuminance_cd_m2 = 1000.0;
constexpr double kTwinWhite = 0.7;  // about what the twin's white is to be, full scale 1
constexpr double kIso = 100.0;

formats::Image rendered(const TwinSettings& settings, const FittedTwin& fitted, const PhotoSet& photos,
                        const render::Camera& camera, std::size_t view, const findings::RunSettings& run,
                        const std::function<void(double)>& progress) {
    const render::World world = render::EvenChart{.chart = photos.chart,
                                                  .pose = fitted.camera.charts[view],
                                                  .white_radiance = render::white_radiance(camera, kLuminance_cd_m2)};
    const render::View seen{.world = &world, .camera = &camera, .seed = run.seed + view};
    return render::film_image(render::render_film(
        render::integrator_named("chart").render(seen),
        {.first = 0, .end = static_cast<std::uint32_t>(settings.samples_per_pixel)}, run.threads, progress));
}

/// A view's points, by the chart's features.
struct ChartIndex {
    std::vector<Vec2d> features;

    /// −1: none of them.
    [[nodiscard]] int of(const Vec2d& chart_mm) const {
        constexpr double kSame_mm = 1e-6;
        const auto found =
            std::ranges::find_if(features, [&](const Vec2d& feature) { return length(feature - chart_mm) < kSame_mm; });
        return found == features.end() ? -1 : static_cast<int>(found - features.begin());
    }
};

std::vector<calibration::TwinPoint> points_in_both(const FittedTwin& fitted, const calibration::ProfileView& seen,
                                                   const formats::Image& twin, int channel, const scene::Chart& chart,
                                                   std::size_t view) {
    const ChartIndex index{scene::feature_points(chart)};
    const std::vector<calibration::SeenPoint>& points = fitted.seen.views[view].points;
    std::vector<Vec2d> chart_mm;
    const std::vector<Vec2d>& predicted = fitted.predicted[view];
    calibration::ChartPoints start{.image_px = std::vector<Vec2d>(index.features.size()),
                                   .found = std::vector<bool>(index.features.size(), false)};
    for (std::size_t i = 0; i < points.size(); ++i) {
        chart_mm.push_back({points[i].board_mm.x, points[i].board_mm.y});
        const int feature = index.of(chart_mm.back());
        if (feature >= 0) {
            start.image_px[static_cast<std::size_t>(feature)] = predicted[i];
            start.found[static_cast<std::size_t>(feature)] = true;
        }
    }
    const calibration::ChartPoints refined = calibration::refine(twin, channel, start, chart);
    std::vector<calibration::TwinPoint> both;
    for (const calibration::ProfilePoint& point : seen.points) {
        const int feature = index.of(point.chart_mm);
        const auto f = static_cast<std::size_t>(std::max(0, feature));
        if (!point.used || feature < 0 || !start.found[f] || !refined.found[f]) {
            continue;
        }
        std::optional<Vec2d> error;
        if (const auto& in_twin = refined.standard_error_px[f]; in_twin && point.standard_error_px) {
            error = {std::hypot(point.standard_error_px->x, in_twin->x),
                     std::hypot(point.standard_error_px->y, in_twin->y)};
        }
        const auto [by_x, by_y] = calibration::steps_on_chart(chart_mm, predicted, point.chart_mm);
        both.push_back({.view = static_cast<int>(view),
                        .feature = feature,
                        .photo_px = point.image_px,
                        .twin_px = refined.image_px[f],
                        .standard_error_px = error,
                        .by_chart_x_px = by_x,
                        .by_chart_y_px = by_y});
    }
    return both;
}

/// As a person looks at them: white at 0.8 of full scale.
formats::Image as_seen(const formats::Image& picture, double white) {
    formats::Image seen = formats::make_image(picture.width, picture.height, {"R", "G", "B"});
    const double exposure = white > 0.0 ? 0.8 / white : 1.0;
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                seen.at(x, y, c) = static_cast<float>(
                    exposure * static_cast<double>(picture.at(x, y, picture.channel_count() < 3 ? 0 : c)));
            }
        }
    }
    return seen;
}

std::vector<FarPoint> far_points_of(const Twin& twin, const std::string& photo, const formats::Image& image,
                                    const formats::Image& lit, int channel) {
    std::vector<calibration::TwinPoint> points = twin.points;
    const auto off_px = [](const calibration::TwinPoint& point) { return length(point.photo_px - point.twin_px); };
    std::ranges::sort(points, std::ranges::greater{}, off_px);
    points.resize(std::min(points.size(), kWorstPoints));
    std::vector<FarPoint> far;
    far.reserve(points.size());
    for (const calibration::TwinPoint& point : points) {
        far.push_back(
            {.off_px = off_px(point),
             .caption = fmt::format("{} at ({:.1f}, {:.1f}) px: photo and twin {:.3f} px apart",
                                    std::filesystem::path(photo).filename().string(), point.photo_px.x,
                                    point.photo_px.y, off_px(point)),
             .svg = draw::point_crops_svg({draw::PointCrop("photo", image, channel, point.photo_px),
                                           draw::PointCrop("twin", lit, channel, point.photo_px)},
                                          {{.at_px = point.twin_px, .label = "in the twin", .is_expected = true},
                                           {.at_px = point.photo_px, .label = "in the photo"}})});
    }
    return far;
}

/// Of a pixel of the twin, as it is measured in photos.
double twin_noise(const formats::Image& twin, int channel, const std::vector<calibration::TwinPoint>& points) {
    calibration::ChartPoints seen;
    for (const calibration::TwinPoint& point : points) {
        seen.image_px.push_back(point.twin_px);
        seen.found.push_back(true);
    }
    const auto traits = calibration::picture_traits(twin, channel, seen);
    return traits ? traits->noise : 0.0;
}

}  // namespace

void fields(JsonArchive& json, Twin& twin) {
    json.field("width", twin.width)
        .field("height", twin.height)
        .field("points", twin.points)
        .field("pixels", twin.pixels)
        .packed("photo", twin.photo)
        .packed("render", twin.render)
        .packed("difference", twin.difference)
        .field("far_points", twin.far_points);
}

render::CameraSettings camera_settings(const TwinSettings& settings, const FittedTwin& fitted) {
    render::CameraSettings camera;
    camera.lens = settings.lens;
    camera.f_number = fitted.f_number;
    camera.sensor = {.width = fitted.seen.camera.width_px,
                     .height = fitted.seen.camera.height_px,
                     .pixel_pitch_mm = fitted.camera.pixel_pitch_mm,
                     .axis_from_middle_px = fitted.camera.axis_from_middle_px};
    // The illuminance of a white far off, π L / 4 N², for as long as makes it so bright.
    const double illuminance = std::numbers::pi * kLuminance_cd_m2 / (4.0 * fitted.f_number * fitted.f_number);
    camera.exposure = {.time_s = kTwinWhite * spectral::saturation_exposure_lx_s(kIso) / illuminance, .iso = kIso};
    camera.response = settings.response;
    return camera;
}

Twin render_twin(const TwinSettings& settings, const FittedTwin& fitted, const calibration::Profile& profile,
                 const PhotoSet& photos, const calibration::Picture& photo, const render::Camera& camera,
                 std::size_t view, const findings::RunSettings& run, const std::function<void(double)>& progress) {
    const formats::Image image = photo.load();
    const formats::Image twin = rendered(settings, fitted, photos, camera, view, run, progress);
    const auto seen = std::ranges::find(profile.views, fitted.seen.views[view].image, &calibration::ProfileView::image);
    const int channel = calibration::reference_channel(image);
    const std::string& name = image.channels[static_cast<std::size_t>(channel)];
    const int twin_channel = formats::find_channel(twin, formats::find_channel(twin, name) < 0 ? "G" : name);
    Twin found{.width = image.width,
               .height = image.height,
               .points = points_in_both(fitted, *seen, twin, twin_channel, photos.chart, view),
               .pixels = {}};
    constexpr std::size_t kLeastPoints = 4;
    if (found.points.size() < kLeastPoints || !seen->traits) {
        found.points.clear();
        return found;
    }
    const double contrast = seen->traits->white - seen->traits->black;
    found.pixels = calibration::account_of_pixels({.photo = image,
                                                   .twin = twin,
                                                   .photo_channel = channel,
                                                   .twin_channel = twin_channel,
                                                   .contrast = contrast,
                                                   .photo_noise = seen->traits->noise,
                                                   .twin_noise = twin_noise(twin, twin_channel, found.points)},
                                                  found.points);
    const formats::Image lit = calibration::in_light_of(twin, image, found.points);
    found.photo = findings::laid_picture(as_seen(image, seen->traits->white));
    found.render = findings::laid_picture(as_seen(lit, seen->traits->white));
    found.far_points = far_points_of(found, photo.name, image, lit, channel);
    const formats::Image difference = calibration::difference_among(
        {.photo = image, .twin = lit, .photo_channel = channel, .twin_channel = channel, .contrast = contrast},
        found.points);
    found.difference = findings::laid_picture(
        draw::coloured_image(difference, draw::ColourMap::diverging, -kShownDifference, kShownDifference));
    return found;
}

}  // namespace lensproof::studies
