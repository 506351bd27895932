// engine/render/scene_render.h — a scene seen through a camera: the pass of camera paths.
#pragma once
#include <cstdint>
#include <variant>
#include <vector>

#include "engine/optics/packet/spectral_lens.h"
#include "engine/pupil/pupil_slices.h"
#include "engine/render/film.h"
#include "engine/render/ideal_camera.h"
#include "engine/render/path_tracer.h"
#include "engine/render/progressive.h"
#include "engine/render/sensor.h"
#include "engine/scene/affine.h"
#include "engine/scene/scene.h"

namespace lensproof {

/// Where a camera stands in the world. Its frame is that of pose.h: x to the right of the picture, y down, z into the
/// scene, the origin at the vertex of the lens's first surface.
struct CameraPose {
    Vec3d position;
    Vec3d right{1.0, 0.0, 0.0};
    Vec3d down{0.0, 1.0, 0.0};
    Vec3d forward{0.0, 0.0, 1.0};

    [[nodiscard]] Vec3d direction_to_world(const Vec3d& in_camera) const {
        return in_camera.x * right + in_camera.y * down + in_camera.z * forward;
    }
    [[nodiscard]] Vec3d to_world(const Vec3d& in_camera) const { return position + direction_to_world(in_camera); }
    [[nodiscard]] Vec3d direction_to_camera(const Vec3d& in_world) const {
        return {dot(in_world, right), dot(in_world, down), dot(in_world, forward)};
    }
    [[nodiscard]] Vec3d to_camera(const Vec3d& in_world) const { return direction_to_camera(in_world - position); }
};

/// A camera at `position` that looks at `target`, `up` being upwards in the picture. Throws InputError where these do
/// not say a direction: the two points coincide, or `up` is along the view.
CameraPose look_at(const Vec3d& position, const Vec3d& target, const Vec3d& up);

/// The lens of a camera, ready for paths, at the strata of the scene's grid.
struct ExactCamera {
    const SpectralLens<double>* lens = nullptr;
    const PupilSlices* pupil = nullptr;
};
/// Ideal ones need a GaussianCamera a stratum.
using SceneCamera = std::variant<ExactCamera, std::vector<GaussianCamera>>;

/// What is seen, by what, and what the film makes of it. Held by pointer: both outlive the render.
struct SceneView {
    const Scene* scene = nullptr;
    const SceneCamera* camera = nullptr;
    CameraPose pose;
    Sensor sensor;
    FilmLayout film;
    std::vector<Vec3d> albedo_weights;  // a stratum each: RGB of a reflectance of 1 there; their mean is 1
    PathSettings paths;
    std::uint64_t seed = 0;
};

/// A renderer of the view's tiles for one thread; it is outlived by the view, of which it keeps a copy.
///
/// The estimator of the measurement equation is that of CameraPathBuffer. Through a lens each wavelength has its own
/// way, so that a path is its hero's alone; through a camera without colour errors it carries all four wavelengths.
/// Features: depth along the camera's axis, albedo, and the shading normal in the camera's frame.
TileRenderer scene_renderer(const SceneView& view);

}  // namespace lensproof
