#include "engine/pupil/pupil_guides.h"

#include <iterator>
#include <numbers>

namespace lensproof::pupil {

namespace {

std::vector<double> inverse_steps(const std::vector<double>& nodes) {
    std::vector<double> inverse;
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
        inverse.push_back(1.0 / (nodes[i + 1] - nodes[i]));
    }
    return inverse;
}

}  // namespace

PupilGuides::PupilGuides(const PupilNodes& nodes)
    : per_step_(inverse_steps(nodes.fractions)), per_position_(inverse_steps(nodes.positions)) {
    std::uint32_t below = 0;
    for (int i = 0; i <= kSteps; ++i) {
        while (below + 2 < nodes.fractions.size() && nodes.fractions[below + 1] * kSteps <= i) {
            ++below;
        }
        node_below_.push_back(below);
    }
    std::ranges::transform(nodes.regions, std::back_inserter(panels_), panel_guide);
}

BetweenNodes PupilGuides::on_turn(std::size_t azimuths, Vec2d at) {
    const double turn = std::atan2(at.x, at.y) / (2.0 * std::numbers::pi);
    const double turned = (turn < 0.0 ? turn + 1.0 : turn) * static_cast<double>(azimuths);
    const double whole = std::min(std::floor(turned), static_cast<double>(azimuths - 1));
    const auto below = static_cast<std::size_t>(whole);
    return {.below = below, .above = (below + 1) % azimuths, .t = turned - whole};
}

}  // namespace lensproof::pupil
