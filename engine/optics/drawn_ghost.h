// engine/optics/drawn_ghost.h — ghosts drawn by chance, of any number of reflections.
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "engine/optics/ghost_path.h"

namespace lensproof::optics {

struct DrawnGhost {
    GhostPath path;  // none of its surfaces: the image's own light
    double probability = 1.0;
};

/// How often light is drawn to turn back at each surface, and last at the sensor: as the root of what it reflects
/// straight on, so that ghosts of good coatings are not drawn as seldom as they are faint; a quarter of the time at most.
std::vector<double> turning_probabilities(const TraceLens<double>& lens, const StrayMirrors<double>& mirrors);

/// Light's way in from the front to the sensor, with a probability that does not depend on the ray. `number` gives
/// numbers in [0, 1). Nothing where the way leads out of the front.
std::optional<DrawnGhost> draw_ghost(const std::vector<double>& turning, const std::function<double()>& number);

}  // namespace lensproof::optics
