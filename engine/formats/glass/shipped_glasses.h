// engine/formats/glass/shipped_glasses.h — the glasses of lenses/glass.
#pragma once
#include <filesystem>
#include <vector>

#include "engine/optics/glass_catalogue.h"

namespace lensproof::formats {

/// All that ship, read once. Throws InputError naming file and line of an entry that is unusable.
const optics::GlassCatalogue& shipped_glasses();

/// The files that `shipped_glasses` reads: among the inputs of whatever is computed with them.
std::vector<std::filesystem::path> shipped_glass_files();

/// The files that `shipped_transmittance` reads: likewise.
std::vector<std::filesystem::path> shipped_transmittance_files();

/// The internal transmittance of a glass that ships, which is not read with the rest; the glass's own where it has one.
std::vector<optics::TransmittancePoint> shipped_transmittance(const optics::Glass& glass);

}  // namespace lensproof::formats
