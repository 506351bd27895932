// The keywords, from what Zemax writes into its files and OpticStudio's help says of the values (Lens Data Editor,
// Surface Properties, System Explorer, Multi-Configuration Editor).
#include "engine/formats/prescription/zmx_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/formats/prescription/design_command.h"
#include "engine/formats/prescription/design_program.h"
#include "engine/formats/prescription/prescription_forms.h"

namespace lensproof::formats {

namespace {

constexpr int kMostBlocks = 3 * kMostSurfaces + 2;  // each surface between two breaks, the object and the image
constexpr int kMostConfigurations = 100;
constexpr int kMostWavelengths = 1000;
constexpr int kMostParameters = 300;
constexpr std::size_t kMostOperands = 10000;

/// Keywords that bear on no ray: the program's version and settings, identities of surfaces and lenses, weights, names
/// of its data files, drawing, chip zones (OEMA), physical optics, polarization, tolerances, marks of what an optimizer
/// may vary.
constexpr std::string_view kZmxSilent[] = {"VERS", "PFIL", "LANG", "RAIM", "PUSH", "SDMA", "OMMA", "ROPD", "PICB",
                                           "HYPR", "DBDT", "AUTH", "FWGN", "FWGT", "WWGT", "WWGN", "POLS", "GLRS",
                                           "GSTD", "NSCD", "COFN", "MOFF", "COMM", "HIDE", "MIRR", "SLAB", "POPS",
                                           "VPAR", "VDSZ", "VCON", "VCUR", "TCMM", "TCED", "BLNK", "TOL",  "CONF",
                                           "SCOL", "SURO", "SSID", "LUID", "EERA", "IWDP", "OEMA", "STUD"};

/// Solves, whose outcome the file holds as the value itself.
constexpr std::string_view kZmxSolves[] = {"PZUP", "PPAR", "PKUP", "MAZH", "EDGE", "TOLE", "TCOM"};

/// Apertures that are no circle about the vertex.
constexpr std::string_view kZmxApertureShapes[] = {"SQAP", "ELAP", "OBSC", "SQOB", "ELOB",
                                                   "SPID", "UDAD", "USAP", "UDOB"};

/// Vignetting factors: Zemax shrinks pupils by them where rims would cut the beams.
constexpr std::string_view kZmxVignettingFactors[] = {"VDXN", "VDYN", "VCXN", "VCYN"};

/// Reads one file, line by line.
class ZmxReader {
  public:
    ZmxReader(const std::filesystem::path& file, Remarks& remarks) : path_(file), remarks_(remarks) {
        here_.file = &path_;
    }

    ZmxFile read(std::string_view text) {
        for (const std::string_view line : lines_of(text)) {
            ++here_.line;
            read_line(line);
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
        here_.keyword = content.substr(0, end);
        rest_ = trimmed(content.substr(end));
        here_.words = words_of(rest_);
        if (here_.keyword.empty()) {
            return;
        }
        static constexpr Keyword kKeywords[] = {{"MODE", &ZmxReader::read_mode},
                                                {"NAME", &ZmxReader::read_name},
                                                {"NOTE", &ZmxReader::read_note},
                                                {"UNIT", &ZmxReader::read_unit},
                                                {"ENPD", &ZmxReader::read_aperture_type},
                                                {"FNUM", &ZmxReader::read_aperture_type},
                                                {"OBNA", &ZmxReader::read_aperture_type},
                                                {"FLOA", &ZmxReader::read_aperture_type},
                                                {"FTYP", &ZmxReader::read_field_type},
                                                {"XFLN", &ZmxReader::read_fields},
                                                {"YFLN", &ZmxReader::read_fields},
                                                {"XFLD", &ZmxReader::read_fields},
                                                {"YFLD", &ZmxReader::read_fields},
                                                {"WAVM", &ZmxReader::read_wavelength},
                                                {"WAVL", &ZmxReader::read_wavelengths},
                                                {"PWAV", &ZmxReader::read_reference},
                                                {"GCAT", &ZmxReader::read_catalogues},
                                                {"ENVD", &ZmxReader::read_environment},
                                                {"GFAC", &ZmxReader::read_apodization},
                                                {"MNUM", &ZmxReader::read_configurations},
                                                {"SURF", &ZmxReader::read_surface},
                                                {"FIMP", &ZmxReader::read_import},
                                                {"VANN", &ZmxReader::read_vignetting_angle}};
        static constexpr Keyword kOfSurfaces[] = {
            {"TYPE", &ZmxReader::read_type},       {"CURV", &ZmxReader::read_curvature},
            {"CONI", &ZmxReader::read_conic},      {"DISZ", &ZmxReader::read_thickness},
            {"STOP", &ZmxReader::read_stop},       {"GLAS", &ZmxReader::read_glass},
            {"DIAM", &ZmxReader::read_diameter},   {"MEMA", &ZmxReader::read_mechanical},
            {"CLAP", &ZmxReader::read_aperture},   {"FLAP", &ZmxReader::read_aperture},
            {"OBDC", &ZmxReader::read_off_centre}, {"PARM", &ZmxReader::read_parameter},
            {"XDAT", &ZmxReader::read_extra},      {"COAT", &ZmxReader::read_coating}};
        const auto* known = std::ranges::find(kKeywords, here_.keyword, &Keyword::name);
        const auto* of_surface = std::ranges::find(kOfSurfaces, here_.keyword, &Keyword::name);
        if (known != std::end(kKeywords)) {
            (this->*known->read)();
        } else if (of_surface != std::end(kOfSurfaces) && !file_.surfaces.empty()) {
            (this->*of_surface->read)();
        } else if (is_among(kZmxSilent, here_.keyword)) {
            return;
        } else if (is_among(kZmxSolves, here_.keyword)) {
            report_solve();
        } else if (is_among(kZmxApertureShapes, here_.keyword)) {
            remarks_.at(here_, "aperture-shape", optics::Severity::warning, surface_number(),
                        "the aperture is no full circle; the circle of the semi-diameter is taken");
        } else if (is_among(kZmxVignettingFactors, here_.keyword)) {
            read_vignetting();
        } else if (!file_.surfaces.empty() && !is_indented) {
            read_tail();
        } else {
            remarks_.not_understood(here_.keyword, surface_number(), here_.line);
        }
    }

    [[nodiscard]] int surface_number() const { return std::max(0, static_cast<int>(file_.surfaces.size()) - 1); }
    ZmxSurface& surface() { return file_.surfaces.back(); }

    void read_mode() {
        if (!rest_.starts_with("SEQ")) {
            here_.fail(rest_, "SEQ: only sequential systems are lenses");
        }
    }

    void read_name() { file_.name = std::string(rest_); }

    void read_note() {
        std::string_view text = rest_;
        if (!here_.words.empty() && parse_number(here_.words[0])) {
            text = trimmed(text.substr(here_.words[0].size()));
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
        const std::string_view name = here_.word(0);
        const auto* unit = std::ranges::find(kUnits, name, &Unit::name);
        if (unit == std::end(kUnits)) {
            here_.fail(name, "MM, CM, IN or M");
        }
        file_.unit_mm = unit->mm;
        if (unit->mm != 1.0) {
            remarks_.at(here_, "units", optics::Severity::info, 0,
                        fmt::format("lengths are in {} and taken times {} mm", name, unit->mm));
        }
    }

    void read_aperture_type() {
        file_.aperture_type = here_.keyword;
        file_.aperture_value = here_.keyword == "FLOA" ? 0.0 : here_.number(0, "the aperture's value");
        file_.is_working_f_number = here_.keyword == "FNUM" && here_.number_or_zero(1) != 0.0;
    }

    void read_field_type() {
        file_.field_type = whole_number_within(here_.number(0, "a kind of field"), -1, 100);
        file_.fields = whole_number_within(here_.number_or_zero(2), 0, kMostWavelengths);
        file_.wavelengths = whole_number_within(here_.number_or_zero(3), 0, kMostWavelengths);
    }

    void read_fields() {
        std::vector<double>& values = here_.keyword[0] == 'X' ? file_.field_x : file_.field_y;
        values.clear();
        for (std::size_t i = 0; i < here_.words.size(); ++i) {
            values.push_back(here_.number(i, "fields"));
        }
    }

    void read_wavelength() {
        const int index = here_.integer(0, 1, kMostWavelengths, "a wavelength's number");
        file_.wavelengths_um[index] = here_.number(1, "a wavelength in micrometres");
    }

    void read_wavelengths() {
        for (std::size_t i = 0; i < here_.words.size() && i < kMostWavelengths; ++i) {
            file_.wavelengths_um[static_cast<int>(i) + 1] = here_.number(i, "wavelengths in micrometres");
        }
    }

    void read_reference() {
        file_.reference_wavelength = here_.integer(0, 1, kMostWavelengths, "a wavelength's number");
    }

    void read_catalogues() {
        for (const std::string_view word : here_.words) {
            file_.catalogues.push_back(std::string(word));
        }
    }

    void read_environment() {
        constexpr double kCatalogueTemperature = 20.0;
        constexpr double kCataloguePressure = 1.0;
        if (here_.words.size() >= 2 && (here_.number(0, "a temperature") != kCatalogueTemperature ||
                                        here_.number(1, "a pressure") != kCataloguePressure)) {
            remarks_.at(
                here_, "environment", optics::Severity::warning, 0,
                fmt::format("the lens is meant for {} °C and {} atm; indices and lengths are taken at 20 °C and 1 atm",
                            printable(here_.words[0]), printable(here_.words[1])));
        }
    }

    void read_apodization() {
        // Types: 0 none, 1 a Gaussian, which of factor 0 is none, 2 a cosine's cube.
        const double type = here_.number_or_zero(0);
        if (type != 0.0 && !(type == 1.0 && here_.number_or_zero(1) == 0.0)) {
            remarks_.not_understood("GFAC", 0, here_.line, "the pupil's apodization");
        }
    }

    void read_import() {
        if (!rest_.empty()) {
            remarks_.not_understood("FIMP", surface_number(), here_.line, "data from the file " + printable(rest_));
        }
    }

    void read_configurations() {
        file_.configurations = here_.integer(0, 1, kMostConfigurations, "a number of configurations");
        in_configurations_ = !file_.surfaces.empty();
    }

    void read_surface() {
        for (const TailLine& passed : tail_) {
            remarks_.not_understood(passed.keyword, surface_number(), passed.line);
        }
        tail_.clear();
        tail_lines_ = 0;
        const double stated = here_.number(0, "a surface's number");
        if (stated != static_cast<double>(file_.surfaces.size()) || file_.surfaces.size() >= kMostBlocks) {
            throw InputError(
                fmt::format("{}:{}: SURF {}, expected surfaces in order, here SURF {}, and not more "
                            "than {}",
                            path_.string(), here_.line, printable(here_.words[0]), file_.surfaces.size(), kMostBlocks));
        }
        file_.surfaces.push_back({.line = here_.line});
        here_.context = fmt::format("SURF {}: ", surface_number());
    }

    void read_type() { surface().type = here_.words.empty() ? "STANDARD" : std::string(here_.words[0]); }

    void read_curvature() {
        surface().curvature = here_.number(0, "a curvature");
        if (here_.number_or_zero(1) > 1.0) {  // 0 fixed, 1 variable
            report_solve();
        }
    }

    void read_conic() { surface().conic = here_.number(0, "a conic constant"); }
    void read_thickness() { surface().thickness = here_.number(0, "a thickness"); }
    void read_stop() { surface().is_stop = true; }

    void read_glass() {
        ZmxSurface& here = surface();
        here.medium = {};
        const std::string name(here_.word(0));
        if (name.empty()) {
            here_.fail("", "a glass");
        }
        here.is_mirror = name == "MIRROR";
        if (here.is_mirror) {
            return;
        }
        const double n_d = here_.number_or_zero(3);
        const double V_d = here_.number_or_zero(4);
        const bool is_model = name == "___BLANK";
        // What Zemax writes beside a catalogue's glass whose indices it did not set down.
        const bool says_nothing = !is_model && ((n_d == 1.5 && V_d == 40.0) || n_d == 0.0);
        if (!is_model) {
            here.medium.glass = name;
        }
        if (!says_nothing) {
            here.medium.n_d = is_model ? here_.number(3, "a model glass's index") : n_d;
            if (V_d != 0.0) {
                here.medium.V_d = V_d;
            }
        }
        if (is_model && here_.number_or_zero(5) != 0.0) {
            remarks_.at(here_, "partial-dispersion", optics::Severity::info, surface_number(),
                        fmt::format("the model glass's deviation from the normal line, ΔP_gF = {}, is left out",
                                    here_.words[5]));
        }
    }

    void read_diameter() {
        const double semi_diameter = here_.number(0, "a semi-diameter");
        if (semi_diameter != 0.0) {
            surface().semi_diameter = semi_diameter;
            surface().semi_diameter_is_fixed = here_.number_or_zero(1) != 0.0;
        }
    }

    void read_mechanical() {
        const double semi_diameter = here_.number(0, "a mechanical semi-diameter");
        if (semi_diameter != 0.0) {
            surface().mechanical = semi_diameter;
        }
    }

    void read_aperture() {
        const double inner = here_.number(0, "an aperture's inner radius");
        const double outer = here_.number(1, "an aperture's outer radius");
        if (outer != 0.0) {
            surface().aperture = outer;
        }
        if (inner != 0.0) {
            remarks_.at(here_, "aperture-shape", optics::Severity::warning, surface_number(),
                        fmt::format("the aperture's central obstruction of radius {} is left out", inner));
        }
    }

    void read_off_centre() {
        if (here_.number_or_zero(0) != 0.0 || here_.number_or_zero(1) != 0.0) {
            remarks_.at(here_, "aperture-shape", optics::Severity::warning, surface_number(),
                        "the aperture is off the vertex, and taken about it");
        }
    }

    void read_parameter() {
        surface().parameters[here_.integer(0, 0, kMostParameters, "a parameter's number")] =
            here_.number(1, "a parameter");
    }

    void read_extra() {
        surface().extra[here_.integer(0, 0, kMostParameters, "an extra value's number")] =
            here_.number(1, "an extra value");
    }

    void read_coating() {
        remarks_.at(here_, "coating", optics::Severity::info, surface_number(),
                    fmt::format("the coating {} is named only; the surface is taken as bare", printable(rest_)));
    }

    void read_vignetting() {
        std::vector<double>& factors = file_.vignetting[std::string(here_.keyword)];
        factors.clear();
        for (std::size_t i = 0; i < here_.words.size() && i < kMostWavelengths; ++i) {
            factors.push_back(here_.number_or_zero(i));
        }
    }

    void read_vignetting_angle() {
        for (std::size_t i = 0; i < here_.words.size(); ++i) {
            if (here_.number_or_zero(i) != 0.0) {
                remarks_.at(here_, "vignetting-factors", optics::Severity::info, 0,
                            "the angles that turn vignetted pupils are left out");
            }
        }
    }

    void report_solve() {
        remarks_.at(here_, "solve", optics::Severity::info, 0,
                    "what solves and pick-ups gave is taken as stated; they are not followed");
    }

    /// Behind the surfaces stand the merit function and the tolerances, which bear on no ray, and the operands of the
    /// configurations.
    void read_tail() {
        if (in_configurations_) {
            const bool is_operand = here_.words.size() >= 3 && parse_number(here_.words[0]) &&
                                    parse_number(here_.words[1]) && parse_number(here_.words[2]);
            if (!is_operand || file_.operands.size() >= kMostOperands) {
                remarks_.not_understood(here_.keyword, 0, here_.line, "an operand of configurations");
                return;
            }
            const int of = here_.integer(0, 0, kMostSurfaces, "a surface");
            const int configuration = here_.integer(1, 0, kMostConfigurations, "a configuration");
            file_.operands[{here_.keyword, of}][configuration] = here_.number(2, "a value");
            return;
        }
        ++tail_lines_;
        constexpr std::size_t kMostNamed = 100;
        if (tail_.size() < kMostNamed) {
            tail_.push_back({printable(here_.keyword), here_.line});
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
        remarks_.add("not-read", optics::Severity::info, 0,
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
    Command here_;           // the line that is read
    std::string_view rest_;  // behind its keyword, as it stands
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

}  // namespace lensproof::formats
