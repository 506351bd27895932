// engine/scene/geometry/obj_check.h — what an OBJ file says of a mesh, and whether it can be.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace lensproof::scene {

struct CheckedObj {
    std::string text;
    std::size_t lines_and_points = 0;  // which it leaves out, with faces of one or two corners
};

/// The same mesh as plainly as OBJ can say it: vertices, their coordinates in textures and normals, faces, and names of
/// objects, groups and materials; a face has coordinates or normals where all of its corners have. Throws InputError
/// naming `file` and line where these are not what they should be, or stand for what is not there: Assimp's own reader
/// counts a line of three points as less than it writes, and goes by a file's letters without looking where they end.
/// Libraries of materials are not opened: a scene file says what things are made of.
CheckedObj checked_obj(std::string_view content, const std::filesystem::path& file);

}  // namespace lensproof::scene
