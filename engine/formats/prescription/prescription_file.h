// engine/formats/prescription/prescription_file.h — prescriptions read from and written to files of every form that is
// known.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/optics/prescription.h"

namespace lensproof::formats {

/// Reads a prescription, the form told by the file's extension: the project's TOML form (lenses/README.md), plain CSV,
/// Zemax .zmx, CODE V .seq, pbrt .dat, Optiland .json, rayoptics .roa, lensoptics .fx.
///
/// What the table states is taken as it is, physical or not; what the form says beyond that, and is not understood, is
/// named in `remarks`. Throws InputError, naming file and line, for what is no prescription at all: no table, no number
/// where one belongs, an unknown key.
optics::Prescription read_prescription(const std::filesystem::path& file);

/// Throws InputError where `write_prescription` could not write a file of that name: its extension, or the place.
void check_prescription_name(const std::filesystem::path& file);

/// Writes a prescription as .toml, .zmx, .dat (pbrt) or .csv, told by the extension; the file appears whole or not
/// at all. Files that it names, a glass catalogue or a stop's picture, are named from the new place. Returns what the
/// form cannot say: warnings where rays then take other paths. Throws InputError for an extension that cannot be
/// written.
std::vector<optics::Finding> write_prescription(const optics::Prescription& prescription,
                                                const std::filesystem::path& file);

/// The file of a LENS argument: a path, or the name of a lens that ships in lenses/. Throws InputError listing the
/// names.
std::filesystem::path find_lens_file(const std::string& lens);

/// That file, and those that it names: its own glass catalogues, its stop's picture.
std::vector<std::filesystem::path> files_of_lens(const std::string& lens);

/// Names of the lenses that ship, sorted.
std::vector<std::string> shipped_lens_names();

}  // namespace lensproof::formats
