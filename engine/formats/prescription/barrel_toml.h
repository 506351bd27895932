// engine/formats/prescription/barrel_toml.h — what the inside of a lens scatters, as files state it (lenses/README.md).
#pragma once
#include "engine/base/toml.h"
#include "engine/optics/wall_finish.h"

namespace lensproof::formats {

/// A table [barrel]: albedo, gloss and roughness of all walls, and tables `tube`, `edges` and `blades` of those keys
/// for what differs. Nothing else. Throws InputError as `TomlTable` does.
optics::BarrelFinish read_barrel(TomlTable& table);

}  // namespace lensproof::formats
