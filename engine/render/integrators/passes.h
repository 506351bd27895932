// engine/render/integrators/passes.h — the classes of light paths, each of which a pass renders.
#pragma once
#include <string>
#include <vector>

#include "engine/render/integrators/integrators.h"

namespace lensproof::render {

/// Every path of light from its source to the film is of one class, and each class a pass: the films of all of them add
/// up to the picture, with nothing twice and nothing missing.
///
///   imaged    from the scene, through the lens
///   direct    from a light, through the lens: lamps as they are seen
///   ghosts    reflected in the lens, an even number of times
///   barrel    scattered by a wall inside the lens, once or more
///
/// And one that is none of them but what they add up to, as long as nothing else is modelled:
///
///   everything    at every surface and wall it is left to chance what becomes of the light: slow, and a judge of the
///   others
struct Pass {
    std::string name;  // as `render --passes` has it
    std::string description;
    /// `integrator`: that of paths which image.
    Render (*render)(const View& view, const Integrator& integrator) = nullptr;
};

const std::vector<Pass>& passes();

/// Throws std::out_of_range for a name that is none of them.
const Pass& pass_named(const std::string& name);

}  // namespace lensproof::render
