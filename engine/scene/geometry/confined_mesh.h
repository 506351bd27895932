// engine/scene/geometry/confined_mesh.h — a mesh that a confined process reads.
#pragma once
#include <filesystem>

#include "engine/scene/geometry/mesh_file.h"

namespace lensproof::scene {

/// read_mesh_here in a confined process (engine/base/confined.h) that may read the file's folder. What it answers may
/// be any mesh, and has to be repaired as any.
MeshFile read_mesh_confined(const std::filesystem::path& file, const MeshOptions& options);

}  // namespace lensproof::scene
