#include "engine/render/integrators/chart_tracer.h"

#include <algorithm>
#include <iterator>

#include "engine/spectral/illuminant.h"

namespace lensproof::render {

namespace {

PixelFeatures features_of(const EvenChart& chart, const ChartMeeting& at) {
    return {.depth_mm = map_point(chart.pose, {at.x_mm, at.y_mm, 0.0}).z,
            .albedo_rgb = {at.reflectance, at.reflectance, at.reflectance},
            .normal = chart.pose.linear * Vec3d{0.0, 0.0, at.is_before ? 1.0 : -1.0}};
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

void ChartTracer::operator()(const TileSamples& samples, FilmTile& tile) {
    const EvenChart& chart = view_.chart();
    paths_.for_each(samples, tile, [&](const CameraPathBuffer& paths, std::size_t path, std::size_t pixel) {
        const std::size_t stratum = paths.wavelength[path];
        const ChartMeeting at = meet_chart(chart, paths.ray(path));
        const double radiance = at.reflectance * chart.white_radiance[stratum];
        tile.add(pixel, paths.sample[path], stratum, radiance * paths.weight[path]);
        if (view_.has_features && at.exists) {
            tile.add_features(pixel, features_of(chart, at));
        }
    });
}

}  // namespace lensproof::render
