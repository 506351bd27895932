// engine/pupil/pupil_guides.h — finds the nodes around a place fast.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/pupil/pupil_nodes.h"

namespace lensproof::pupil {

/// Where something lies among nodes: between two, at the fraction t.
struct BetweenNodes {
    std::size_t below = 0;
    std::size_t above = 0;
    double t = 0.0;
};

/// A place at a position in the band among the nodes.
struct PupilPlace {
    double cosine = 1.0;  // of its azimuth, which turns the frame of the region
    double sine = 0.0;
    BetweenNodes position{};
    BetweenNodes azimuth{};
    std::size_t fraction = 0;  // between it and the next, at the fraction t
    double t = 0.0;
    bool is_lit = false;

    [[nodiscard]] Vec2d to_own(Vec2d p) const { return {cosine * p.x - sine * p.y, sine * p.x + cosine * p.y}; }
    [[nodiscard]] Vec2d from_own(Vec2d p) const { return {cosine * p.x + sine * p.y, cosine * p.y - sine * p.x}; }
};

/// Where searches among nodes start; made from the nodes.
class PupilGuides {
  public:
    PupilGuides() = default;
    explicit PupilGuides(const PupilNodes& nodes);

    [[nodiscard]] PupilPlace place(const PupilNodes& nodes, Vec2d at, double band_position) const {
        if (nodes.regions.empty()) {
            return {};
        }
        const BetweenNodes position = in_band(nodes, band_position);
        const BetweenNodes azimuth = nodes.azimuths > 1 ? on_turn(nodes.azimuths, at) : BetweenNodes{};
        const double end = (1.0 - position.t) * end_between(nodes, position.below, azimuth) +
                           position.t * end_between(nodes, position.above, azimuth);
        const double radius = std::sqrt(at.x * at.x + at.y * at.y);
        const double fraction = radius / end;
        if (!(fraction <= 1.0)) {
            return {};
        }
        std::size_t below = node_below_[static_cast<std::size_t>(fraction * kSteps)];
        while (below + 2 < nodes.fractions.size() && nodes.fractions[below + 1] < fraction) {
            ++below;
        }
        const double per_radius = radius > 0.0 ? 1.0 / radius : 0.0;
        return {.cosine = radius > 0.0 ? at.y * per_radius : 1.0,
                .sine = at.x * per_radius,
                .position = position,
                .azimuth = azimuth,
                .fraction = below,
                .t = std::clamp((fraction - nodes.fractions[below]) * per_step_[below], 0.0, 1.0),
                .is_lit = true};
    }
    /// Of a region.
    [[nodiscard]] const PanelGuide& panels(std::size_t region) const { return panels_[region]; }

  private:
    static constexpr int kSteps = 1024;

    /// The azimuths around that of a place.
    [[nodiscard]] static BetweenNodes on_turn(std::size_t azimuths, Vec2d at);

    static double end_between(const PupilNodes& nodes, std::size_t position, const BetweenNodes& azimuth) {
        const double* ends = &nodes.ends[position * nodes.azimuths];
        return (1.0 - azimuth.t) * ends[azimuth.below] + azimuth.t * ends[azimuth.above];
    }

    [[nodiscard]] BetweenNodes in_band(const PupilNodes& nodes, double band_position) const {
        if (nodes.positions.size() < 2) {
            return {};
        }
        std::size_t below = 0;
        while (below + 2 < nodes.positions.size() && nodes.positions[below + 1] < band_position) {
            ++below;
        }
        return {.below = below,
                .above = below + 1,
                .t = std::clamp((band_position - nodes.positions[below]) * per_position_[below], 0.0, 1.0)};
    }

    std::vector<std::uint32_t> node_below_;  // for each step, the last node below it
    std::vector<double> per_step_;           // 1 / the step from each fraction to the next
    std::vector<double> per_position_;       // 1 / the step from each position to the next
    std::vector<PanelGuide> panels_;
};

}  // namespace lensproof::pupil
