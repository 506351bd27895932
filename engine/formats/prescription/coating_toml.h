// engine/formats/prescription/coating_toml.h — coatings as the project's own form states them (lenses/README.md).
#pragma once
#include <string>
#include <vector>

#include "engine/base/toml.h"
#include "engine/optics/prescription.h"

namespace lensproof::formats {

/// Pairs [wavelength in nm, value], by rising wavelength. Throws InputError as `TomlTable` does.
std::vector<optics::WavelengthValue> read_wavelength_values(TomlTable& table, const std::string& key,
                                                            const Bounds& values);

/// A table [coatings.NAME]: `layers` and `from_air`, or `reflectance`, and nothing else that was not read before.
optics::Coating read_coating(TomlTable& table);

}  // namespace lensproof::formats
