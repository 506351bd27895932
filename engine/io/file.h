// engine/io/file.h — whole-file reading and writing, and where the project's own data lies.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace lensproof {

/// The file's bytes. Throws InputError naming the file when it is missing, a folder, or unreadable.
std::string read_file(const std::filesystem::path& file);

/// Writes `content` so that `file` appears whole or not at all (written beside, then renamed).
/// Throws std::runtime_error when that fails (disk full, no permission).
void write_file(const std::filesystem::path& file, std::string_view content);

/// Runs `write` on a temporary path beside `file` and renames the outcome; on an exception nothing is left behind.
void write_whole(const std::filesystem::path& file, const std::function<void(const std::filesystem::path&)>& write);

/// The folder that holds lenses/, experiments/ and reference_photos/: $LENSPROOF_HOME, else the source tree built from.
std::filesystem::path data_root();

}  // namespace lensproof
