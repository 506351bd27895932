// engine/scene/geometry/gltf_check.h — whether a glTF file's tree of nodes can be built.
#pragma once
#include <filesystem>

namespace lensproof::scene {

/// Throws InputError naming `file` unless its nodes lie at most 256 deep and, with those that several share counted for
/// each, are at most 250 000 below a scene: Assimp's reader calls itself for every level and copies what is shared, so
/// that two kilobytes may ask for any amount of memory (250 000 of its nodes take 0.3 GB). Nor may a buffer be named by
/// a URI with a scheme ("://"), which it reads past the end of. The JSON form or the binary one; what else may be wrong
/// is left to the reader.
void check_gltf(const std::filesystem::path& file);

}  // namespace lensproof::scene
