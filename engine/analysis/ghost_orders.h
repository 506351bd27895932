// engine/analysis/ghost_orders.h — which ghosts a lens has, and which of four reflections can carry energy that
// matters.
#pragma once
#include "engine/analysis/ghost_beam.h"

namespace lensproof::analysis {

/// The surfaces that reflect at all, in the order of the light: glass surfaces, coated ones, the stop's blades and the
/// sensor (the number of surfaces) where they are said to reflect.
std::vector<int> reflectors(const GhostScene& scene);

/// Every pair of them.
std::vector<optics::GhostPath> ghosts_of_two(const GhostScene& scene);

/// Ghosts of four reflections whose energy may reach `tolerance`, and what all others together carry at most.
struct RankedGhosts {
    std::vector<optics::GhostPath> paths;
    double skipped_energy_bound = 0.0;
};

/// Light over the whole front element is followed through the tree of reflections. As R + T ≤ 1 at every surface, all
/// ghosts that begin with the same reflections share what light those leave, so a branch with less than `tolerance` is
/// left out with that as its bound. At the end of a branch the bound is what a grid of some 1000 rays lays on the
/// sensor, of whose number k three standard deviations of a count and three more are added, 3 √k + 3, at the largest
/// energy that one of them had after its last reflection; but no more than all had there. So bounds are those of a
/// sample: they hold to its resolution.
RankedGhosts ghosts_of_four(const GhostScene& scene, double tolerance, int threads);

}  // namespace lensproof::analysis
