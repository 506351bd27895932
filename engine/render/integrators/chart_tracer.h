// engine/render/integrators/chart_tracer.h — camera paths to a chart under even light.
#pragma once
#include <cmath>
#include <vector>

#include "engine/render/integrators/tile_paths.h"
#include "engine/render/integrators/view.h"

namespace lensproof::render {

/// Radiance of a perfect white diffuser in the light that the camera is balanced to, at each of its strata:
/// W·m⁻²·sr⁻¹·nm⁻¹.
std::vector<double> white_radiance(const Camera& camera, double luminance_cd_m2);

/// A chart before that camera, in that light.
EvenChart even_chart(const scene::Chart& chart, const scene::Placement& placement, double luminance_cd_m2,
                     const Camera& camera);

/// Where a ray that left the lens (lens space) meets the chart's plane. Inline, as every path asks.
struct ChartMeeting {
    double x_mm = 0.0;  // on the chart
    double y_mm = 0.0;
    bool is_before = false;  // the ray comes from where z > 0 in the chart's frame
    bool exists = false;
    double reflectance = 0.0;  // there, or of the world
};
inline ChartMeeting meet_chart(const EvenChart& chart, const Ray<double>& outwards) {
    const Vec3d origin = point_before(chart.pose, scene::camera_to_lens(outwards.origin));
    const Vec3d direction = transposed_times(chart.pose.linear, scene::camera_to_lens(outwards.direction));
    const double distance = -origin.z / direction.z;
    ChartMeeting meeting{.x_mm = origin.x + distance * direction.x,
                         .y_mm = origin.y + distance * direction.y,
                         .is_before = origin.z > 0.0,
                         .exists = distance > 0.0 && std::isfinite(distance)};
    meeting.reflectance =
        meeting.exists ? scene::reflectance(chart.chart, meeting.x_mm, meeting.y_mm) : chart.chart.white_reflectance;
    return meeting;
}

/// Renders a chart: each path ends where it arrives, and so carries its hero alone. A TileRenderer. Features: depth
/// along the camera's axis, reflectance as albedo, and the chart's normal towards the camera, in the camera's frame.
class ChartTracer {
  public:
    explicit ChartTracer(const View& view) : view_(view), paths_(*view.camera, view.seed, PathCarry::hero) {}

    void operator()(const TileSamples& samples, FilmTile& tile);

  private:
    View view_;
    TilePaths paths_;
};

}  // namespace lensproof::render
