// engine/base/file.h — whole-file reading, and where the project's own data lies.
#pragma once
#include <filesystem>
#include <string>

namespace lensproof {

/// Throws InputError naming the file when it is missing or a folder.
void check_readable(const std::filesystem::path& file);

/// The file's bytes. Throws InputError naming the file when it is missing, a folder, unreadable, or larger than 256
/// MiB.
std::string read_file(const std::filesystem::path& file);

/// The name's extension with its dot, in small letters.
std::string lower_extension(const std::filesystem::path& file);

/// The folder that holds lenses/, experiments/ and reference_photos/: $LENSPROOF_HOME, else the source tree built from.
std::filesystem::path data_root();

}  // namespace lensproof
