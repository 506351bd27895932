// engine/render/light_tracer.h — light paths: from the lights through the scene and into the camera to the film.
#pragma once
#include <cstdint>

#include "engine/render/camera_end.h"
#include "engine/render/film.h"
#include "engine/render/path_vertex.h"
#include "engine/render/sampling/path_sampler.h"
#include "engine/scene/scene.h"

namespace lensproof::render {

/// Whether light paths make the image by themselves, or with camera paths (path_weight.h), one to each of these of each
/// pixel.
enum class LightPaths { alone, with_camera_paths };

/// Follows one light path, and from each of its points joins the camera (Dutré, Lafortune & Willems, EGSR 1993,
/// "particle tracing" with a camera of glass): a ray into it is drawn with a known density, and each wavelength is
/// brought forward from there to where it meets the film. The ray outside is common to all wavelengths, the way
/// through the lens and the film point are each one's own.
///
/// What lands is splatted: the flux over a pixel's area, whose mean over all light paths is the film irradiance in
/// W·m⁻²·nm⁻¹. Paths whose last point before the camera is a mirror (or smooth glass) cannot be joined to it: alone,
/// light paths miss them; with camera paths, these bring them. Light from surfaces inside the sphere about a lens's
/// front is likewise theirs. Sources without an extent (points, spots) light the scene and are not seen themselves, as
/// they are not by camera paths nor in mirrors: their radiance is no number; small spheres are seen.
/// Returns how many rays were traced, in the scene and into the camera.
std::uint32_t trace_light_path(const scene::Scene& scene, const CameraEnd& camera,
                               const spectral::PathWavelengths& path, const PathSettings& settings,
                               PathSampler& numbers, FilmTile& tile, LightPaths paths = LightPaths::alone);

}  // namespace lensproof::render
