// engine/render/integrators/passes.h — the classes of light paths, each of which a pass renders.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "engine/render/integrators/integrators.h"

namespace lensproof::render {

/// Every path of light from its source to the film is of one class, and each class a pass: the films of all of them add
/// up to the picture, with nothing twice and nothing missing.
///
///   imaged        from the scene, through the lens
///   direct        from a light, through the lens: lamps as they are seen
///   ghosts        reflected twice in the lens
///   faint-ghosts  reflected four times and more
///   barrel        scattered by a wall inside the lens or dust on its front, once or more
///   diffracted    turned aside by the edges of the stop; what images is less by that, where both are rendered
///   waves         straight from a sun, imaged and diffracted: in the place of what `direct` and `diffracted` have of
///   it
///
/// And two that are none of them, but what the first two and what the first five add up to:
///
///   straight      what images and what is seen, by the same paths: half the time of the two
///   everything    at every surface and wall it is left to chance what becomes of the light: slow, and a judge of
///   others
struct Pass {
    std::string name;  // as `render --passes` has it
    std::string description;
    /// `integrator`: that of paths which image.
    Render (*render)(const View& view, const Integrator& integrator) = nullptr;
    bool goes_straight = false;  // through the stop
    bool is_sum = false;         // of other passes
};

const std::vector<Pass>& passes();

/// Why these do not add up to a picture: one stands twice, or beside what it is a part of. Else empty.
std::string pass_conflict(const std::vector<std::string>& names);

/// By which integrator each pass is rendered that goes straight through the stop.
struct PassIntegrators {
    const Integrator* usual = &integrator_named("camera");
    std::map<std::string, const Integrator*> of_pass = {};  // by its name, in place of the usual one

    [[nodiscard]] const Integrator& of(const std::string& pass) const;
    /// Whether one of them does.
    [[nodiscard]] bool has_splats() const;
};

/// Passes that are to be added up: where "diffracted" is one of them, those that go straight through the stop are less
/// by what its edges take. All others go through the view's stray camera. Throws InputError where that has none of a
/// pass's light, and where their films together take more memory than may be (kMostFilmBytes), std::out_of_range as
/// `pass_named`.
std::vector<Render> renders_of(const std::vector<std::string>& names, const View& view,
                               const PassIntegrators& integrators);

/// Throws std::out_of_range for a name that is none of them.
const Pass& pass_named(const std::string& name);

}  // namespace lensproof::render
