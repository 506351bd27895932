// Pages of the refractiveindex.info database. Formulas as its "Dispersion formulas" sheet numbers them.
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/base/text_encoding.h"
#include "engine/formats/glass/glass_file.h"

namespace lensproof::formats {

namespace {

// The database's largest page has 0.8 MB; the YAML library needs up to 150 times a text's size.
constexpr std::size_t kLargestPage = std::size_t{2} << 20;

class RiiPage {
  public:
    RiiPage(const std::filesystem::path& file, const YAML::Node& root) : file_(file), root_(root) {}

    [[noreturn]] void fail(const YAML::Node& node, const std::string& message) const {
        const int line = node.IsDefined() ? node.Mark().line + 1 : 1;
        throw InputError(fmt::format("{}:{}: {}", file_.string(), std::max(1, line), message));
    }

    [[nodiscard]] static std::string text(const YAML::Node& node) {
        return node.IsDefined() && node.IsScalar() ? std::string(trimmed(node.Scalar())) : "";
    }

    [[nodiscard]] std::vector<double> numbers(const YAML::Node& node, const char* what) const {
        const std::string content = text(node);
        std::vector<double> numbers;
        for (const std::string_view word : words_of(content)) {
            const std::optional<double> number = parse_number(word);
            if (!number || !std::isfinite(*number)) {
                fail(node, fmt::format("{} is \"{}\", expected finite numbers", what, printable(word)));
            }
            numbers.push_back(*number);
        }
        return numbers;
    }

    /// The table's columns: wavelength in µm, sorted, and `columns` − 1 numbers beside.
    [[nodiscard]] std::vector<std::vector<double>> table(const YAML::Node& node, std::size_t columns,
                                                         std::vector<std::string>& notes) const {
        const std::vector<double> all = numbers(node, "data");
        if (all.empty() || all.size() % columns != 0) {
            fail(node, fmt::format("data holds {} numbers, expected rows of {}", all.size(), columns));
        }
        std::vector<std::size_t> order(all.size() / columns);  // some pages have a row out of its place
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, {}, [&](std::size_t row) { return all[row * columns]; });
        std::vector<std::vector<double>> table(columns);
        for (const std::size_t row : order) {
            const double wavelength = all[row * columns];
            if (wavelength <= 0.0) {
                fail(node, fmt::format("a wavelength is {}, expected a positive number", wavelength));
            }
            if (!table[0].empty() && wavelength == table[0].back()) {
                notes.push_back(fmt::format("{}:{}: the wavelength {} stands there twice: the first holds",
                                            file_.string(), node.Mark().line + 1, wavelength));
                continue;
            }
            for (std::size_t column = 0; column < columns; ++column) {
                table[column].push_back(all[row * columns + column]);
            }
        }
        return table;
    }

    GlassFile read();

  private:
    [[nodiscard]] optics::DispersionFormula formula(int number, const YAML::Node& node) const;
    void take_data(const YAML::Node& data, optics::Glass& glass, bool& has_index,
                   std::vector<std::string>& notes) const;
    void take_specs(const YAML::Node& specs, optics::Glass& glass) const;
    static void take_absorption(const std::vector<double>& um, const std::vector<double>& k, optics::Glass& glass);

    const std::filesystem::path& file_;
    const YAML::Node& root_;
};

/// The n-th coefficient from 1, as the database counts them; those that are left out are 0.
class Counted {
  public:
    explicit Counted(std::vector<double> values) : values_(std::move(values)) {}
    double operator()(std::size_t n) const { return n <= values_.size() ? values_[n - 1] : 0.0; }
    [[nodiscard]] std::size_t size() const { return values_.size(); }

  private:
    std::vector<double> values_;
};

/// c(first) λ^c(first + 1) + …
std::vector<optics::PowerTerm> powers_from(const Counted& c, std::size_t first) {
    std::vector<optics::PowerTerm> terms;
    for (std::size_t i = first; i <= c.size(); i += 2) {
        terms.push_back({.coefficient = c(i), .exponent = c(i + 1)});
    }
    return terms;
}

std::vector<optics::Sellmeier::Term> pairs_from(const Counted& c, bool square_second) {
    std::vector<optics::Sellmeier::Term> terms;
    for (std::size_t i = 2; i <= c.size(); i += 2) {
        terms.push_back({.b = c(i), .c = square_second ? c(i + 1) * c(i + 1) : c(i + 1)});
    }
    return terms;
}

optics::DispersionFormula RiiPage::formula(int number, const YAML::Node& node) const {
    const Counted c(numbers(node, "coefficients"));
    constexpr std::size_t kMostCoefficients = 64;
    if (c.size() < 1 || c.size() > kMostCoefficients) {
        fail(node, fmt::format("{} coefficients, expected 1 to {}", c.size(), kMostCoefficients));
    }
    switch (number) {
        case 1:  // n² − 1 = c1 + Σ c2 λ² / (λ² − c3²)
            return optics::Sellmeier{pairs_from(c, true), c(1)};
        case 2:  // the same with c3 for c3²
            return optics::Sellmeier{pairs_from(c, false), c(1)};
        case 3: {  // n² = c1 + Σ c2 λ^c3
            optics::SquaredPowerSeries series{powers_from(c, 2)};
            series.terms.insert(series.terms.begin(), optics::PowerTerm{c(1), 0.0});
            return series;
        }
        case 4: {  // n² = c1 + c2 λ^c3 / (λ² − c4^c5) + c6 λ^c7 / (λ² − c8^c9) + Σ c10 λ^c11
            optics::ResonancesAndPowers sum{{}, powers_from(c, 10)};
            for (const std::size_t i : {2, 6}) {
                if (c(i) != 0.0) {
                    sum.resonances.push_back({c(i), c(i + 1), std::pow(c(i + 2), c(i + 3))});
                }
            }
            sum.powers.insert(sum.powers.begin(), optics::PowerTerm{c(1), 0.0});
            return sum;
        }
        case 5: {  // n = c1 + Σ c2 λ^c3
            optics::PowerSeries series{powers_from(c, 2)};
            series.terms.insert(series.terms.begin(), optics::PowerTerm{c(1), 0.0});
            return series;
        }
        case 6:  // n − 1 = c1 + Σ c2 / (c3 − λ⁻²)
            return optics::GasDispersion{pairs_from(c, false), c(1)};
        case 7:  // n = c1 + c2 / (λ² − 0.028) + c3 / (λ² − 0.028)² + c4 λ² + c5 λ⁴ + c6 λ⁶
            return optics::Herzberger{{c(1), c(2), c(3), c(4), c(5), c(6)}};
        case 8:
            return optics::RetroDispersion{{c(1), c(2), c(3), c(4)}};
        default:
            return optics::ExoticDispersion{{c(1), c(2), c(3), c(4), c(5), c(6)}};
    }
}

void RiiPage::take_absorption(const std::vector<double>& um, const std::vector<double>& k, optics::Glass& glass) {
    constexpr double kThickness = 10.0;
    for (std::size_t i = 0; i < um.size(); ++i) {
        const double exponent = 4.0 * std::numbers::pi * k[i] * 1e3 * kThickness / um[i];
        if (exponent >= 0.0) {
            glass.internal_transmittance.push_back({1e3 * um[i], std::exp(-exponent), kThickness});
        }
    }
}

void RiiPage::take_data(const YAML::Node& data, optics::Glass& glass, bool& has_index,
                        std::vector<std::string>& notes) const {
    if (!data.IsMap()) {
        fail(data, "an entry of DATA is no map, expected type, coefficients or data");
    }
    const std::string type = text(data["type"]);
    const std::vector<std::string_view> words = words_of(type);
    const bool is_formula = words.size() == 2 && words[0] == "formula";
    const bool is_table = words.size() == 2 && words[0] == "tabulated";
    if (is_formula && words[1].size() == 1 && words[1][0] >= '1' && words[1][0] <= '9' && !has_index) {
        glass.formula = formula(words[1][0] - '0', data["coefficients"]);
        const std::vector<double> range = numbers(data["wavelength_range"], "wavelength_range");
        if (range.size() != 2) {
            fail(data, "wavelength_range is missing, expected two wavelengths in µm");
        }
        glass.min_wavelength_nm = 1e3 * range[0];
        glass.max_wavelength_nm = 1e3 * range[1];
        has_index = true;
    } else if (is_table && (words[1] == "n" || words[1] == "nk") && !has_index) {
        const auto columns = table(data["data"], words[1] == "n" ? 2 : 3, notes);
        if (columns[0].size() < 2) {
            fail(data, "data holds one row, expected two or more");
        }
        glass.formula = optics::IndexTable{columns[0], columns[1]};
        glass.min_wavelength_nm = 1e3 * columns[0].front();
        glass.max_wavelength_nm = 1e3 * columns[0].back();
        if (columns.size() == 3) {
            take_absorption(columns[0], columns[2], glass);
        }
        has_index = true;
    } else if (is_table && words[1] == "k" && glass.internal_transmittance.empty()) {
        const auto columns = table(data["data"], 2, notes);
        take_absorption(columns[0], columns[1], glass);
    } else {
        notes.push_back(fmt::format("{}:{}: DATA of type \"{}\" is left out", file_.string(), data.Mark().line + 1,
                                    printable(type)));
    }
}

void RiiPage::take_specs(const YAML::Node& specs, optics::Glass& glass) const {
    const auto number = [&](const char* key) { return parse_number(text(specs[key])); };
    glass.stated_n_d = number("nd");
    glass.stated_V_d = number("Vd");
    const std::string status = text(specs["glass_status"]);
    glass.status = status == "standard" || status == "preferred" ? "current" : printable(status);
    for (const char* against : {"n_is_absolute", "wavelength_is_vacuum"}) {
        if (text(specs[against]) == "true") {
            throw InputError(
                fmt::format("{}:{}: {} is true; expected indices relative to air at wavelengths in air, "
                            "as glass catalogues give them",
                            file_.string(), specs.Mark().line + 1, against));
        }
    }
    const YAML::Node thermal = specs["thermal_dispersion"];
    if (thermal.IsDefined() && thermal.IsSequence() && thermal.size() > 0 && thermal[0].IsMap()) {
        const YAML::Node coefficients = thermal[0]["coefficients"];
        const std::vector<double> t = numbers(coefficients, "thermal_dispersion");
        if (t.size() == 6 && text(thermal[0]["type"]) == "Schott formula") {
            glass.thermal = {t[0], t[1], t[2], t[3], t[4], t[5]};
            const std::string temperature = text(specs["temperature"]);  // "20.0 °C"
            const std::vector<std::string_view> words = words_of(temperature);
            if (!words.empty()) {
                glass.thermal->reference_C = parse_number(words[0]).value_or(20.0);
            }
        }
    }
}

/// `html` without its tags.
std::string without_tags(const std::string& html) {
    std::string text;
    bool inside = false;
    for (const char letter : html) {
        inside = letter == '<' || (inside && letter != '>');
        if (!inside && letter != '>') {
            text += letter == '\n' ? ' ' : letter;
        }
    }
    return text;
}

GlassFile RiiPage::read() {
    if (!root_.IsMap() || !root_["DATA"].IsDefined() || !root_["DATA"].IsSequence()) {
        throw InputError(
            fmt::format("{}: holds no list DATA, expected a page of refractiveindex.info", file_.string()));
    }
    GlassFile result;
    optics::Glass glass;
    glass.name = file_.stem().string();
    glass.catalogue = "refractiveindex.info";
    glass.source = without_tags(text(root_["REFERENCES"]));
    glass.note = without_tags(text(root_["COMMENTS"]));
    bool has_index = false;
    for (const YAML::Node& data : root_["DATA"]) {
        take_data(data, glass, has_index, result.notes);
    }
    if (!has_index) {
        fail(root_["DATA"], "holds no refractive index, expected a formula or a table of n");
    }
    // SPECS was called CONDITIONS and PROPERTIES before 2023.
    for (const char* key : {"SPECS", "PROPERTIES"}) {
        if (root_[key].IsDefined() && root_[key].IsMap()) {
            take_specs(root_[key], glass);
        }
    }
    if (const std::string complaint = optics::complaint_about(glass); !complaint.empty()) {
        fail(root_["DATA"], complaint);
    }
    result.glasses.push_back(std::move(glass));
    return result;
}

}  // namespace

GlassFile parse_rii(const std::string& text, const std::filesystem::path& name) {
    if (text.size() > kLargestPage) {
        throw InputError(
            fmt::format("{}: has {} bytes, expected a page of at most {}", name.string(), text.size(), kLargestPage));
    }
    try {
        const YAML::Node root = YAML::Load(to_utf8(text));
        return RiiPage(name, root).read();
    } catch (const YAML::Exception& error) {
        throw InputError(
            fmt::format("{}:{}: not YAML: {}", name.string(), std::max(1, error.mark.line + 1), printable(error.msg)));
    }
}

}  // namespace lensproof::formats
