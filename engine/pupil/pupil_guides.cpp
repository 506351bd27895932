#include "engine/pupil/pupil_guides.h"

#include <iterator>
#include <numbers>

namespace lensproof {

PupilGuides::PupilGuides(const PupilNodes& nodes) {
    if (nodes.radii.size() < 2) {
        return;
    }
    constexpr std::size_t kSteps = 1024;
    end_ = nodes.radii.back();
    steps_per_mm_ = static_cast<double>(kSteps) / end_;
    std::uint32_t below = 0;
    for (std::size_t i = 0; i <= kSteps; ++i) {
        while (below + 2 < nodes.radii.size() && nodes.radii[below + 1] * steps_per_mm_ <= static_cast<double>(i)) {
            ++below;
        }
        radius_below_.push_back(below);
    }
    for (std::size_t i = 0; i + 1 < nodes.radii.size(); ++i) {
        per_step_.push_back(1.0 / (nodes.radii[i + 1] - nodes.radii[i]));
    }
    std::ranges::transform(nodes.regions, std::back_inserter(panels_), panel_guide);
}

AzimuthPlace PupilGuides::azimuth_place(const PupilNodes& nodes, Vec2d sensor_point) {
    const double turn = std::atan2(sensor_point.x, sensor_point.y) / (2.0 * std::numbers::pi);
    const double at = (turn < 0.0 ? turn + 1.0 : turn) * static_cast<double>(nodes.azimuths);
    const double whole = std::min(std::floor(at), static_cast<double>(nodes.azimuths - 1));
    const auto below = static_cast<std::size_t>(whole);
    return {.below = below, .above = (below + 1) % nodes.azimuths, .t = at - whole};
}

}  // namespace lensproof
