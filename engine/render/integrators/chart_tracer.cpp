#include "engine/render/integrators/chart_tracer.h"

#include <algorithm>
#include <iterator>

#include "engine/spectral/illuminant.h"

namespace lensproof::render {

namespace {

/// By itself, with columns that lie apart: so compilers vectorise it.
void meet_all(const AffineMap& pose, const CameraPathBuffer& paths, std::size_t size, double* __restrict x_mm,
              double* __restrict y_mm, double* __restrict distance_mm, double* __restrict before_mm) {
    for (std::size_t i = 0; i < size; ++i) {
        const ChartMeeting at = meet_chart(pose, paths.ray(i));
        x_mm[i] = at.x_mm;
        y_mm[i] = at.y_mm;
        distance_mm[i] = at.distance_mm;
        before_mm[i] = at.before_mm;
    }
}

PixelFeatures features_of(const EvenChart& chart, const ChartMeetings& meetings, std::size_t path) {
    const Vec2d at = meetings.point_mm(path);
    const double reflectance = meetings.reflectance(path);
    return {.depth_mm = map_point(chart.pose, {at.x, at.y, 0.0}).z,
            .albedo_rgb = {reflectance, reflectance, reflectance},
            .normal = chart.pose.linear * Vec3d{0.0, 0.0, meetings.is_before(path) ? 1.0 : -1.0}};
}

}  // namespace

std::vector<double> white_radiance(const Camera& camera, double luminance_cd_m2) {
    const spectral::Spectrum radiance =
        spectral::radiance_of(spectral::illuminant(camera.settings().white_balance), luminance_cd_m2);
    std::vector<double> at;
    std::ranges::transform(camera.grid().strata.midpoints(), std::back_inserter(at), radiance);
    return at;
}

EvenChart even_chart(const scene::Chart& chart, const scene::Placement& placement, double luminance_cd_m2,
                     const Camera& camera) {
    return {.chart = chart, .pose = scene::place(placement), .white_radiance = white_radiance(camera, luminance_cd_m2)};
}

void ChartMeetings::meet(const EvenChart& chart, const CameraPathBuffer& paths) {
    const auto size = static_cast<std::size_t>(paths.size);
    for (std::vector<double>* column : {&x_mm_, &y_mm_, &distance_mm_, &before_mm_, &reflectance_}) {
        column->resize(size);
    }
    meet_all(chart.pose, paths, size, x_mm_.data(), y_mm_.data(), distance_mm_.data(), before_mm_.data());
    for (std::size_t i = 0; i < size; ++i) {
        if (!exists(i)) {  // a kind of chart may ask for finite numbers
            x_mm_[i] = 0.0;
            y_mm_[i] = 0.0;
        }
    }
    scene::reflectances(chart.chart, x_mm_, y_mm_, reflectance_);
    for (std::size_t i = 0; i < size; ++i) {
        if (!exists(i)) {
            reflectance_[i] = chart.chart.white_reflectance;
        }
    }
}

void ChartTracer::operator()(const TileSamples& samples, FilmTile& tile) {
    const EvenChart& chart = view_.chart();
    const auto meet = [&](const CameraPathBuffer& paths) { meetings_.meet(chart, paths); };
    paths_.for_each(samples, tile, meet, [&](const CameraPathBuffer& paths, std::size_t path, std::size_t pixel) {
        const std::size_t stratum = paths.wavelength[path];
        const double radiance = meetings_.reflectance(path) * chart.white_radiance[stratum];
        tile.add(pixel, paths.sample[path], stratum, radiance * paths.weight[path]);
        if (view_.has_features && meetings_.exists(path)) {
            tile.add_features(pixel, features_of(chart, meetings_, path));
        }
    });
}

}  // namespace lensproof::render
