// engine/render/stray/lights_in_lens.h — lights that stand where a camera's lens is.
#pragma once
#include <string>
#include <vector>

#include "engine/render/camera/camera.h"
#include "engine/scene/light/light.h"

namespace lensproof::render {

/// Throws InputError naming where a light is stated, of `places`, that has its own place, or one of the sixteen points
/// which `Lights::points_of` has of its surface, inside the camera's lens: behind the first surface, before the sensor
/// and no farther from the axis than anything that is stated of the lens. For a camera that `meets_light_paths` also
/// one in the sphere about the first surface (pupil::BoundingSphere), from which light paths are not drawn: its light
/// would be missing.
void refuse_lights_in_lens(const Camera& camera, const scene::Lights& lights, const std::vector<std::string>& places,
                           bool meets_light_paths);

}  // namespace lensproof::render
