// engine/base/data_root.h — where the data that ship with the program lie.
#pragma once
#include <filesystem>

namespace lensproof {

/// The folder that holds lenses/, experiments/ and reference_photos/: $LENSPROOF_HOME, else share/lensproof in the
/// nearest folder that has it above the program (or the library) that this code is part of: /usr for
/// /usr/bin/lensproof, and the build folder, where it is a link to the source tree. So an installation may be moved,
/// and holds no path of the machine that built it. Throws std::runtime_error where there is none.
std::filesystem::path data_root();

}  // namespace lensproof
