// tests/fuzz/file_readers.h — the readers that take a file, as the fuzz targets want them: of bytes.
#pragma once
#include <string>
#include <string_view>

#include "calibration/photographed/photographed_lens.h"
#include "calibration/profile/profile.h"
#include "engine/formats/image/image.h"
#include "engine/render/film/film_exr.h"
#include "engine/render/progressive.h"
#include "engine/scene/geometry/mesh_file.h"
#include "experiments/runner/experiment.h"

namespace lensproof::fuzzed {

using Name = const char*;  // not used: each has a file of its own

/// A picture of any form to look at, and as a photograph with its notes.
formats::Image picture(std::string_view bytes, Name);

/// The same where the name says that it is a camera's raw file.
formats::Image raw_picture(std::string_view bytes, Name);

/// A maker's corrections in a DNG.
calibration::PhotographedLens dng(std::string_view bytes, Name);

/// The film of a render or of a shard.
render::FilmFile film(std::string_view bytes, Name);

/// A render that goes on from the checkpoint that these bytes are with their digest.
render::RenderState checkpoint(std::string_view bytes, Name);

scene::MeshFile gltf(std::string_view bytes, Name);
scene::MeshFile glb(std::string_view bytes, Name);
scene::MeshFile obj(std::string_view bytes, Name);
scene::MeshFile ply(std::string_view bytes, Name);

runner::Experiment experiment(std::string_view bytes, Name);

}  // namespace lensproof::fuzzed

namespace lensproof {

/// What was read need only be there.
template <class Read>
void use(const Read& /*read*/) {}

/// Builds the mesh's geometry, unless that is refused, and sends a ray.
void use(const scene::MeshFile& read);

}  // namespace lensproof
