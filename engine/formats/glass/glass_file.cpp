// Glasses in the project's own form, and which reader a file needs.
#include "engine/formats/glass/glass_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "engine/base/csv.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"

namespace lensproof::formats {

namespace {

std::vector<double> numbers_in(const CsvRow& row, const char* column, std::string_view expected) {
    const std::string cell = row.text(column);
    std::vector<double> numbers;
    for (const std::string_view word : words_of(cell)) {
        const std::optional<double> number = parse_number(word);
        if (!number || !kAnyNumber.hold(*number)) {
            row.fail(column, expected);
        }
        numbers.push_back(*number);
    }
    return numbers;
}

std::vector<optics::PowerTerm> power_terms(const std::vector<double>& c) {
    std::vector<optics::PowerTerm> terms;
    for (std::size_t i = 0; i + 1 < c.size(); i += 2) {
        terms.push_back({.coefficient = c[i], .exponent = c[i + 1]});
    }
    return terms;
}

optics::DispersionFormula read_formula(const CsvRow& row) {
    const std::vector<double> c = numbers_in(row, "coefficients", "numbers with blanks between them");
    const std::string formula = row.text("formula");
    const auto expect = [&](bool good, const char* expected) {
        if (!good) {
            row.fail("coefficients", expected);
        }
    };
    const bool pairs = !c.empty() && c.size() % 2 == 0;
    if (formula == "sellmeier") {
        expect(pairs, "pairs B C, C in µm²");
        optics::Sellmeier sellmeier;
        for (std::size_t i = 0; i < c.size(); i += 2) {
            sellmeier.terms.push_back({.b = c[i], .c = c[i + 1]});
        }
        return sellmeier;
    }
    if (formula == "schott") {
        expect(c.size() == 6, "the six numbers A0 to A5");
        optics::SchottPolynomial polynomial;
        std::ranges::copy(c, polynomial.a.begin());
        return polynomial;
    }
    if (formula == "herzberger") {
        expect(c.size() == 6, "the six numbers A to F");
        optics::Herzberger herzberger;
        std::ranges::copy(c, herzberger.a.begin());
        return herzberger;
    }
    if (formula == "power-series") {
        expect(pairs, "pairs of a coefficient and an exponent");
        return optics::SquaredPowerSeries{power_terms(c)};
    }
    if (formula == "cauchy") {
        expect(pairs, "pairs of a coefficient and an exponent");
        return optics::PowerSeries{power_terms(c)};
    }
    if (formula == "constant") {
        expect(c.size() == 1, "one index");
        return optics::ConstantIndex{c[0]};
    }
    if (formula == "table") {
        optics::IndexTable table;
        for (std::size_t i = 0; i + 1 < c.size(); i += 2) {
            expect(i == 0 || c[i] > c[i - 2], "wavelengths that ascend");
            table.wavelength_um.push_back(1e-3 * c[i]);
            table.index.push_back(c[i + 1]);
        }
        expect(pairs && c.size() >= 4, "two or more pairs of a wavelength in nm and an index");
        return table;
    }
    row.fail("formula", "one of sellmeier, schott, power-series, cauchy, constant, table");
}

std::optional<optics::ThermalDispersion> read_thermal(const CsvRow& row) {
    const std::vector<double> t = numbers_in(row, "thermal", "the six numbers D0 D1 D2 E0 E1 λ_tk");
    if (t.empty()) {
        return std::nullopt;
    }
    if (t.size() != 6) {
        row.fail("thermal", "the six numbers D0 D1 D2 E0 E1 λ_tk");
    }
    return optics::ThermalDispersion{.d0 = t[0], .d1 = t[1], .d2 = t[2], .e0 = t[3], .e1 = t[4], .lambda_tk_um = t[5]};
}

}  // namespace

GlassFile parse_glass_table(std::string text, const std::filesystem::path& name) {
    CsvTable table = CsvTable::parse(std::move(text), name);
    table.expect_columns({"glass", "formula", "coefficients", "min_nm", "max_nm"},
                         {"catalogue", "n_d", "V_d", "status", "temperature_C", "thermal", "source", "note"});
    const auto has = [&](const char* column) { return table.has(column); };
    const auto text_or = [&](const CsvRow& row, const char* column, const std::string& fallback) {
        return has(column) && !row.is_empty(column) ? row.text(column) : fallback;
    };
    GlassFile file;
    std::set<std::string> names;
    while (const std::optional<CsvRow> row = table.next()) {
        optics::Glass& glass = file.glasses.emplace_back();
        glass.name = row->text("glass");
        if (glass.name.empty() || !names.insert(glass.name).second) {
            row->fail("glass", glass.name.empty() ? "a name" : "a name that does not stand in the file twice");
        }
        glass.catalogue = text_or(*row, "catalogue", name.stem().string());
        glass.formula = read_formula(*row);
        glass.min_wavelength_nm = row->number("min_nm", kPositive);
        glass.max_wavelength_nm = row->number("max_nm", kPositive);
        glass.stated_n_d = has("n_d") ? row->optional_number("n_d", {.min = 1.0, .max = 4.0}) : std::nullopt;
        glass.stated_V_d = has("V_d") ? row->optional_number("V_d", kPositive) : std::nullopt;
        glass.status = text_or(*row, "status", "");
        glass.source = text_or(*row, "source", name.filename().string());
        glass.note = text_or(*row, "note", "");
        if (has("thermal")) {
            glass.thermal = read_thermal(*row);
        }
        if (glass.thermal && has("temperature_C")) {
            glass.thermal->reference_C = row->number("temperature_C", {.min = -273.15, .max = 1000.0});
        }
        if (const std::string complaint = optics::complaint_about(glass); !complaint.empty()) {
            row->fail("glass", fmt::format("a glass that can be computed: {}", complaint));
        }
    }
    return file;
}

GlassFile read_glass_file(const std::filesystem::path& file) {
    const std::string extension = lower_extension(file);
    if (extension == ".agf") {
        return parse_agf(read_file(file), file);
    }
    if (extension == ".yml" || extension == ".yaml") {
        return parse_rii(read_file(file), file);
    }
    if (extension == ".csv") {
        return parse_glass_table(read_file(file), file);
    }
    check_readable(file);
    throw InputError(fmt::format("{}: is \"{}\", expected a glass catalogue: .agf, .yml or .csv", file.string(),
                                 printable(extension)));
}

}  // namespace lensproof::formats
