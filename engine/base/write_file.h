// engine/base/write_file.h — output files: each appears whole or not at all, also where the power fails.
#pragma once
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

namespace lensproof {

/// Throws InputError when `file` cannot be written, as far as can be told before: a folder, a name that ends in a slash
/// or is too long, a path through a file, a folder in which nothing can be made. To be asked before long work begins;
/// nothing stays.
void check_output_name(const std::filesystem::path& file);

/// Until when a file that was written stays: until the next power cut, or beyond.
enum class Durability { usual, power_cut };

/// Writes `content` so that `file` appears whole or not at all (written beside, then renamed). Throws
/// std::runtime_error when that fails (disk full, no permission).
void write_file(const std::filesystem::path& file, std::string_view content,
                Durability durability = Durability::power_cut);

/// The same for content of any length, which `write` puts out bit by bit.
void write_stream(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write,
                  Durability durability = Durability::power_cut);

/// Runs `write` on a temporary file beside `file` and renames the outcome; on an exception nothing is left behind. The
/// temporary file is there and empty, its name cannot be guessed, and it has `file`'s extension, by which libraries of
/// pictures choose. A device or a pipe is written to as it is, and a link's target is what is replaced. What killed
/// processes left in the same folder goes.
void write_whole(const std::filesystem::path& file, const std::function<void(const std::filesystem::path&)>& write,
                 Durability durability = Durability::power_cut);

/// Where a result lies, and what was wrong with the place that was asked for; empty where it lies there.
struct Delivery {
    std::filesystem::path place;
    std::string complaint;
};

/// Writes a result that must not be lost: to the first of `places` that takes it, of which all but the one asked for
/// must be free, else into a new folder among the system's temporary files. Throws what went wrong at the first place
/// where all refuse.
Delivery write_somewhere(const std::vector<std::filesystem::path>& places,
                         const std::function<void(const std::filesystem::path&)>& write);

}  // namespace lensproof
