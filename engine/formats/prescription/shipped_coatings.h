// engine/formats/prescription/shipped_coatings.h — the coatings of lenses/coatings, and who wears them.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/optics/prescription.h"

namespace lensproof::formats {

/// A coating from a file of its own. No maker publishes the layers on a lens, so it is assumed wherever it is put.
struct NamedCoating {
    std::string id;  // the file's stem, by which lenses name it
    std::string name;
    std::string source;
    std::string notes;
    std::filesystem::path file;
    optics::Coating coating;
};

/// Reads `name`, `source`, `notes` and the keys of a table [coatings.NAME]. Throws InputError naming file, line and
/// key.
NamedCoating read_coating_file(const std::filesystem::path& file);

/// The names of those that ship, sorted.
std::vector<std::string> shipped_coating_names();
bool is_shipped_coating(const std::string& name);
NamedCoating shipped_coating(const std::string& name);

/// What a name that is neither the lens's nor of those that ship may have meant, to end a message with.
std::string coating_hint(const std::string& name, const optics::Prescription& lens);

/// The lens with other coatings, as `--coating` says them, one after the other and several between commas: NAME is put
/// on every face between glass and air, `3=NAME` on surface 3 (from 1); `none` makes bare. A name is that of a coating
/// of the lens, or of one that ships. Throws InputError for what is neither, and for a surface that there is not.
optics::Prescription with_coatings(optics::Prescription lens, const std::vector<std::string>& wishes);

}  // namespace lensproof::formats
