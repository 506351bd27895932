// engine/render/scene_render.h — a scene seen through a camera, by camera paths, by light paths or by both.
#pragma once
#include <cstdint>
#include <variant>
#include <vector>

#include "engine/optics/packet/spectral_lens.h"
#include "engine/pupil/pupil_slices.h"
#include "engine/render/camera_end.h"
#include "engine/render/film.h"
#include "engine/render/ideal_camera.h"
#include "engine/render/path_tracer.h"
#include "engine/render/progressive.h"
#include "engine/render/sampling/sensor.h"
#include "engine/scene/pose.h"
#include "engine/scene/scene.h"

namespace lensproof::render {

/// The lens of a camera, ready for paths, at the strata of the scene's grid.
struct ExactCamera {
    const optics::SpectralLens<double>* lens = nullptr;
    const pupil::PupilSlices* pupil = nullptr;
};
/// Ideal ones need a GaussianCamera a stratum.
using SceneCamera = std::variant<ExactCamera, std::vector<GaussianCamera>>;

/// What is seen, by what, and what the film makes of it. Held by pointer: both outlive the render.
struct SceneView {
    const scene::Scene* scene = nullptr;
    const SceneCamera* camera = nullptr;
    scene::RigidMotion camera_to_world;  // of the frame of pose.h
    Sensor sensor;
    FilmLayout film;
    std::vector<Vec3d> albedo_weights;  // a stratum each: RGB of a reflectance of 1 there; their mean is 1
    PathSettings paths;
    std::uint64_t seed = 0;
};

/// A renderer of the view's tiles for one thread; it is outlived by the view, of which it keeps a copy.
///
/// The estimator of the measurement equation is that of CameraPathBuffer, at four wavelengths a path: through a lens
/// each has its own way and weight (SharedRays), through a pinhole or a thin lens one way serves all. Where they part,
/// and with pixel filters wider than the box, the hero goes alone.
/// Features: depth along the camera's axis, albedo, and the shading normal in the camera's frame.
TileRenderer scene_renderer(const SceneView& view);

/// The same view by light paths (light_tracer.h), one for each sample of each pixel, wherever it lands: the film's
/// layout has splats. `end` is the view's camera and outlives it.
TileRenderer light_path_renderer(const SceneView& view, const CameraEnd& end);

/// The same view by a camera path and a light path for each sample of each pixel, weighed by how well each makes what
/// they find (path_weight.h): what glass gathers comes by light paths, what mirrors show by camera paths, and all else
/// by both. With --noise some pixels have fewer of either; weights stay those of one for one, and shares sum to one.
TileRenderer both_paths_renderer(const SceneView& view, const CameraEnd& end);

}  // namespace lensproof::render
