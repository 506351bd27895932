#include "engine/formats/glass/shipped_glasses.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "engine/base/csv.h"
#include "engine/base/data_root.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/formats/glass/glass_file.h"
#include "engine/optics/glass_name.h"

namespace lensproof::formats {

namespace {

// In the order in which names are looked up.
constexpr std::array kTables = {"schott", "schott-obsolete", "ohara",   "hoya",      "hikari",
                                "cdgm",   "sumita",          "moulded", "materials", "daimon"};

std::filesystem::path glass_folder() {
    return data_root() / "lenses" / "glass";
}

std::filesystem::path transmittance_file(const char* table) {
    return glass_folder() / "transmittance" / fmt::format("{}.csv", table);
}

optics::GlassCatalogue read_shipped_glasses() {
    std::vector<optics::Glass> glasses;
    for (const std::filesystem::path& file : shipped_glass_files()) {
        std::ranges::move(parse_glass_table(read_file(file), file).glasses, std::back_inserter(glasses));
    }
    optics::GlassCatalogue catalogue;
    catalogue.add(std::move(glasses));
    return catalogue;
}

}  // namespace

const optics::GlassCatalogue& shipped_glasses() {
    static const optics::GlassCatalogue glasses = read_shipped_glasses();
    return glasses;
}

std::vector<std::filesystem::path> shipped_glass_files() {
    std::vector<std::filesystem::path> files;
    files.reserve(kTables.size());
    for (const char* table : kTables) {
        files.push_back(glass_folder() / fmt::format("{}.csv", table));
    }
    return files;
}

std::vector<std::filesystem::path> shipped_transmittance_files() {
    std::vector<std::filesystem::path> files;
    for (const char* table : kTables) {
        std::filesystem::path file = transmittance_file(table);
        if (std::filesystem::exists(file)) {
            files.push_back(std::move(file));
        }
    }
    return files;
}

std::vector<optics::TransmittancePoint> shipped_transmittance(const optics::Glass& glass) {
    if (!glass.internal_transmittance.empty()) {
        return glass.internal_transmittance;
    }
    std::vector<optics::TransmittancePoint> points;
    for (const char* name : kTables) {
        const std::filesystem::path file = transmittance_file(name);
        const std::string maker = std::string(name).substr(0, std::string_view(name).find('-'));
        if (!optics::same_letters(maker, glass.catalogue) || !std::filesystem::exists(file)) {
            continue;
        }
        CsvTable table = CsvTable::read(file);
        while (const std::optional<CsvRow> row = table.next()) {
            if (row->text("glass") != glass.name || row->text("catalogue") != glass.catalogue) {
                continue;
            }
            const double thickness_mm = row->number("thickness_mm", kPositive);
            for (const std::string& column : table.header()) {
                const std::optional<double> wavelength_nm = parse_number(column);
                if (wavelength_nm && !row->is_empty(column)) {
                    points.push_back({*wavelength_nm, row->number(column, {.min = 0.0, .max = 1.0}), thickness_mm});
                }
            }
            return points;
        }
    }
    return points;
}

}  // namespace lensproof::formats
