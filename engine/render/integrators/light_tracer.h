// engine/render/integrators/light_tracer.h — light paths: from the lights through the scene and into the camera to the
// film.
#pragma once
#include <cstdint>

#include "engine/render/integrators/view.h"

namespace lensproof::render {

/// Renders a scene by light paths, one for each sample of each pixel, wherever it lands: the film's layout has splats,
/// and the camera meets light paths.
///
/// Each path is followed, and from each of its points joins the camera (Dutré, Lafortune & Willems, EGSR 1993,
/// "particle tracing" with a camera of glass): a ray into it is drawn with a known pdf, and each wavelength is brought
/// forward from there to where it meets the film. The ray outside is common to all wavelengths, the path through the
/// lens and the film point are each one's own.
///
/// What lands is splatted: the flux over a pixel's area, whose mean over all light paths is the film irradiance in
/// W·m⁻²·nm⁻¹. Paths whose last point before the camera is a mirror (or smooth glass) cannot be joined to it: alone,
/// light paths miss them; with camera paths, these bring them. Light from surfaces inside the sphere about a lens's
/// front is likewise theirs. Sources without an extent (points, spots) light the scene and are not seen themselves, as
/// they are not by camera paths nor in mirrors: their radiance is no number; small spheres are seen.
TileRenderer light_tracer(const View& view, Combination combination = Combination::alone);

}  // namespace lensproof::render
