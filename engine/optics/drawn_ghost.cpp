#include "engine/optics/drawn_ghost.h"

#include <algorithm>
#include <cmath>

namespace lensproof::optics {

namespace {

// About 0.06 at bare glass, which reflects as much: more often, and the many surfaces that light passes would each make
// what goes on heavier.
constexpr double kOfRoot = 0.3;
constexpr double kMostTurning = 0.25;

}  // namespace

std::vector<double> turning_probabilities(const TraceLens<double>& lens, const StrayMirrors<double>& mirrors) {
    std::vector<double> turning;
    const auto add = [&](double reflectance) { turning.push_back(std::min(kMostTurning, kOfRoot * std::sqrt(reflectance))); };
    for (const TraceSurface<double>& surface : lens.surfaces) {
        const SpecialSurface<double>* special =
            surface.special < 0 ? nullptr : &lens.specials[static_cast<std::size_t>(surface.special)];
        const Refraction<double> straight{.direction = {}, .cos_refraction = 1.0, .transmitted = true};
        add(reflects_by_blades(surface) ? mirrors.blades : surface_reflectance(surface, special, true, 1.0, straight));
    }
    add(mirrors.sensor);
    return turning;
}

std::optional<DrawnGhost> draw_ghost(const std::vector<double>& turning, const std::function<double()>& number) {
    const int sensor = static_cast<int>(turning.size()) - 1;
    DrawnGhost drawn;
    int step = 1;
    for (int index = 0; index >= 0; index += step) {
        const double probability = turning[static_cast<std::size_t>(index)];
        const bool turns = probability > 0.0 && number() < probability;
        drawn.probability *= turns ? probability : 1.0 - probability;
        if (turns) {
            drawn.path.push_back(index);
            step = -step;
        } else if (index == sensor) {
            return drawn;
        }
    }
    return std::nullopt;
}

}  // namespace lensproof::optics
