// The commands, from CODE V's Reference Manual (Optical Research Associates, 1994, "Entering and changing data").
#include "engine/io/seq_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/io/input_error.h"
#include "engine/io/seq_statements.h"
#include "engine/io/text.h"

namespace lensproof {

namespace {

constexpr int kMostSurfaces = 1000;
constexpr int kMostZoomPositions = 100;

/// Commands that bear on no ray: preferences, weights, labels, what an optimizer may vary (a letter C at the end),
/// tolerances, listings.
constexpr std::string_view kSilent[] = {
    "LEN", "GO",  "INI", "WTW", "WTF", "CCY", "CCX", "THC", "GLC", "KC",  "AC",  "BC",  "CC",  "DC",
    "EC",  "FC",  "GC",  "HC",  "JC",  "XDC", "YDC", "ZDC", "ADC", "BDC", "CDC", "SLB", "DER", "VIE",
    "ECH", "OUT", "LIS", "SAV", "COM", "CWL", "CA",  "DLF", "DLT", "DLR", "DLN", "DLV", "DLS", "TIR",
    "IRR", "BTI", "CYD", "DEL", "SUR", "WID", "DSX", "DSY", "DSZ", "SPH", "VER", "IC",  "UID", "REFR"};

/// Solves and pick-ups, whose outcome the file holds as the value itself.
constexpr std::string_view kSolves[] = {"PIM", "PUY", "PIY", "HMY", "HCY", "UMY", "IMY", "UCY", "ICY", "APY", "PIK"};

constexpr std::string_view kVignettingFactors[] = {"VUX", "VLX", "VUY", "VLY"};
constexpr std::string_view kFields[] = {"XAN", "YAN", "XOB", "YOB", "XIM", "YIM", "XRI", "YRI"};
constexpr std::string_view kApertureShapes[] = {"REX", "REY", "ELX", "ELY", "CIG", "REG", "ELG", "ADX", "ADY", "ARO"};
constexpr std::string_view kDiffraction[] = {"DIF", "HOR", "HWL", "HCT", "HCO", "HCC", "GRT", "GRO", "GRS", "HOE"};
constexpr std::string_view kTypes[] = {"SPH", "CON", "ASP", "CYL", "YTO", "XTO"};
constexpr std::string_view kOtherTypes[] = {"AAS", "XYP", "SPS", "SPL", "UDS", "ZRN",
                                            "QBF", "QCN", "NSS", "GRN", "LEM"};
constexpr std::string_view kAsphereTermNames = "ABCDEFGHJ";  // of r⁴, r⁶, … r²⁰

bool is_among(const auto& words, std::string_view word) {
    return std::ranges::find(words, word) != std::end(words);
}

class SeqReader {
  public:
    SeqReader(const std::filesystem::path& file, Remarks& remarks) : path_(file), remarks_(remarks) {}

    SeqFile read(std::string_view text) {
        for (const SeqStatement& statement : seq_statements(text)) {
            statement_ = &statement;
            keyword_ = statement.words[0].text;
            next_ = 1;
            read_statement();
        }
        if (file_.surfaces.size() < 2) {
            throw InputError(fmt::format("{}: holds {} surfaces, expected SO, S and SI lines of a CODE V lens",
                                         path_.string(), file_.surfaces.size()));
        }
        if (!radius_mode_is_stated_) {
            choose_radius_mode();
        }
        return std::move(file_);
    }

  private:
    [[nodiscard]] const std::vector<SeqWord>& words() const { return statement_->words; }
    [[nodiscard]] std::string_view word(std::size_t index) const {
        return index < words().size() ? std::string_view(words()[index].text) : std::string_view();
    }

    [[noreturn]] void fail(std::string_view found, std::string_view expected) const {
        throw InputError(fmt::format("{}:{}: {} is \"{}\", expected {}", path_.string(), statement_->line,
                                     printable(keyword_), printable(found), expected));
    }

    double number(std::size_t index, std::string_view expected) const {
        const std::optional<double> value = parse_number(word(index));
        if (!value) {
            fail(word(index), expected);
        }
        return *value;
    }

    [[nodiscard]] std::vector<double> numbers_from(std::size_t first) const {
        std::vector<double> values;
        for (std::size_t i = first; i < words().size(); ++i) {
            values.push_back(number(i, "numbers"));
        }
        return values;
    }

    int integer(std::size_t index, int min, int max, std::string_view expected) const {
        const double value = number(index, expected);
        if (!(value >= min && value <= max) || value != std::floor(value)) {
            fail(word(index), fmt::format("{} from {} to {}", expected, min, max));
        }
        return static_cast<int>(value);
    }

    [[nodiscard]] int last_surface() const { return static_cast<int>(file_.surfaces.size()) - 1; }

    /// Without RDM the program's own preference counts, which the file does not hold. A curvature beyond 1 in the
    /// file's unit would be a lens as small as a grain of sand, so such numbers are radii.
    void choose_radius_mode() {
        constexpr double kSteepest = 1.0;
        const bool are_radii = std::ranges::any_of(bends_, [](double bend) { return std::abs(bend) > kSteepest; });
        for (std::size_t i = 0; are_radii && i < bends_.size(); ++i) {
            if (file_.surfaces[i].curvature == bends_[i] && bends_[i] != 0.0) {
                file_.surfaces[i].curvature = 1.0 / bends_[i];
            }
        }
        remarks_.add("radius-mode", Severity::warning, 0,
                     fmt::format("no RDM says whether the surfaces' first numbers are radii or curvatures; they are "
                                 "taken as {}",
                                 are_radii ? "radii" : "curvatures"));
    }

    /// The surface that "S5", "SO", "SI" or "SS" names, or nothing where the word is none of these.
    std::optional<int> surface_named(std::string_view name) const {
        if (name.size() < 2 || name[0] != 'S') {
            return std::nullopt;
        }
        if (name == "SO" || name == "SI") {
            return name == "SO" ? 0 : last_surface();
        }
        if (name == "SS") {
            const auto stop = std::ranges::find_if(file_.surfaces, &SeqSurface::is_stop);
            return stop == file_.surfaces.end() ? last_surface() : static_cast<int>(stop - file_.surfaces.begin());
        }
        const std::optional<double> value = parse_number(name.substr(1));
        if (!value) {
            return std::nullopt;
        }
        if (!(*value >= 0.0 && *value <= last_surface()) || *value != std::floor(*value)) {
            fail(name, fmt::format("a surface up to S{}", last_surface()));
        }
        return static_cast<int>(*value);
    }

    /// Takes the qualifiers behind the keyword: the surface meant, the zoom position, apertures' kinds and labels.
    void take_qualifiers() {
        surface_ = last_surface();
        zoom_position_ = 0;
        qualifier_.clear();
        for (; next_ < words().size() && !words()[next_].is_quoted; ++next_) {
            const std::string_view name = word(next_);
            if (const std::optional<int> named = surface_named(name)) {
                surface_ = *named;
            } else if (name.size() > 1 && name[0] == 'Z' && parse_number(name.substr(1))) {
                zoom_position_ = static_cast<int>(std::clamp(*parse_number(name.substr(1)), 0.0, 1e6));
            } else if (name == "CLR" || name == "EDG" || name == "OBS" || name == "HOL") {
                qualifier_ = name;
            } else {
                break;
            }
        }
    }

    void read_statement() {
        if (in_private_catalogue_) {
            read_private_catalogue();
            return;
        }
        if (words()[0].is_quoted) {
            not_understood();
            return;
        }
        const bool is_surface_line = keyword_[0] == 'S' && (keyword_.size() == 1 || keyword_ == "SO" ||
                                                            keyword_ == "SI" || parse_number(keyword_.substr(1)));
        if (is_surface_line) {
            read_surface();
            return;
        }
        constexpr std::size_t kSignificant = 3;  // letters of a command
        keyword_ = keyword_.substr(0, kSignificant);
        if (!read_system() && !read_of_surface() && !is_among(kSilent, keyword_)) {
            not_understood();
        }
    }

    void not_understood() { remarks_.not_understood(keyword_, std::max(0, last_surface()), statement_->line); }

    /// Commands of the lens as a whole.
    bool read_system() {
        if (keyword_ == "RDM") {
            radius_mode_ = !word(1).starts_with('N');
            radius_mode_is_stated_ = true;
        } else if (keyword_ == "TIT") {
            file_.title = words().size() > 1 ? words()[1].text : "";
        } else if (keyword_ == "DIM") {
            read_unit();
        } else if (keyword_ == "EPD" || keyword_ == "FNO" || keyword_ == "NA" || keyword_ == "NAO") {
            file_.aperture_type = keyword_;
            file_.aperture_value = number(1, "the aperture's value");
        } else if (is_among(kFields, keyword_)) {
            file_.fields[keyword_] = numbers_from(1);
        } else if (keyword_ == "WL") {
            file_.wavelengths_nm = numbers_from(1);
        } else if (keyword_ == "REF") {
            file_.reference_wavelength = integer(1, 1, kMostSurfaces, "a wavelength's number");
        } else if (keyword_ == "PRV") {
            in_private_catalogue_ = true;
            private_wavelengths_.clear();
        } else if (keyword_ == "ZOO") {
            read_zoom();
        } else if (is_among(kVignettingFactors, keyword_)) {
            remarks_.add_once("", "vignetting-factors", Severity::info, 0,
                              fmt::format("line {}: {}: vignetting factors are left out; rims cut the beams",
                                          statement_->line, keyword_));
        } else if (keyword_ == "TEM" || keyword_ == "PRE") {
            remarks_.add_once(keyword_, "environment", Severity::info, 0,
                              fmt::format("line {}: {} {} is left out: indices and lengths are taken at 20 °C and 1 "
                                          "atm",
                                          statement_->line, keyword_, printable(word(1))));
        } else {
            return false;
        }
        return true;
    }

    void read_unit() {
        const std::string_view unit = word(1);
        if (unit.starts_with('M')) {
            file_.unit_mm = 1.0;
        } else if (unit.starts_with('C') || unit.starts_with('I')) {
            file_.unit_mm = unit[0] == 'C' ? 10.0 : 25.4;
            remarks_.add_once("", "units", Severity::info, 0,
                              fmt::format("line {}: lengths are in {} and taken times {} mm", statement_->line,
                                          unit[0] == 'C' ? "cm" : "inches", file_.unit_mm));
        } else {
            fail(unit, "M, C or I");
        }
    }

    void read_surface() {
        SeqSurface surface{.line = statement_->line};
        const double bent = number(1, radius_mode_ ? "a radius" : "a curvature");
        surface.curvature = !radius_mode_ ? bent : (bent == 0.0 ? 0.0 : 1.0 / bent);
        surface.thickness = number(2, "a thickness");
        for (std::size_t i = 3; i < words().size(); ++i) {
            read_glass_word(surface, words()[i]);
        }
        const auto next = static_cast<double>(file_.surfaces.size());
        const bool is_object = keyword_ == "SO" || keyword_ == "S0";
        const bool has_number = !is_object && keyword_ != "S" && keyword_ != "SI";
        const double stated = has_number ? parse_number(keyword_.substr(1)).value_or(next) : next;
        if (file_.has_image || stated != next || is_object != file_.surfaces.empty() ||
            file_.surfaces.size() >= kMostSurfaces) {
            throw InputError(
                fmt::format("{}:{}: {}, expected SO, then surfaces in order (here S{}), not more than {}, "
                            "and SI last",
                            path_.string(), statement_->line, printable(keyword_), next, kMostSurfaces));
        }
        file_.has_image = keyword_ == "SI";
        file_.surfaces.push_back(std::move(surface));
        bends_.push_back(bent);
    }

    static void read_glass_word(SeqSurface& surface, const SeqWord& word) {
        if (!word.is_quoted && (word.text == "REFL" || word.text == "REFR")) {
            surface.is_mirror = word.text == "REFL";
        } else if (!word.text.empty()) {
            surface.glass = word.text;
        }
    }

    /// Commands of a surface: the last one, or the one that a qualifier names.
    bool read_of_surface() {
        if (file_.surfaces.empty()) {
            return false;
        }
        take_qualifiers();
        SeqSurface& surface = file_.surfaces[surface_];
        if (read_shape(surface) || read_decentre(surface)) {
            return true;
        }
        if (keyword_ == "STO") {
            surface.is_stop = true;
        } else if (keyword_ == "THI") {
            set_thickness();
        } else if (keyword_ == "GLA") {
            read_glass_word(surface, next_ < words().size() ? words()[next_] : SeqWord{});
        } else if (keyword_ == "RMD") {
            surface.is_mirror = word(next_) == "REFL";
        } else if (keyword_ == "CIR" && qualifier_ != "OBS" && qualifier_ != "HOL") {
            (qualifier_ == "EDG" ? surface.edge : surface.semi_diameter) = number(next_, "an aperture's radius");
        } else if (keyword_ == "CIR" || is_among(kApertureShapes, keyword_)) {
            remarks_.add_once(fmt::format("{} {}", keyword_, surface_), "aperture-shape", Severity::warning, surface_,
                              fmt::format("line {}, surface {} of the file: {} makes the aperture no full circle about "
                                          "the vertex; that is left out",
                                          statement_->line, surface_, keyword_));
        } else if (is_among(kSolves, keyword_)) {
            remarks_.add_once("", "solve", Severity::info, surface_,
                              fmt::format("line {}: {}: what solves and pick-ups gave is taken as stated; they are "
                                          "not followed",
                                          statement_->line, keyword_));
        } else if (is_among(kDiffraction, keyword_) || is_among(kOtherTypes, keyword_)) {
            remarks_.add_once(fmt::format("{}", surface_), "surface-type", Severity::error, surface_,
                              fmt::format("line {}, surface {} of the file: {}: the surface is more than a conic, "
                                          "asphere or toroid; the rest is left out",
                                          statement_->line, surface_, keyword_));
        } else {
            return false;
        }
        return true;
    }

    bool read_shape(SeqSurface& surface) {
        const std::size_t term = keyword_.size() == 1 ? kAsphereTermNames.find(keyword_[0]) : std::string_view::npos;
        const auto curvature_of = [&](double radius) { return radius == 0.0 ? 0.0 : 1.0 / radius; };
        if (is_among(kTypes, keyword_)) {
            surface.type = keyword_;
        } else if (keyword_ == "K") {
            surface.conic = number(next_, "a conic constant");
        } else if (term != std::string_view::npos) {
            surface.asphere[term + 1] = number(next_, "an aspheric coefficient");
        } else if (keyword_ == "RDY" || keyword_ == "CUY") {
            const double value = number(next_, "a radius or a curvature");
            surface.curvature = keyword_ == "RDY" ? curvature_of(value) : value;
        } else if (keyword_ == "RDX" || keyword_ == "CUX") {
            const double value = number(next_, "a radius or a curvature");
            surface.curvature_x = keyword_ == "RDX" ? curvature_of(value) : value;
        } else if (keyword_ == "CUF") {
            if (number(next_, "a curvature") != 0.0) {
                not_understood();
            }
        } else {
            return false;
        }
        return true;
    }

    bool read_decentre(SeqSurface& surface) {
        static constexpr std::string_view kDecentres[] = {"XDE", "YDE", "ZDE"};
        static constexpr std::string_view kTilts[] = {"ADE", "BDE", "CDE"};
        if (is_among(kDecentres, keyword_)) {
            surface.decentre[keyword_[0] - 'X'] = number(next_, "a decentre");
        } else if (is_among(kTilts, keyword_)) {
            surface.tilt_deg[keyword_[0] - 'A'] = number(next_, "a tilt in degrees");
        } else if (keyword_ == "DAR") {
            surface.decentre_kind = SeqDecentre::restore;
        } else if (keyword_ == "REV") {
            surface.decentre_kind = SeqDecentre::reverse;
        } else if (keyword_ == "BEN") {
            surface.decentre_kind = SeqDecentre::bend;
        } else {
            return false;
        }
        return true;
    }

    void set_thickness() {
        const double value = number(next_, "a thickness");
        if (zoom_position_ == 0) {
            file_.surfaces[surface_].thickness = value;
            return;
        }
        if (zoom_position_ > file_.zoom_positions) {
            fail(fmt::format("for Z{}", zoom_position_), fmt::format("one of {} zoom positions", file_.zoom_positions));
        }
        std::vector<double>& values = file_.zoomed_thicknesses[surface_];
        values.resize(static_cast<std::size_t>(file_.zoom_positions), file_.surfaces[surface_].thickness);
        values[static_cast<std::size_t>(zoom_position_) - 1] = value;
    }

    /// "ZOO 3", or "ZOO THI S5 1.0 2.0 3.0": a value for each position.
    void read_zoom() {
        if (parse_number(word(1))) {
            file_.zoom_positions = integer(1, 1, kMostZoomPositions, "a number of zoom positions");
            return;
        }
        const std::string command(word(1).substr(0, 3));
        next_ = 2;
        if (!file_.surfaces.empty()) {
            take_qualifiers();
        }
        const auto values = [&] {
            std::vector<double> read = numbers_from(next_);
            if (read.size() != static_cast<std::size_t>(file_.zoom_positions)) {
                fail(fmt::format("{} values", read.size()),
                     fmt::format("{}, one for each zoom position", file_.zoom_positions));
            }
            return read;
        };
        if (command == "THI" && !file_.surfaces.empty()) {
            file_.zoomed_thicknesses[surface_] = values();
        } else if (command == "EPD" || command == "FNO") {
            file_.zoomed_apertures[command] = values();
        } else if (command == "TIT") {
            for (std::size_t i = next_; i < words().size(); ++i) {
                file_.zoom_titles.push_back(words()[i].text);
            }
        } else if (!is_among(kSilent, command)) {
            remarks_.add_once(command, "multi-configuration", Severity::warning, 0,
                              fmt::format("line {}: {} differs between the zoom positions, which is left out",
                                          statement_->line, printable(command)));
        }
    }

    /// PWL with wavelengths, then a line of indices for each glass.
    void read_private_catalogue() {
        if (keyword_ == "END" && !words()[0].is_quoted) {
            in_private_catalogue_ = false;
        } else if (keyword_ == "PWL" && !words()[0].is_quoted) {
            private_wavelengths_ = numbers_from(1);
        } else if (words().size() > 1 && parse_number(word(1)) && !private_wavelengths_.empty()) {
            const std::vector<double> indices = numbers_from(1);
            if (indices.size() != private_wavelengths_.size()) {
                fail(fmt::format("{} indices", indices.size()),
                     fmt::format("{}, one for each wavelength of PWL", private_wavelengths_.size()));
            }
            std::vector<WavelengthValue> table;
            for (std::size_t i = 0; i < indices.size(); ++i) {
                table.push_back({private_wavelengths_[i], indices[i]});
            }
            std::ranges::sort(table, {}, &WavelengthValue::wavelength_nm);
            file_.private_glasses[keyword_] = std::move(table);
        } else {
            not_understood();
        }
    }

    const std::filesystem::path& path_;
    Remarks& remarks_;
    SeqFile file_;
    const SeqStatement* statement_ = nullptr;
    std::string keyword_;
    std::size_t next_ = 1;  // the word behind the qualifiers
    int surface_ = 0;
    int zoom_position_ = 0;
    std::string qualifier_;
    std::vector<double> bends_;  // the first numbers of the S lines
    bool radius_mode_ = false;
    bool radius_mode_is_stated_ = false;
    bool in_private_catalogue_ = false;
    std::vector<double> private_wavelengths_;
};

}  // namespace

SeqFile read_seq_file(std::string_view text, const std::filesystem::path& file, Remarks& remarks) {
    return SeqReader(file, remarks).read(text);
}

}  // namespace lensproof
