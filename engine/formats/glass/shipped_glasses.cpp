#include "engine/formats/glass/shipped_glasses.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <mutex>
#include <utility>

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

/// The rows of a table of internal transmittances, by glass and catalogue.
struct TransmittanceTable {
    std::vector<std::string> columns;
    std::map<std::pair<std::string, std::string>, CsvRow> rows;
};

TransmittanceTable read_transmittances(const std::filesystem::path& file) {
    CsvTable table = CsvTable::read(file);
    TransmittanceTable found{.columns = table.header(), .rows = {}};
    while (std::optional<CsvRow> row = table.next()) {
        std::pair glass(row->text("glass"), row->text("catalogue"));
        found.rows.emplace(std::move(glass), *std::move(row));
    }
    return found;
}

/// One that ships, read when it is asked for first; one that there is not is empty.
const TransmittanceTable& transmittances(const std::filesystem::path& file) {
    static std::mutex mutex;
    static std::map<std::filesystem::path, TransmittanceTable> tables;
    const std::scoped_lock lock(mutex);
    auto table = tables.find(file);
    if (table == tables.end()) {
        table = tables.emplace(file, std::filesystem::exists(file) ? read_transmittances(file) : TransmittanceTable())
                    .first;
    }
    return table->second;
}

std::vector<optics::TransmittancePoint> points_of(const CsvRow& row, const std::vector<std::string>& columns) {
    const double thickness_mm = row.number("thickness_mm", kPositive);
    std::vector<optics::TransmittancePoint> points;
    for (const std::string& column : columns) {
        const std::optional<double> wavelength_nm = parse_number(column);
        if (wavelength_nm && !row.is_empty(column)) {
            points.push_back({*wavelength_nm, row.number(column, {.min = 0.0, .max = 1.0}), thickness_mm});
        }
    }
    return points;
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
    for (const char* name : kTables) {
        const std::string maker = std::string(name).substr(0, std::string_view(name).find('-'));
        if (optics::same_letters(maker, glass.catalogue)) {
            const TransmittanceTable& table = transmittances(transmittance_file(name));
            if (const auto found = table.rows.find({glass.name, glass.catalogue}); found != table.rows.end()) {
                return points_of(found->second, table.columns);
            }
        }
    }
    return {};
}

}  // namespace lensproof::formats
