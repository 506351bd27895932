// engine/render/integrators/integrators.h — the integrators, by name.
#pragma once
#include <string>
#include <vector>

#include "engine/render/integrators/view.h"

namespace lensproof::render {

/// What makes a film of a world. Each is a file in this folder and a line in integrators.cpp.
struct Integrator {
    std::string name;         // as `render --paths` has it
    std::string description;  // what of it stands among a render's settings
    bool has_splats = false;  // light lands anywhere: the film keeps it, the camera meets light paths
    TileRenderer (*renderer)(const View& view) = nullptr;

    /// The camera's film, with what the integrator puts there.
    [[nodiscard]] Render render(const View& view) const;
};

/// Of scenes: "camera", "light" and "both"; of charts under even light: "chart".
const std::vector<Integrator>& integrators();

/// Throws std::out_of_range for a name that is none of them.
const Integrator& integrator_named(const std::string& name);

}  // namespace lensproof::render
