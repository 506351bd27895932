// engine/formats/prescription/load_lens.h — a lens from its file and from the files that this one names.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/toml.h"
#include "engine/optics/lens.h"

namespace lensproof::formats {

/// What a lens is loaded with, beyond its file.
struct LensSettings {
    optics::IndexOverrides indices;
    std::string zoom;                               // the position's name or number; empty: the first
    std::vector<std::string> coatings{};            // in place of its own: see with_coatings
    std::optional<optics::GlassCatalogue> glasses;  // nothing: those that ship
};

/// `glasses` behind the prescription's own catalogues. Throws InputError for one that cannot be read.
optics::GlassCatalogue with_own_catalogues(optics::GlassCatalogue glasses, const optics::Prescription& prescription);

/// The mean of a picture's channels. Throws InputError as `read_image` does.
optics::ApertureTexture read_aperture_texture(const std::filesystem::path& file);

/// The prescription with the picture that its stop's shape names. Throws InputError where that cannot be read.
optics::Prescription with_stop_picture(optics::Prescription prescription);

/// The lens that a table names by the key `lens`: one that ships, or a file, relative to the table's own where there is
/// one, else to the working folder. Throws InputError where check_reference does.
std::string read_lens_name(TomlTable& table);

/// The same of a list of them, or of one by itself.
std::vector<std::string> read_lens_names(TomlTable& table);

/// The lens with the internal transmittance of its glasses that ship, which their catalogue leaves out; glass without
/// data takes nothing.
optics::Lens with_transmittance(optics::Lens lens);

/// find_lens_file, read_prescription, the zoom position, coatings, make_lens and with_transmittance.
optics::Lens load_lens(const std::string& lens, const LensSettings& settings = {});

}  // namespace lensproof::formats
