// engine/formats/glass/glass_file.h — glasses read from files: the project's own tables, Zemax catalogues,
// refractiveindex.info.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/optics/glass.h"

namespace lensproof::formats {

/// What a file of glasses holds.
struct GlassFile {
    std::vector<optics::Glass> glasses;
    /// What was left out or not understood, as "file:line: …": for the user to see, and no reason to stop.
    std::vector<std::string> notes;
};

/// Reads a catalogue by its extension: .agf (Zemax), .yml or .yaml (refractiveindex.info), .csv (as in lenses/glass).
/// Throws InputError for another extension, and for a file that is not what its extension says.
GlassFile read_glass_file(const std::filesystem::path& file);

/// The project's own form; lenses/glass/README.md says what the columns are. `name` stands for the file in messages.
/// Throws InputError naming line and column of an entry that is unusable, and for a glass that stands there twice.
GlassFile parse_glass_table(std::string text, const std::filesystem::path& name);

/// A Zemax catalogue (.agf), in any encoding of `to_utf8`: records NM, GC, ED, CD, TD, OD, LD and IT, dispersion
/// formulas 1 to 13, with numbers that run on in the next line. Glasses that cannot be used (a formula that is not one
/// of these, no range, an index that is not real in it) are left out with a note, and so are keywords that are not
/// known. The catalogue takes the file's name. Throws InputError for a number that is none, and where there is no
/// glass.
GlassFile parse_agf(const std::string& bytes, const std::filesystem::path& name);

/// A page of the refractiveindex.info database (YAML): formulas 1 to 9 or a table of n, and k where it stands beside,
/// as transmittance through 10 mm. The glass takes the file's name. Throws InputError for what is not such a page.
GlassFile parse_rii(const std::string& text, const std::filesystem::path& name);

}  // namespace lensproof::formats
