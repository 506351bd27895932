// engine/scene/geometry/ply_check.h — whether a PLY file holds all that its header promises.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace lensproof::scene {

/// Throws InputError naming `file` unless the header is sound and every element that it promises is there, with all its
/// properties: Assimp's own reader goes round for ever where a file ends early, or at carriage returns before its
/// header's end, and takes any count for true. Returns the same mesh as plainly as PLY can say it: without comments,
/// odd blanks, and elements that no mesh has, which PLY allows and Assimp takes for the next one's.
std::string checked_ply(std::string_view content, const std::filesystem::path& file);

}  // namespace lensproof::scene
