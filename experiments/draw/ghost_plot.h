// experiments/draw/ghost_plot.h — ghosts as a picture: the way of the strongest through the lens, and their footprints.
#pragma once
#include <string>
#include <vector>

#include "engine/analysis/ghosts.h"

namespace lensproof::draw {

/// A ghost and where its light lies.
struct DrawnGhost {
    optics::GhostPath path;
    std::string name;  // "5,3"
    double energy = 0.0;
    analysis::Footprint footprint;
};

/// An SVG file: above the section of the lens with rays of the first ghost in the plane x = 0, their reflections
/// marked; below the footprints of all on the sensor as the light comes through the lens, +y upwards, on one
/// logarithmic scale of four decades (energy an mm², of the light that enters the entrance pupil). `ghosts` are sorted,
/// the strongest first; of none, that is said.
std::string ghosts_svg(const optics::Prescription& prescription, const optics::Lens& lens,
                       const analysis::GhostScene& scene, const std::string& conditions,
                       const std::vector<DrawnGhost>& ghosts);

}  // namespace lensproof::draw
