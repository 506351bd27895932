// The keywords, from what Zemax writes into its files and OpticStudio's help says of the values (Lens Data Editor,
// Surface Properties, System Explorer, Multi-Configuration Editor).
#include "engine/io/zmx_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/io/input_error.h"
#include "engine/io/text.h"

namespace lensproof {

namespace {

constexpr int kMostSurfaces = 1000;
constexpr int kMostConfigurations = 100;
constexpr int kMostWavelengths = 1000;
constexpr int kMostParameters = 300;
constexpr std::size_t kMostOperands = 10000;

/// Keywords that bear on no ray: the program's version and settings, weights, names of its data files, drawing,
/// physical optics, polarization, tolerances, marks of what an optimizer may vary.
constexpr std::string_view kSilent[] = {"VERS", "PFIL", "LANG", "RAIM", "PUSH", "SDMA", "OMMA", "ROPD", "PICB", "HYPR",
                                        "DBDT", "AUTH", "FWGN", "FWGT", "WWGT", "WWGN", "POLS", "GLRS", "GSTD", "NSCD",
                                        "COFN", "MOFF", "COMM", "HIDE", "MIRR", "SLAB", "POPS", "VPAR", "VDSZ", "VCON",
                                        "VCUR", "TCMM", "TCED", "BLNK", "TOL",  "CONF", "SCOL", "SURO"};

/// Solves, whose outcome the file holds as the value itself.
constexpr std::string_view kSolves[] = {"PZUP", "PPAR", "PKUP", "MAZH", "EDGE", "TOLE", "TCOM"};

/// Apertures that are no circle about the vertex.
constexpr std::string_view kApertureShapes[] = {"SQAP", "ELAP", "OBSC", "SQOB", "ELOB", "SPID", "UDAD", "USAP", "UDOB"};

/// Vignetting factors: Zemax shrinks pupils by them where rims would cut the beams.
constexpr std::string_view kVignettingFactors[] = {"VDXN", "VDYN", "VCXN", "VCYN", "VANN"};

bool is_among(const auto& words, std::string_view word) {
    return std::ranges::find(words, word) != std::end(words);
}

/// Reads one file, line by line.
class ZmxReader {
  public:
    ZmxReader(const std::filesystem::path& file, Remarks& remarks) : path_(file), remarks_(remarks) {}

    ZmxFile read(std::string_view text) {
        while (!text.empty()) {
            const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
            ++line_;
            read_line(text.substr(0, end));
            const bool crlf = text.substr(end).starts_with("\r\n");
            text.remove_prefix(std::min(text.size(), end + (crlf ? 2 : 1)));
        }
        if (file_.surfaces.empty()) {
            throw InputError(fmt::format("{}: holds no SURF, expected a sequential Zemax file", path_.string()));
        }
        report_tail();
        return std::move(file_);
    }

  private:
    struct Keyword {
        std::string_view name;
        void (ZmxReader::*read)();
    };

    void read_line(std::string_view line) {
        const bool is_indented = !line.empty() && (line[0] == ' ' || line[0] == '\t');
        const std::string_view content = trimmed(line);
        const std::size_t end = std::min(content.find_first_of(" \t"), content.size());
        keyword_ = content.substr(0, end);
        rest_ = trimmed(content.substr(end));
        words_.clear();
        for (std::string_view left = rest_; !left.empty();) {
            const std::size_t length = std::min(left.find_first_of(" \t"), left.size());
            words_.push_back(left.substr(0, length));
            left = trimmed(left.substr(length));
        }
        if (keyword_.empty()) {
            return;
        }
        static constexpr Keyword kKeywords[] = {
            {"MODE", &ZmxReader::read_mode},          {"NAME", &ZmxReader::read_name},
            {"NOTE", &ZmxReader::read_note},          {"UNIT", &ZmxReader::read_unit},
            {"ENPD", &ZmxReader::read_aperture_type}, {"FNUM", &ZmxReader::read_aperture_type},
            {"OBNA", &ZmxReader::read_aperture_type}, {"FLOA", &ZmxReader::read_aperture_type},
            {"FTYP", &ZmxReader::read_field_type},    {"XFLN", &ZmxReader::read_fields},
            {"YFLN", &ZmxReader::read_fields},        {"XFLD", &ZmxReader::read_fields},
            {"YFLD", &ZmxReader::read_fields},        {"WAVM", &ZmxReader::read_wavelength},
            {"WAVL", &ZmxReader::read_wavelengths},   {"PWAV", &ZmxReader::read_reference},
            {"GCAT", &ZmxReader::read_catalogues},    {"ENVD", &ZmxReader::read_environment},
            {"GFAC", &ZmxReader::read_apodization},   {"MNUM", &ZmxReader::read_configurations},
            {"SURF", &ZmxReader::read_surface},       {"FIMP", &ZmxReader::read_import}};
        static constexpr Keyword kOfSurfaces[] = {
            {"TYPE", &ZmxReader::read_type},       {"CURV", &ZmxReader::read_curvature},
            {"CONI", &ZmxReader::read_conic},      {"DISZ", &ZmxReader::read_thickness},
            {"STOP", &ZmxReader::read_stop},       {"GLAS", &ZmxReader::read_glass},
            {"DIAM", &ZmxReader::read_diameter},   {"MEMA", &ZmxReader::read_mechanical},
            {"CLAP", &ZmxReader::read_aperture},   {"FLAP", &ZmxReader::read_aperture},
            {"OBDC", &ZmxReader::read_off_centre}, {"PARM", &ZmxReader::read_parameter},
            {"XDAT", &ZmxReader::read_extra},      {"COAT", &ZmxReader::read_coating}};
        const auto* known = std::ranges::find(kKeywords, keyword_, &Keyword::name);
        const auto* of_surface = std::ranges::find(kOfSurfaces, keyword_, &Keyword::name);
        if (known != std::end(kKeywords)) {
            (this->*known->read)();
        } else if (of_surface != std::end(kOfSurfaces) && !file_.surfaces.empty()) {
            (this->*of_surface->read)();
        } else if (is_among(kSilent, keyword_)) {
            return;
        } else if (is_among(kSolves, keyword_)) {
            report_solve();
        } else if (is_among(kApertureShapes, keyword_)) {
            remarks_.add_once(
                fmt::format("{} {}", keyword_, surface_number()), "aperture-shape", Severity::warning, surface_number(),
                fmt::format("line {}, surface {} of the file: the aperture {} is no full circle; the circle "
                            "of the semi-diameter is taken",
                            line_, surface_number(), keyword_));
        } else if (is_among(kVignettingFactors, keyword_)) {
            read_vignetting();
        } else if (!file_.surfaces.empty() && !is_indented) {
            read_tail();
        } else {
            remarks_.not_understood(std::string(keyword_), surface_number(), line_);
        }
    }

    [[nodiscard]] int surface_number() const { return std::max(0, static_cast<int>(file_.surfaces.size()) - 1); }
    ZmxSurface& surface() { return file_.surfaces.back(); }

    [[noreturn]] void fail(std::string_view found, std::string_view expected) const {
        throw InputError(fmt::format("{}:{}: {}{} is \"{}\", expected {}", path_.string(), line_,
                                     file_.surfaces.empty() ? "" : fmt::format("SURF {}: ", surface_number()),
                                     printable(keyword_), printable(found), expected));
    }

    double number(std::size_t word, std::string_view expected) const {
        const std::string_view text = word < words_.size() ? words_[word] : std::string_view();
        const std::optional<double> value = parse_number(text);
        if (!value) {
            fail(text, expected);
        }
        return *value;
    }

    double number_or_zero(std::size_t word) const {
        return word < words_.size() ? parse_number(words_[word]).value_or(0.0) : 0.0;
    }

    int integer(std::size_t word, int min, int max, std::string_view expected) const {
        const double value = number(word, expected);
        if (!(value >= min && value <= max) || value != std::floor(value)) {
            fail(words_[word], fmt::format("{} from {} to {}", expected, min, max));
        }
        return static_cast<int>(value);
    }

    void read_mode() {
        if (!rest_.starts_with("SEQ")) {
            fail(rest_, "SEQ: only sequential systems are lenses");
        }
    }

    void read_name() { file_.name = std::string(rest_); }

    void read_note() {
        std::string_view text = rest_;
        if (!words_.empty() && parse_number(words_[0])) {
            text = trimmed(text.substr(words_[0].size()));
        }
        if (!text.empty()) {
            file_.notes.push_back(std::string(text));
        }
    }

    void read_unit() {
        struct Unit {
            std::string_view name;
            double mm;
        };
        static constexpr Unit kUnits[] = {{"MM", 1.0},    {"CM", 10.0},      {"IN", 25.4},
                                          {"INCH", 25.4}, {"INCHES", 25.4},  {"M", 1000.0},
                                          {"ME", 1000.0}, {"METER", 1000.0}, {"METERS", 1000.0}};
        const std::string_view name = words_.empty() ? std::string_view() : words_[0];
        const auto* unit = std::ranges::find(kUnits, name, &Unit::name);
        if (unit == std::end(kUnits)) {
            fail(name, "MM, CM, IN or M");
        }
        file_.unit_mm = unit->mm;
        if (unit->mm != 1.0) {
            remarks_.add_once(fmt::format("{} {}", keyword_, surface_number()), "units", Severity::info, 0,
                              fmt::format("line {}: lengths are in {} and taken times {} mm", line_, name, unit->mm));
        }
    }

    void read_aperture_type() {
        file_.aperture_type = std::string(keyword_);
        file_.aperture_value = keyword_ == "FLOA" ? 0.0 : number(0, "the aperture's value");
        file_.is_working_f_number = keyword_ == "FNUM" && number_or_zero(1) != 0.0;
    }

    void read_field_type() {
        file_.field_type = static_cast<int>(std::clamp(number(0, "a kind of field"), -1.0, 100.0));
        file_.fields = static_cast<int>(std::clamp(number_or_zero(2), 0.0, 1e6));
        file_.wavelengths = static_cast<int>(std::clamp(number_or_zero(3), 0.0, 1e6));
    }

    void read_fields() {
        std::vector<double>& values = keyword_[0] == 'X' ? file_.field_x : file_.field_y;
        values.clear();
        for (std::size_t i = 0; i < words_.size(); ++i) {
            values.push_back(number(i, "fields"));
        }
    }

    void read_wavelength() {
        const int index = integer(0, 1, kMostWavelengths, "a wavelength's number");
        file_.wavelengths_um[index] = number(1, "a wavelength in micrometres");
    }

    void read_wavelengths() {
        for (std::size_t i = 0; i < words_.size() && i < kMostWavelengths; ++i) {
            file_.wavelengths_um[static_cast<int>(i) + 1] = number(i, "wavelengths in micrometres");
        }
    }

    void read_reference() { file_.reference_wavelength = integer(0, 1, kMostWavelengths, "a wavelength's number"); }

    void read_catalogues() {
        for (const std::string_view word : words_) {
            file_.catalogues.push_back(std::string(word));
        }
    }

    void read_environment() {
        constexpr double kCatalogueTemperature = 20.0;
        constexpr double kCataloguePressure = 1.0;
        if (words_.size() >= 2 &&
            (number(0, "a temperature") != kCatalogueTemperature || number(1, "a pressure") != kCataloguePressure)) {
            remarks_.add_once(
                fmt::format("{} {}", keyword_, surface_number()), "environment", Severity::warning, 0,
                fmt::format("line {}: the lens is meant for {} °C and {} atm; indices and lengths are taken "
                            "at 20 °C and 1 atm",
                            line_, printable(words_[0]), printable(words_[1])));
        }
    }

    void read_apodization() {
        if (number_or_zero(0) != 0.0) {
            remarks_.not_understood("GFAC", 0, line_, "the pupil's apodization");
        }
    }

    void read_import() {
        if (!rest_.empty()) {
            remarks_.not_understood("FIMP", surface_number(), line_, "data from the file " + printable(rest_));
        }
    }

    void read_configurations() {
        file_.configurations = integer(0, 1, kMostConfigurations, "a number of configurations");
        in_configurations_ = !file_.surfaces.empty();
    }

    void read_surface() {
        for (const TailLine& passed : tail_) {
            remarks_.not_understood(passed.keyword, surface_number(), passed.line);
        }
        tail_.clear();
        tail_lines_ = 0;
        const double stated = number(0, "a surface's number");
        if (stated != static_cast<double>(file_.surfaces.size()) || file_.surfaces.size() >= kMostSurfaces) {
            throw InputError(
                fmt::format("{}:{}: SURF {}, expected surfaces in order, here SURF {}, and not more "
                            "than {}",
                            path_.string(), line_, printable(words_[0]), file_.surfaces.size(), kMostSurfaces));
        }
        file_.surfaces.push_back({.line = line_});
    }

    void read_type() { surface().type = std::string(words_.empty() ? std::string_view("STANDARD") : words_[0]); }

    void read_curvature() {
        surface().curvature = number(0, "a curvature");
        if (number_or_zero(1) > 1.0) {  // 0 fixed, 1 variable
            report_solve();
        }
    }

    void read_conic() { surface().conic = number(0, "a conic constant"); }
    void read_thickness() { surface().thickness = number(0, "a thickness"); }
    void read_stop() { surface().is_stop = true; }

    void read_glass() {
        ZmxSurface& here = surface();
        here.medium = {};
        const std::string name = std::string(words_.empty() ? std::string_view() : words_[0]);
        if (name.empty()) {
            fail("", "a glass");
        }
        here.is_mirror = name == "MIRROR";
        if (here.is_mirror) {
            return;
        }
        const double n_d = number_or_zero(3);
        const double V_d = number_or_zero(4);
        const bool is_model = name == "___BLANK";
        // What Zemax writes beside a catalogue's glass whose indices it did not set down.
        const bool says_nothing = !is_model && ((n_d == 1.5 && V_d == 40.0) || n_d == 0.0);
        if (!is_model) {
            here.medium.glass = name;
        }
        if (!says_nothing) {
            here.medium.n_d = is_model ? number(3, "a model glass's index") : n_d;
            if (V_d != 0.0) {
                here.medium.V_d = V_d;
            }
        }
        if (is_model && number_or_zero(5) != 0.0) {
            remarks_.add_once(
                fmt::format("{} {}", keyword_, surface_number()), "partial-dispersion", Severity::info,
                surface_number(),
                fmt::format("line {}: the model glass's deviation from the normal line, ΔP_gF = {}, is left "
                            "out",
                            line_, words_[5]));
        }
    }

    void read_diameter() {
        const double semi_diameter = number(0, "a semi-diameter");
        if (semi_diameter != 0.0) {
            surface().semi_diameter = semi_diameter;
            surface().semi_diameter_is_fixed = number_or_zero(1) != 0.0;
        }
    }

    void read_mechanical() {
        const double semi_diameter = number(0, "a mechanical semi-diameter");
        if (semi_diameter != 0.0) {
            surface().mechanical = semi_diameter;
        }
    }

    void read_aperture() {
        const double inner = number(0, "an aperture's inner radius");
        const double outer = number(1, "an aperture's outer radius");
        if (outer != 0.0) {
            surface().aperture = outer;
        }
        if (inner != 0.0) {
            remarks_.add_once(
                fmt::format("{} {}", keyword_, surface_number()), "aperture-shape", Severity::warning, surface_number(),
                fmt::format("line {}, surface {} of the file: the aperture's central obstruction of radius "
                            "{} is left out",
                            line_, surface_number(), inner));
        }
    }

    void read_off_centre() {
        if (number_or_zero(0) != 0.0 || number_or_zero(1) != 0.0) {
            remarks_.add_once(
                fmt::format("{} {}", keyword_, surface_number()), "aperture-shape", Severity::warning, surface_number(),
                fmt::format("line {}, surface {} of the file: the aperture is off the vertex, and taken about "
                            "it",
                            line_, surface_number()));
        }
    }

    void read_parameter() {
        surface().parameters[integer(0, 0, kMostParameters, "a parameter's number")] = number(1, "a parameter");
    }

    void read_extra() {
        surface().extra[integer(0, 0, kMostParameters, "an extra value's number")] = number(1, "an extra value");
    }

    void read_coating() {
        remarks_.add_once(fmt::format("{} {}", keyword_, surface_number()), "coating", Severity::info, surface_number(),
                          fmt::format("line {}: the coating {} is named only; the surface is taken as bare", line_,
                                      printable(rest_)));
    }

    void read_vignetting() {
        for (std::size_t i = 0; i < words_.size(); ++i) {
            if (number_or_zero(i) != 0.0) {
                remarks_.add_once(
                    "", "vignetting-factors", Severity::info, 0,
                    fmt::format("line {}: {}: vignetting factors are left out; rims cut the beams", line_, keyword_));
            }
        }
    }

    void report_solve() {
        remarks_.add_once("", "solve", Severity::info, surface_number(),
                          fmt::format("line {}: {}: what solves and pick-ups gave is taken as stated; they are not "
                                      "followed",
                                      line_, keyword_));
    }

    /// Behind the surfaces stand the merit function and the tolerances, which bear on no ray, and the operands of the
    /// configurations.
    void read_tail() {
        if (in_configurations_) {
            const bool is_operand =
                words_.size() >= 3 && parse_number(words_[0]) && parse_number(words_[1]) && parse_number(words_[2]);
            if (!is_operand || file_.operands.size() >= kMostOperands) {
                remarks_.not_understood(std::string(keyword_), 0, line_, "an operand of configurations");
                return;
            }
            const int of = integer(0, 0, kMostSurfaces, "a surface");
            const int configuration = integer(1, 0, kMostConfigurations, "a configuration");
            file_.operands[{std::string(keyword_), of}][configuration] = number(2, "a value");
            return;
        }
        ++tail_lines_;
        constexpr std::size_t kMostNamed = 100;
        if (tail_.size() < kMostNamed) {
            tail_.push_back({printable(keyword_), line_});
        }
    }

    void report_tail() {
        if (tail_.empty()) {
            return;
        }
        std::vector<std::string> names;
        for (const TailLine& passed : tail_) {
            if (std::ranges::find(names, passed.keyword) == names.end()) {
                names.push_back(passed.keyword);
            }
        }
        remarks_.add("not-read", Severity::info, 0,
                     fmt::format("from line {} on, {} lines behind the surfaces are left out as merit function and "
                                 "tolerances: {}",
                                 tail_.front().line, tail_lines_, fmt::join(names, ", ")));
    }

    struct TailLine {
        std::string keyword;
        int line;
    };

    const std::filesystem::path& path_;
    Remarks& remarks_;
    ZmxFile file_;
    int line_ = 0;
    std::string_view keyword_;
    std::string_view rest_;
    std::vector<std::string_view> words_;
    bool in_configurations_ = false;
    std::vector<TailLine> tail_;
    int tail_lines_ = 0;
};

double value_or_zero(const std::map<int, double>& values, int number) {
    const auto found = values.find(number);
    return found == values.end() ? 0.0 : found->second;
}

}  // namespace

double ZmxSurface::parameter(int number) const {
    return value_or_zero(parameters, number);
}

double ZmxSurface::extra_value(int number) const {
    return value_or_zero(extra, number);
}

ZmxFile read_zmx_file(std::string_view text, const std::filesystem::path& file, Remarks& remarks) {
    return ZmxReader(file, remarks).read(text);
}

}  // namespace lensproof
