#include "engine/formats/prescription/shipped_coatings.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "engine/base/data_root.h"
#include "engine/base/input_error.h"
#include "engine/base/nearest_name.h"
#include "engine/base/text.h"
#include "engine/base/toml.h"
#include "engine/formats/prescription/coating_toml.h"

namespace lensproof::formats {

namespace {

constexpr const char* kBare = "none";

std::filesystem::path coating_folder() {
    return data_root() / "lenses" / "coatings";
}

/// Puts the coating of that name on a row; what lies on the lens already has precedence over what ships.
void coat(optics::Prescription& lens, optics::PrescribedSurface& row, const std::string& name) {
    if (name == kBare) {
        row.coating.clear();
        return;
    }
    if (!lens.coatings.contains(name)) {
        lens.coatings[name] = shipped_coating(name).coating;
    }
    row.coating = name;
}

void require_known(const optics::Prescription& lens, const std::string& name) {
    if (name != kBare && !lens.coatings.contains(name) && !is_shipped_coating(name)) {
        throw InputError(fmt::format("the coating \"{}\" is neither one of {} nor one that ships{}", printable(name),
                                     lens.file.string(), coating_hint(name, lens)));
    }
}

}  // namespace

NamedCoating read_coating_file(const std::filesystem::path& file) {
    TomlTable table = TomlTable::read(file);
    NamedCoating read;
    read.id = file.stem().string();
    read.file = file;
    read.name = table.text("name");
    read.source = table.text("source");
    read.notes = table.text_or("notes", "");
    read.coating = read_coating(table);
    return read;
}

std::vector<std::string> shipped_coating_names() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(coating_folder())) {
        if (entry.path().extension() == ".toml") {
            names.push_back(entry.path().stem().string());
        }
    }
    std::ranges::sort(names);
    return names;
}

bool is_shipped_coating(const std::string& name) {
    const std::vector<std::string> names = shipped_coating_names();
    return std::ranges::find(names, name) != names.end();
}

NamedCoating shipped_coating(const std::string& name) {
    return read_coating_file(coating_folder() / (name + ".toml"));
}

std::string coating_hint(const std::string& name, const optics::Prescription& lens) {
    std::vector<std::string> known = shipped_coating_names();
    for (const auto& [own, coating] : lens.coatings) {
        known.push_back(own);
    }
    return name_hint(name, known);
}

optics::Prescription with_coatings(optics::Prescription lens, const std::vector<std::string>& wishes) {
    const auto is_air = [&](std::size_t i) { return i >= lens.surfaces.size() || lens.surfaces[i].medium.is_air(); };
    for (const std::string& wish : wishes) {
        std::istringstream parts(wish + ',');  // an empty one is a name too, which nothing has
        for (std::string part; std::getline(parts, part, ',');) {
            const std::size_t equals = part.find('=');
            const std::string name = equals == std::string::npos ? part : part.substr(equals + 1);
            require_known(lens, name);
            if (equals != std::string::npos) {
                const int surface = parse_exact<int>(part.substr(0, equals)).value_or(0);
                if (surface < 1 || surface > static_cast<int>(lens.surfaces.size())) {
                    throw InputError(
                        fmt::format("the coating \"{}\" is for no surface of {}, expected one from 1 to {}",
                                    printable(part), lens.file.string(), lens.surfaces.size()));
                }
                coat(lens, lens.surfaces[surface - 1], name);
                continue;
            }
            for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
                const bool air_before = i == 0 || is_air(i - 1);
                if (name == kBare || air_before != is_air(i)) {
                    coat(lens, lens.surfaces[i], name);
                }
            }
        }
    }
    return lens;
}

}  // namespace lensproof::formats
