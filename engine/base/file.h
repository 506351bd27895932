// engine/base/file.h — whole-file reading, and what files refer to.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace lensproof {

/// Whether there is anything of that name, and whether that is a folder. What cannot be looked at, as a name longer
/// than names may be, is not there.
bool is_there(const std::filesystem::path& file);
bool is_folder(const std::filesystem::path& file);

/// Throws InputError naming the file when it is missing or a folder.
void check_readable(const std::filesystem::path& file);

/// Throws InputError where it is missing, or no regular file: what opens a device or a pipe by its name may wait for
/// ever, or read for ever. `expected`: "a checkpoint".
void check_regular(const std::filesystem::path& file, std::string_view expected);

/// The file's bytes. Throws InputError naming the file when it is missing, a folder, unreadable, or larger than 256
/// MiB.
std::string read_file(const std::filesystem::path& file);

/// Where files are distrusted (confined.h): throws InputError unless the file that `from` refers to lies in the folder
/// of `from` or below it, links followed, or is the project's own.
void check_reference(const std::filesystem::path& from, const std::filesystem::path& file);

/// The file that `from` refers to by `name`, which is relative to it. Throws as check_reference does.
std::filesystem::path referred_file(const std::filesystem::path& from, const std::filesystem::path& name);

/// The name's extension with its dot, in small letters.
std::string lower_extension(const std::filesystem::path& file);

}  // namespace lensproof
