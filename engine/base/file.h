// engine/base/file.h — whole-file reading and writing, and where the project's own data lies.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace lensproof {

/// Throws InputError naming the file when it is missing or a folder.
void check_readable(const std::filesystem::path& file);

/// The file's bytes. Throws InputError naming the file when it is missing, a folder, unreadable, or larger than 256
/// MiB.
std::string read_file(const std::filesystem::path& file);

/// Throws InputError when `file` cannot be a file's name: a folder, a name that ends in a slash, a path through a file.
/// To be asked before long work begins; nothing is made.
void check_output_name(const std::filesystem::path& file);

/// Writes `content` so that `file` appears whole or not at all (written beside, then renamed).
/// Throws std::runtime_error when that fails (disk full, no permission).
void write_file(const std::filesystem::path& file, std::string_view content);

/// Until when a file that was written stays: until the next power cut, or beyond.
enum class Durability { usual, power_cut };

/// Runs `write` on a temporary path beside `file` and renames the outcome; on an exception nothing is left behind.
/// A device or a pipe is written to as it is, and a link's target is what is replaced.
void write_whole(const std::filesystem::path& file, const std::function<void(const std::filesystem::path&)>& write,
                 Durability durability = Durability::usual);

/// Removes what killed processes left of `write_whole` beside `file`.
void remove_leftovers(const std::filesystem::path& file);

/// The name's extension with its dot, in small letters.
std::string lower_extension(const std::filesystem::path& file);

/// The folder that holds lenses/, experiments/ and reference_photos/: $LENSPROOF_HOME, else the source tree built from.
std::filesystem::path data_root();

}  // namespace lensproof
