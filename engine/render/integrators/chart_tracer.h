// engine/render/integrators/chart_tracer.h — camera paths to a chart under even light.
#pragma once
#include <vector>

#include "engine/base/infinity.h"
#include "engine/render/integrators/tile_paths.h"
#include "engine/render/integrators/view.h"

namespace lensproof::render {

/// Radiance of a perfect white diffuser in the light that the camera is balanced to, at each of its strata:
/// W·m⁻²·sr⁻¹·nm⁻¹.
std::vector<double> white_radiance(const Camera& camera, double luminance_cd_m2);

/// A chart before that camera, in that light.
EvenChart even_chart(const scene::Chart& chart, const scene::Placement& placement, double luminance_cd_m2,
                     const Camera& camera);

/// Where a ray that left the lens (lens space) meets the chart's plane.
struct ChartMeeting {
    double x_mm = 0.0;  // on the chart
    double y_mm = 0.0;
    double distance_mm = 0.0;  // along the ray; 0 or less, or not finite: it does not meet it
    double before_mm = 0.0;    // z, in the chart's frame, that it comes from
};
inline ChartMeeting meet_chart(const AffineMap& pose, const Ray<double>& outwards) {
    const Vec3d origin = point_before(pose, scene::camera_to_lens(outwards.origin));
    const Vec3d direction = transposed_times(pose.linear, scene::camera_to_lens(outwards.direction));
    const double distance = -origin.z / direction.z;
    return {.x_mm = origin.x + distance * direction.x,
            .y_mm = origin.y + distance * direction.y,
            .distance_mm = distance,
            .before_mm = origin.z};
}
inline bool is_met(double distance_mm) {
    return distance_mm > 0.0 && distance_mm < kInfinity;
}

/// Many of these, a column a quantity, and what is there.
class ChartMeetings {
  public:
    /// Of a buffer's paths, in place of what is here.
    void meet(const EvenChart& chart, const CameraPathBuffer& paths);

    /// Where it does not exist, the point is (0, 0) and the reflectance the world's.
    [[nodiscard]] bool exists(std::size_t path) const { return is_met(distance_mm_[path]); }
    [[nodiscard]] Vec2d point_mm(std::size_t path) const { return {x_mm_[path], y_mm_[path]}; }
    /// The ray comes from where z > 0 in the chart's frame.
    [[nodiscard]] bool is_before(std::size_t path) const { return before_mm_[path] > 0.0; }
    [[nodiscard]] double reflectance(std::size_t path) const { return reflectance_[path]; }

  private:
    std::vector<double> x_mm_;
    std::vector<double> y_mm_;
    std::vector<double> distance_mm_;
    std::vector<double> before_mm_;
    std::vector<double> reflectance_;
};

/// Renders a chart: each path ends where it arrives, and so carries its hero alone. A TileRenderer. Features: depth
/// along the camera's axis, reflectance as albedo, and the chart's normal towards the camera, in the camera's frame.
class ChartTracer {
  public:
    explicit ChartTracer(const View& view) : paths_(*view.camera, view.seed, PathCarry::hero), view_(view) {}

    void operator()(const TileSamples& samples, FilmTile& tile);

  private:
    TilePaths paths_;
    View view_;
    ChartMeetings meetings_;
};

}  // namespace lensproof::render
