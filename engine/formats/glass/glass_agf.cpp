// Zemax glass catalogues (.agf). The records are as the OpticStudio user guide describes them ("Glass catalog data file
// format"), and as the makers' own files have them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/base/text_encoding.h"
#include "engine/formats/glass/glass_file.h"

namespace lensproof::formats {

namespace {

// Makers' largest has 1.2 MB.
constexpr std::size_t kLargestCatalogue = std::size_t{8} << 20;

/// Coefficients as a CD record lists them; those that it leaves out are 0.
using Coefficients = std::array<double, 16>;

optics::Sellmeier sellmeier(const Coefficients& c, std::size_t terms) {
    optics::Sellmeier formula;
    for (std::size_t i = 0; i < 2 * terms; i += 2) {
        formula.terms.push_back({.b = c[i], .c = c[i + 1]});
    }
    return formula;
}

optics::SquaredPowerSeries power_series(const Coefficients& c, std::initializer_list<double> exponents) {
    optics::SquaredPowerSeries formula;
    for (const double exponent : exponents) {
        formula.terms.push_back({.coefficient = c[formula.terms.size()], .exponent = exponent});
    }
    return formula;
}

/// The formula by its number, or nothing.
std::optional<optics::DispersionFormula> formula_of(int number, const Coefficients& c) {
    switch (number) {
        case 1:  // Schott
            return optics::SchottPolynomial{{c[0], c[1], c[2], c[3], c[4], c[5]}};
        case 2:  // Sellmeier 1
            return sellmeier(c, 3);
        case 3:
            return optics::Herzberger{{c[0], c[1], c[2], c[3], c[4], c[5]}};
        case 4:  // Sellmeier 2: n² − 1 = A + B1 λ² / (λ² − λ1²) + B2 / (λ² − λ2²)
            return optics::ResonancesAndPowers{{{c[1], 2.0, c[2] * c[2]}, {c[3], 0.0, c[4] * c[4]}},
                                               {{1.0 + c[0], 0.0}}};
        case 5:  // Conrady
            return optics::PowerSeries{{{c[0], 0.0}, {c[1], -1.0}, {c[2], -3.5}}};
        case 6:  // Sellmeier 3
            return sellmeier(c, 4);
        case 7:  // Handbook of Optics 1: n² = A + B / (λ² − C) − D λ²
            return optics::ResonancesAndPowers{{{c[1], 0.0, c[2]}}, {{c[0], 0.0}, {-c[3], 2.0}}};
        case 8:  // Handbook of Optics 2: n² = A + B λ² / (λ² − C) − D λ²
            return optics::ResonancesAndPowers{{{c[1], 2.0, c[2]}}, {{c[0], 0.0}, {-c[3], 2.0}}};
        case 9:  // Sellmeier 4: n² = A + B λ² / (λ² − C) + D λ² / (λ² − E)
            return optics::ResonancesAndPowers{{{c[1], 2.0, c[2]}, {c[3], 2.0, c[4]}}, {{c[0], 0.0}}};
        case 10:  // Extended
            return power_series(c, {0, 2, -2, -4, -6, -8, -10, -12});
        case 11:  // Sellmeier 5
            return sellmeier(c, 5);
        case 12:  // Extended 2
            return power_series(c, {0, 2, -2, -4, -6, -8, 4, 6});
        case 13:  // Extended 3
            return power_series(c, {0, 2, 4, -2, -4, -6, -8, -10, -12});
        default:
            return std::nullopt;
    }
}

std::string status_name(double status) {
    constexpr std::array kNames = {"current", "current", "obsolete", "special", "current"};  // 1: preferred, 4: melt
    const auto known = static_cast<double>(kNames.size());
    return status >= 0.0 && status < known ? kNames[static_cast<std::size_t>(status)] : "";
}

/// One record: a keyword and what stands behind it, in this line and in those that run on.
struct Record {
    int line = 0;
    std::string_view keyword;
    std::vector<std::string_view> words;
};

class AgfReader {
  public:
    explicit AgfReader(const std::filesystem::path& file) : file_(file) {}

    GlassFile read(std::string_view text) {
        for (const Record& record : records(text)) {
            take(record);
        }
        finish_glass();
        if (!named_) {
            throw InputError(fmt::format("{}: holds no NM record, expected a Zemax glass catalogue", file_.string()));
        }
        return std::move(result_);
    }

  private:
    static std::vector<Record> records(std::string_view text) {
        std::vector<Record> records;
        int line = 0;
        for (const std::string_view content : lines_of(text)) {
            ++line;
            std::vector<std::string_view> words = words_of(content);
            if (words.empty() || words.front().starts_with('!')) {  // nothing, or a comment
                continue;
            }
            // NIKON's catalogue of 2018 breaks its lines at 80 columns.
            const bool runs_on = !records.empty() && is_numeric(records.back().keyword) && parse_number(words.front());
            if (runs_on) {
                Record& last = records.back();
                last.words.insert(last.words.end(), words.begin(), words.end());
                continue;
            }
            Record& record = records.emplace_back(Record{.line = line, .keyword = words.front()});
            record.words.assign(words.begin() + 1, words.end());
        }
        return records;
    }

    static bool is_numeric(std::string_view keyword) {
        return keyword == "CD" || keyword == "TD" || keyword == "LD" || keyword == "ED" || keyword == "OD";
    }

    [[nodiscard]] std::string where(const Record& record) const {
        return fmt::format("{}:{}", file_.string(), record.line);
    }

    [[nodiscard]] double number(const Record& record, std::size_t i, const char* what) const {
        const std::string_view word = i < record.words.size() ? record.words[i] : "";
        const std::optional<double> value = parse_number(word);
        if (!value || !std::isfinite(*value)) {
            throw InputError(fmt::format("{}: {} in {} is \"{}\", expected a finite number", where(record), what,
                                         printable(record.keyword), printable(word)));
        }
        return *value;
    }

    void note(const Record& record, const std::string& message) {
        constexpr std::size_t kMostNotes = 100;
        if (result_.notes.size() < kMostNotes) {
            result_.notes.push_back(fmt::format("{}: {}", where(record), message));
        }
    }

    void take(const Record& record) {
        const std::string_view keyword = record.keyword;
        if (keyword == "CC" || keyword == "ED" || keyword == "OD" || keyword == "MD" || keyword == "BD") {
            return;  // a comment; expansion and density; price and chemistry; mechanics; bubbles: none bears on rays
        }
        if (keyword == "NM") {
            finish_glass();
            begin_glass(record);
        } else if (keyword != "GC" && keyword != "CD" && keyword != "TD" && keyword != "LD" && keyword != "IT") {
            note(record,
                 fmt::format("{} is no record of a Zemax catalogue that is known: left out", printable(keyword)));
        } else if (!named_) {
            throw InputError(fmt::format("{}: {} stands before the first NM record", where(record), keyword));
        } else if (keyword == "GC") {
            for (const std::string_view word : record.words) {
                glass_.note += (glass_.note.empty() ? "" : " ") + printable(word);
            }
        } else if (keyword == "CD") {
            coefficients_ = {};
            for (std::size_t i = 0; i < std::min(record.words.size(), coefficients_.size()); ++i) {
                coefficients_[i] = number(record, i, "a coefficient");
            }
        } else if (keyword == "TD") {
            take_thermal(record);
        } else if (keyword == "LD") {
            glass_.min_wavelength_nm = 1e3 * number(record, 0, "the shortest wavelength");
            glass_.max_wavelength_nm = 1e3 * number(record, 1, "the longest wavelength");
        } else {
            take_transmittance(record);
        }
    }

    void begin_glass(const Record& record) {
        named_ = true;
        glass_ = {};
        coefficients_ = {};
        name_record_ = record;
        glass_.name = record.words.empty() ? "" : std::string(record.words[0]);
        glass_.catalogue = upper_case(file_.stem().string());
        glass_.source = file_.filename().string();
        formula_ = number(record, 1, "the formula");
        const double n_d = number(record, 3, "n_d");
        const double V_d = number(record, 4, "V_d");
        if (n_d > 1.0 && V_d > 0.0) {  // what has none says 1 and 0
            glass_.stated_n_d = n_d;
            glass_.stated_V_d = V_d;
        }
        const std::optional<double> status =
            record.words.size() > 6 ? parse_number(record.words[6]) : std::nullopt;  // "-" in some files
        glass_.status = status ? status_name(*status) : "";
    }

    void take_thermal(const Record& record) {
        std::array<double, 7> t{0, 0, 0, 0, 0, 0, 20.0};
        for (std::size_t i = 0; i < std::min(record.words.size(), t.size()); ++i) {
            t[i] = number(record, i, "a thermal coefficient");
        }
        if (std::any_of(t.begin(), t.begin() + 5, [](double value) { return value != 0.0; })) {
            glass_.thermal = {t[0], t[1], t[2], t[3], t[4], t[5], t[6]};
        }
    }

    void take_transmittance(const Record& record) {
        if (record.words.size() < 3) {
            return;  // makers leave lines with a wavelength alone
        }
        const optics::TransmittancePoint point{.wavelength_nm = 1e3 * number(record, 0, "the wavelength"),
                                               .transmittance = number(record, 1, "the transmittance"),
                                               .thickness_mm = number(record, 2, "the thickness")};
        if (point.wavelength_nm > 0.0 && point.transmittance >= 0.0 && point.transmittance <= 1.0 &&
            point.thickness_mm > 0.0) {
            glass_.internal_transmittance.push_back(point);
        } else {
            note(record,
                 "expected IT with a positive wavelength, a transmittance from 0 to 1 and a positive "
                 "thickness: left out");
        }
    }

    /// Of several thicknesses at one wavelength the thickest tells most.
    static void sort_transmittance(std::vector<optics::TransmittancePoint>& points) {
        std::ranges::stable_sort(points, [](const optics::TransmittancePoint& a, const optics::TransmittancePoint& b) {
            return a.wavelength_nm != b.wavelength_nm ? a.wavelength_nm < b.wavelength_nm
                                                      : a.thickness_mm > b.thickness_mm;
        });
        const auto same = [](const optics::TransmittancePoint& a, const optics::TransmittancePoint& b) {
            return a.wavelength_nm == b.wavelength_nm;
        };
        points.erase(std::unique(points.begin(), points.end(), same), points.end());
    }

    void finish_glass() {
        if (!named_) {
            return;
        }
        const bool whole = formula_ == std::floor(formula_) && formula_ >= 1.0 && formula_ <= 13.0;
        const std::optional<optics::DispersionFormula> formula =
            whole ? formula_of(static_cast<int>(formula_), coefficients_) : std::nullopt;
        std::string complaint = fmt::format("formula is {}, expected one from 1 to 13", formula_);
        if (formula) {
            glass_.formula = *formula;
            complaint = optics::complaint_about(glass_);
        }
        if (glass_.name.empty()) {
            complaint = "has no name";
        }
        if (!complaint.empty()) {
            note(name_record_, fmt::format("glass {}: {}: left out", printable(glass_.name), complaint));
            return;
        }
        sort_transmittance(glass_.internal_transmittance);
        result_.glasses.push_back(std::move(glass_));
    }

    const std::filesystem::path& file_;
    GlassFile result_;
    bool named_ = false;  // whether an NM record came
    Record name_record_;
    optics::Glass glass_;
    double formula_ = 0.0;
    Coefficients coefficients_{};
};

}  // namespace

GlassFile parse_agf(const std::string& bytes, const std::filesystem::path& name) {
    if (bytes.size() > kLargestCatalogue) {
        throw InputError(fmt::format("{}: has {} bytes, expected a catalogue of at most {}", name.string(),
                                     bytes.size(), kLargestCatalogue));
    }
    return AgfReader(name).read(to_utf8(bytes));
}

}  // namespace lensproof::formats
