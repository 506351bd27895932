// engine/pupil/pupil_guides.h — finds the nodes around a sensor point fast.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/pupil/pupil_nodes.h"

namespace lensproof {

/// A sensor point among the nodes: between the radii `radius` and the next, after the share `t`.
struct PupilPlace {
    double cosine = 1.0;  // of the point's azimuth, which turns the frame of its region
    double sine = 0.0;
    std::size_t radius = 0;
    double t = 0.0;
    bool is_lit = false;

    [[nodiscard]] Vec2d to_own(Vec2d p) const { return {cosine * p.x - sine * p.y, sine * p.x + cosine * p.y}; }
    [[nodiscard]] Vec2d from_own(Vec2d p) const { return {cosine * p.x + sine * p.y, cosine * p.y - sine * p.x}; }
};

/// Between which azimuths it lies, `below` and `above`, and after which share.
struct AzimuthPlace {
    std::size_t below = 0;
    std::size_t above = 0;
    double t = 0.0;
};

/// Where searches among nodes start; made from the nodes.
class PupilGuides {
  public:
    PupilGuides() = default;
    explicit PupilGuides(const PupilNodes& nodes);

    [[nodiscard]] PupilPlace place(const PupilNodes& nodes, Vec2d sensor_point) const {
        const double radius = std::sqrt(sensor_point.x * sensor_point.x + sensor_point.y * sensor_point.y);
        if (!(radius <= end_)) {
            return {};
        }
        std::size_t below = radius_below_[static_cast<std::size_t>(radius * steps_per_mm_)];
        while (below + 2 < nodes.radii.size() && nodes.radii[below + 1] < radius) {
            ++below;
        }
        const double per_radius = radius > 0.0 ? 1.0 / radius : 0.0;
        return {.cosine = radius > 0.0 ? sensor_point.y * per_radius : 1.0,
                .sine = sensor_point.x * per_radius,
                .radius = below,
                .t = std::clamp((radius - nodes.radii[below]) * per_step_[below], 0.0, 1.0),
                .is_lit = true};
    }
    [[nodiscard]] static AzimuthPlace azimuth_place(const PupilNodes& nodes, Vec2d sensor_point);

    /// Of a region.
    [[nodiscard]] const PanelGuide& panels(std::size_t region) const { return panels_[region]; }

  private:
    double end_ = -1.0;  // the last radius; negative: there is none
    double steps_per_mm_ = 0.0;
    std::vector<std::uint32_t> radius_below_;  // for each step of radius, the last node below it
    std::vector<double> per_step_;             // 1 / the step from each node to the next, 1/mm
    std::vector<PanelGuide> panels_;
};

}  // namespace lensproof
