// engine/render/light_tracer.h — light paths: from the lights through the scene and forward through the lens to the
// film.
#pragma once
#include <cstdint>

#include "engine/optics/packet/spectral_lens.h"
#include "engine/pupil/entrance_map.h"
#include "engine/render/film.h"
#include "engine/render/path_sampler.h"
#include "engine/render/path_tracer.h"
#include "engine/render/sensor.h"
#include "engine/scene/pose.h"
#include "engine/scene/scene.h"

namespace lensproof {

/// A lens as the end of light paths.
struct LensEntrance {
    const SpectralLens<double>* lens = nullptr;  // at the strata of the scene's grid
    const EntranceMap* map = nullptr;            // of the same band, for far light, with a large defensive share:
                                                 // where near points' light enters lies a little beside its regions
    BoundingSphere front;
    RigidMotion camera_to_world;  // of the frame of pose.h
    Sensor sensor;
};

/// Follows one light path, and from each of its points joins the lens (Dutré, Lafortune & Willems, EGSR 1993, "particle
/// tracing" with a camera of glass): a point of the lens's entrance is drawn with a known density, and each wavelength
/// is traced forward from there to where it meets the film. The ray outside is common to all wavelengths, the way
/// through the lens and the film point are each one's own.
///
/// What lands is splatted: the flux over a pixel's area, whose mean over all light paths is the film irradiance in
/// W·m⁻²·nm⁻¹. Paths whose last point before the lens is a mirror (or smooth glass)
/// cannot be joined to it and are missing; so is light from surfaces inside the front sphere. Point and spot lights in
/// view make points in the picture, which camera paths cannot find.
/// Returns how many rays were traced, in the scene and into the lens.
std::uint32_t trace_light_path(const Scene& scene, const LensEntrance& entrance, const PathWavelengths& path,
                               const PathSettings& settings, PathSampler& numbers, FilmTile& tile);

}  // namespace lensproof
