// The lens tables of lensoptics (Schrade, Hanika, Dachsbacher, Sparse high-degree polynomials for wide-angle lenses,
// EGSR 2016) and of the lens collections that took the form up:
//
//     # comment, // comment, #EFL 70 135 200, #!scale .75
//     radius  thickness(/mid/long)  material  n_d V_d  semi-diameter   #!aspheric=k,A4,A6,A8,A10
//
// n_d and V_d are missing behind `air` and `iris`; iris is the stop, in the medium before it; `abbe` is a glass without
// a name; the prefix cx_ makes a cylinder curved in x–z. As in src/lenssystem.h and src/raytrace.h of
// github.com/hanatos/lensoptics (commits 26b783d, 17fc9f5) and its lenses/*.fx. Since radius 0 ends a table there,
// planes have a radius of 10000 or 100000.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/base/text_encoding.h"
#include "engine/formats/prescription/design_program.h"
#include "engine/formats/prescription/prescription_forms.h"

namespace lensproof::formats {

namespace {

constexpr std::size_t kMostPositions = 3;   // short, mid and long
constexpr std::size_t kMostRemarks = 1000;  // a file of nothing else says no more
constexpr std::string_view kScale = "#!scale";
constexpr std::string_view kAspheric = "#!aspheric=";

bool stands_for_flat(double radius) {
    return std::abs(radius) == 1e4 || std::abs(radius) == 1e5;
}

class FxTable {
  public:
    explicit FxTable(const std::filesystem::path& file) : lens_(prescription_of(file)) {}

    optics::Prescription read(std::string_view text) {
        const std::vector<std::string_view> lines = lines_of(without_byte_order_mark(text));
        const auto read_each = [&](auto read_one) {
            for (std::size_t i = 0; i < lines.size(); ++i) {
                where_ = fmt::format("{}:{}", lens_.file.string(), i + 1);
                read_one(trimmed(lines[i]));
            }
        };
        read_each([&](std::string_view line) { read_scale(line); });  // wherever it stands, it is the whole table's
        read_each([&](std::string_view line) { read_line(line); });
        if (lens_.surfaces.empty()) {
            throw InputError(fmt::format("{}: holds no row of radius, thickness and material", lens_.file.string()));
        }
        lens_.notes = fmt::format("{}", fmt::join(notes_, "\n"));
        set_zoom();
        set_focal_lengths();
        if (has_planes_) {
            remark("radius-for-flat", optics::Severity::info, 0,
                   "radii of 10000 and 100000 are read as flat, which the form has no other way to say");
        }
        return std::move(lens_);
    }

  private:
    void remark(const std::string& code, optics::Severity severity, int surface, const std::string& message) {
        if (lens_.remarks.size() == kMostRemarks) {
            return;
        }
        lens_.remarks.push_back({code, severity, surface, message});
    }

    [[noreturn]] void fail(std::string_view found, std::string_view expected) const {
        throw InputError(fmt::format("{}: found \"{}\", expected {}", where_, printable(found), expected));
    }

    [[nodiscard]] double number(std::string_view word, std::string_view expected) const {
        const std::optional<double> value = parse_number(word);
        if (!value) {
            fail(word, expected);
        }
        return *value;
    }

    void read_scale(std::string_view line) {
        if (!line.starts_with(kScale)) {
            return;
        }
        if (is_scaled_) {
            fail(line, "one #!scale");
        }
        scale_ = number(trimmed(line.substr(kScale.size())), "#!scale and a number");
        if (!std::isfinite(scale_) || scale_ <= 0.0) {
            fail(line, "#!scale and a positive number");
        }
        is_scaled_ = true;
        remark("scaled", optics::Severity::warning, 0,
               fmt::format("every length is multiplied by the file's #!scale, {}", scale_));
    }

    void read_line(std::string_view line) {
        if (line.starts_with(kScale)) {
            return;
        }
        if (line.starts_with('#') || line.starts_with("//")) {
            read_comment(line);
        } else if (!line.empty()) {
            read_row(line);
        }
    }

    void read_comment(std::string_view line) {
        if (line.starts_with("#EFL")) {
            for (const std::string_view word : words_of(line.substr(4, line.find("//") - 4))) {
                if (const std::optional<double> length = parse_number(word); length && std::isfinite(*length)) {
                    focal_lengths_.push_back(*length);
                }
            }
            return;
        }
        line = trimmed(line.substr(std::min(line.find_first_not_of("#/"), line.size())));
        if (line.starts_with("!")) {
            remark("line-not-read", optics::Severity::warning, 0,
                   fmt::format("a line that begins with \"{}\" is not understood",
                               printable(line.substr(0, line.find_first_of(" \t")))));
        } else if (!line.empty() && lens_.surfaces.empty() && !is_named_ && line.find(": ") == std::string::npos) {
            lens_.name = line;
            is_named_ = true;
        } else if (!line.empty()) {
            notes_.emplace_back(line);
        }
    }

    /// "8.78/26.15/32.85", of which several words are one where blanks stand about the strokes.
    std::vector<double> read_thicknesses(const std::vector<std::string_view>& words, std::size_t& next) {
        std::string joined;
        do {
            joined += words[next++];
        } while (next < words.size() && (joined.ends_with('/') || words[next].starts_with('/')));
        std::vector<double> values;
        for (std::size_t begin = 0; begin <= joined.size();) {
            const std::size_t end = std::min(joined.find('/', begin), joined.size());
            values.push_back(scale_ * number(joined.substr(begin, end - begin), "a thickness, or several as a/b/c"));
            begin = end + 1;
        }
        if (values.size() > kMostPositions) {
            fail(joined, "at most three thicknesses, short/mid/long");
        }
        return values;
    }

    void read_row(std::string_view line) {
        if (lens_.surfaces.size() == kMostSurfaces) {
            throw InputError(fmt::format("{}: more than {} surfaces", where_, kMostSurfaces));
        }
        const std::size_t body_end = std::min({line.find('#'), line.find("//"), line.size()});
        const std::vector<std::string_view> words = words_of(line.substr(0, body_end));
        if (words.size() < 4) {
            fail(line, "radius, thickness, material, n_d and V_d behind glass, semi-diameter");
        }
        const int surface_number = static_cast<int>(lens_.surfaces.size()) + 1;
        optics::PrescribedSurface surface;
        surface.where = fmt::format("{}: surface {}", where_, surface_number);
        const double radius = number(words[0], "a radius");
        surface.radius_mm = stands_for_flat(radius) ? kInfinity : scale_ * radius;
        has_planes_ = has_planes_ || stands_for_flat(radius);
        std::size_t next = 1;
        thicknesses_.push_back(read_thicknesses(words, next));
        surface.thickness_mm = thicknesses_.back().front();
        read_medium(words, next, surface);
        if (next >= words.size()) {
            fail(line, "a semi-diameter at its end");
        }
        surface.semi_diameter_mm = scale_ * number(words[next++], "a semi-diameter");
        if (next < words.size()) {
            remark("column-not-read", optics::Severity::warning, surface_number,
                   fmt::format("\"{}\" behind the semi-diameter is not understood", printable(words[next])));
        }
        read_aspheric(line, body_end, surface);
        lens_.surfaces.push_back(std::move(surface));
    }

    void read_medium(const std::vector<std::string_view>& words, std::size_t& next,
                     optics::PrescribedSurface& surface) const {
        if (next >= words.size()) {
            fail(words.back(), "a material behind the thickness: air, iris, abbe or a glass");
        }
        std::string_view material = words[next++];
        if (lower_case(material).starts_with("cx_")) {
            material.remove_prefix(3);
            surface.radius_x_mm = surface.radius_mm;
            surface.radius_mm = kInfinity;
        }
        const std::string kind = lower_case(material);
        if (kind == "air") {
            return;
        }
        if (kind == "iris") {
            surface.is_stop = true;
            surface.medium = lens_.surfaces.empty() ? optics::StatedMedium{} : lens_.surfaces.back().medium;
            return;
        }
        if (parse_number(material)) {
            fail(material, "a material: air, iris, abbe or a glass's name");
        }
        if (next + 1 >= words.size()) {
            fail(words.back(), "n_d and V_d behind the material");
        }
        surface.medium.glass = kind == "abbe" ? "" : std::string(material);
        surface.medium.n_d = number(words[next++], "n_d behind the material");
        surface.medium.V_d = number(words[next++], "V_d behind n_d");
    }

    void read_aspheric(std::string_view line, std::size_t body_end, optics::PrescribedSurface& surface) const {
        const std::size_t at = line.find(kAspheric, body_end);
        if (at == std::string_view::npos) {
            return;
        }
        std::string_view list = line.substr(at + kAspheric.size());
        list = list.substr(0, list.find_first_of("#/"));
        std::vector<double> values;
        while (!trimmed(list).empty() && values.size() <= optics::kAsphereTerms) {
            const std::string_view word = list.substr(0, list.find(','));
            values.push_back(number(trimmed(word), "k,A4,A6,A8,A10 behind #!aspheric="));
            list.remove_prefix(std::min(word.size() + 1, list.size()));
        }
        if (values.empty() || values.size() > optics::kAsphereTerms) {
            fail(line, "k,A4,A6,A8,A10 behind #!aspheric=");
        }
        surface.conic = values[0];
        for (std::size_t term = 1; term < values.size(); ++term) {
            // Lengths times s scale the coefficient of r^p by s^(1 − p).
            surface.asphere[term] = values[term] * std::pow(scale_, 1.0 - 2.0 * static_cast<double>(term + 1));
        }
    }

    void set_zoom() {
        std::size_t count = 1;
        for (const std::vector<double>& values : thicknesses_) {
            count = std::max(count, values.size());
        }
        for (std::size_t position = 0; count > 1 && position < count; ++position) {
            constexpr std::array<const char*, kMostPositions> kNames = {"short", "mid", "long"};
            optics::ZoomPosition zoom;
            zoom.name = position + 1 == count ? kNames.back() : kNames[position];
            for (std::size_t i = 0; i < thicknesses_.size(); ++i) {
                if (thicknesses_[i].size() > 1) {
                    zoom.gaps_mm[static_cast<int>(i) + 1] =
                        thicknesses_[i][std::min(position, thicknesses_[i].size() - 1)];
                }
            }
            lens_.zoom.push_back(std::move(zoom));
        }
        for (std::size_t i = 0; i < thicknesses_.size(); ++i) {
            if (thicknesses_[i].size() > 1 && thicknesses_[i].size() < count) {
                remark("zoom-gap-missing", optics::Severity::warning, static_cast<int>(i) + 1,
                       fmt::format("{} thicknesses where other surfaces have {}: the last one is repeated",
                                   thicknesses_[i].size(), count));
            }
        }
    }

    void set_focal_lengths() {
        if (focal_lengths_.size() == 1 && lens_.zoom.empty()) {
            lens_.stated.efl_mm = scale_ * focal_lengths_.front();
        } else if (focal_lengths_.size() == lens_.zoom.size()) {
            for (std::size_t i = 0; i < lens_.zoom.size(); ++i) {
                lens_.zoom[i].stated.efl_mm = scale_ * focal_lengths_[i];
            }
        } else if (!focal_lengths_.empty()) {
            remark("line-not-read", optics::Severity::warning, 0,
                   fmt::format("#EFL has {} focal lengths for {} zoom positions", focal_lengths_.size(),
                               std::max<std::size_t>(1, lens_.zoom.size())));
        }
    }

    optics::Prescription lens_;
    std::vector<std::vector<double>> thicknesses_;  // of every surface, by zoom position
    std::vector<double> focal_lengths_;             // as #EFL lists them
    std::vector<std::string> notes_;
    std::string where_;
    double scale_ = 1.0;
    bool is_scaled_ = false;
    bool is_named_ = false;
    bool has_planes_ = false;
};

}  // namespace

optics::Prescription parse_fx(const std::string& text, const std::filesystem::path& file) {
    return FxTable(file).read(to_utf8(text));
}

}  // namespace lensproof::formats
