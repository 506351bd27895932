#include "engine/render/chart_render.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include "engine/render/camera_paths.h"
#include "engine/render/film_image.h"
#include "engine/render/tile_paths.h"

namespace lensproof::render {

namespace {

/// Where a ray that left the lens meets the chart's plane.
struct SeenPoint {
    double x_mm = 0.0;  // on the chart
    double y_mm = 0.0;
    Vec3d origin;  // of the ray, in the chart's frame
    bool exists = false;
};

SeenPoint seen_point(const scene::RigidMotion& pose, const Ray<double>& outwards) {
    const Vec3d origin = scene::rotate_back(pose, scene::camera_to_lens(outwards.origin) - pose.translation);
    const Vec3d direction = scene::rotate_back(pose, scene::camera_to_lens(outwards.direction));
    const double distance = -origin.z / direction.z;
    return {.x_mm = origin.x + distance * direction.x,
            .y_mm = origin.y + distance * direction.y,
            .origin = origin,
            .exists = distance > 0.0 && std::isfinite(distance)};
}

double reflectance_at(const scene::Chart& chart, const SeenPoint& point) {
    return point.exists ? scene::reflectance(chart, point.x_mm, point.y_mm) : chart.white_reflectance;
}

/// The chart's normal is the one towards the ray.
PixelFeatures features_of(const SeenChart& view, const SeenPoint& point, double reflectance) {
    const Vec3d at = scene::rotate(view.pose, {point.x_mm, point.y_mm, 0.0}) + view.pose.translation;
    return {.depth_mm = at.z,
            .albedo_rgb = {reflectance, reflectance, reflectance},
            .normal = scene::rotate(view.pose, {0.0, 0.0, point.origin.z > 0.0 ? 1.0 : -1.0})};
}

/// Renders a tile row by row, each from its camera paths, a buffer after the other.
class ChartTileRenderer {
  public:
    ChartTileRenderer(const SeenChart& view, const CameraPathSource<double>& source)
        : view_(&view), producer_(source) {}

    void operator()(const TileSamples& samples, FilmTile& tile) {
        for_each_path(
            samples, view_->sensor.width, producer_, paths_, tile, [] {},
            [&](int path, std::size_t pixel) { add_path(path, pixel, tile); });
    }

  private:
    void add_path(int path, std::size_t pixel, FilmTile& tile) {
        const auto at = static_cast<std::size_t>(path);
        const std::size_t stratum = paths_.wavelength[at];
        const SeenPoint point = seen_point(view_->pose, paths_.ray(path));
        const double reflectance = reflectance_at(view_->chart, point);
        const double radiance = reflectance * view_->strata[stratum].white_radiance;
        tile.add(pixel, paths_.sample[at], stratum, radiance * paths_.weight[at]);
        if (view_->has_features && point.exists) {
            tile.add_features(pixel, features_of(*view_, point, reflectance));
        }
    }

    const SeenChart* view_;
    CameraPathProducer<double> producer_;
    CameraPathBuffer<double> paths_;
};

optics::SpectralLens<double> spectral_lens(const std::vector<WavelengthStratum>& strata) {
    std::vector<optics::TraceLens<double>> at;
    std::ranges::transform(strata, std::back_inserter(at), &WavelengthStratum::lens);
    return optics::SpectralLens<double>(std::move(at));
}

}  // namespace

double seen_reflectance(const scene::Chart& chart, const scene::RigidMotion& pose, const Ray<double>& outwards) {
    return reflectance_at(chart, seen_point(pose, outwards));
}

ChartRender::ChartRender(SeenChart view, const pupil::PupilMap& pupil, std::uint64_t seed)
    : view_(std::move(view)), lens_(spectral_lens(view_.strata)), pupil_(pupil, lens_.wavelengths()), seed_(seed) {}

FilmLayout ChartRender::film() const {
    FilmLayout layout{.width = view_.sensor.width,
                      .height = view_.sensor.height,
                      .layer_nm = view_.layer_nm,
                      .rgb_weights = {},
                      .band_nm = view_.stratum_width_nm * static_cast<double>(view_.strata.size()),
                      .filter = view_.filter,
                      .has_features = view_.has_features};
    std::ranges::transform(view_.strata, std::back_inserter(layout.rgb_weights), &WavelengthStratum::rgb_weights);
    return layout;
}

TileRenderer ChartRender::make_renderer() const {
    const CameraPathSource<double> source{
        .sensor = view_.sensor, .lens = &lens_, .pupil = &pupil_, .seed = seed_, .filter = view_.filter};
    // On the heap, since std::function wants to be able to copy what it holds.
    return [renderer = std::make_shared<ChartTileRenderer>(view_, source)](const TileSamples& samples, FilmTile& tile) {
        (*renderer)(samples, tile);
    };
}

formats::Image render_chart(const SeenChart& view, const pupil::PupilMap& pupil, const RenderSettings& settings,
                            const std::function<void(double)>& progress) {
    const ChartRender render(view, pupil, settings.seed);
    RenderState state(render.film(), {.first = 0, .end = static_cast<std::uint32_t>(settings.samples_per_pixel)});
    render_progressively(state, [&] { return render.make_renderer(); }, {},
                         {.threads = settings.threads,
                          .in_passes = false,
                          .is_interrupted = {},
                          .on_progress = [&](const RenderState&, const RenderReport& report) {
                              if (progress) {
                                  progress(report.done);
                              }
                          }});
    return film_image(state.film);
}

}  // namespace lensproof::render
