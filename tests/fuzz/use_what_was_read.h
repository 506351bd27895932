// tests/fuzz/use_what_was_read.h — what a reader took must survive being used.
#pragma once
#include "engine/formats/glass/glass_file.h"
#include "engine/optics/prescription.h"
#include "engine/render/scene_setup.h"

namespace lensproof {

/// Checks the prescription, which must not fail, makes a lens of it with the glasses that ship, unless that is refused,
/// and traces a ray.
void use(const optics::Prescription& prescription);

/// Asks each glass for its index, its transmittance and its change with temperature.
void use(const formats::GlassFile& file);

/// Builds the scene's geometry, unless that is refused, and sends a ray from the camera.
void use(const render::SceneSetup& setup);

}  // namespace lensproof
