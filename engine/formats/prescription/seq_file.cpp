// The commands, from CODE V's Reference Manual (Optical Research Associates, 1994, "Entering and changing data").
#include "engine/formats/prescription/seq_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/formats/prescription/design_command.h"
#include "engine/formats/prescription/design_program.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/formats/prescription/seq_shape.h"
#include "engine/formats/prescription/seq_statements.h"

namespace lensproof::formats {

namespace {

constexpr int kMostZoomPositions = 100;

/// Commands that bear on no ray: preferences, weights, labels, what an optimizer may vary (a letter C at the end),
/// tolerances, listings.
constexpr std::string_view kSeqSilent[] = {"LEN", "GO",  "INI", "WTW", "WTF", "CCY", "CCX", "THC", "GLC", "KC",  "AC",
                                           "BC",  "CC",  "DC",  "EC",  "FC",  "GC",  "HC",  "JC",  "XDC", "YDC", "ZDC",
                                           "ADC", "BDC", "CDC", "SLB", "DER", "VIE", "ECH", "OUT", "LIS", "SAV", "COM",
                                           "CWL", "CA",  "DLF", "DLT", "DLR", "DLN", "DLV", "DLS", "TIR", "IRR", "BTI",
                                           "CYD", "SUR", "WID", "DSX", "DSY", "DSZ", "SPH", "VER", "IC",  "UID", "SCC"};

/// Solves and pick-ups, whose outcome the file holds as the value itself.
constexpr std::string_view kSeqSolves[] = {"PIM", "PUY", "PIY", "HMY", "HCY", "UMY", "IMY", "UCY", "ICY", "APY", "PIK"};

constexpr std::string_view kFields[] = {"XAN", "YAN", "XOB", "YOB", "XIM", "YIM",
                                        "XRI", "YRI", "VUX", "VLX", "VUY", "VLY"};
constexpr std::string_view kRadii[] = {"RDY", "RDX", "CUY", "CUX"};
constexpr std::string_view kSeqApertureShapes[] = {"REX", "REY", "ELX", "ELY", "CIG",
                                                   "REG", "ELG", "ADX", "ADY", "ARO"};

class SeqReader {
  public:
    SeqReader(const std::filesystem::path& file, Remarks& remarks) : path_(file), remarks_(remarks) {
        here_.file = &path_;
    }

    SeqFile read(std::string_view text) {
        for (const SeqStatement& statement : seq_statements(text)) {
            statement_ = &statement;
            here_.line = statement.line;
            here_.keyword = statement.words[0].text;
            here_.words.clear();
            for (const SeqWord& word : statement.words) {
                here_.words.push_back(word.text);
            }
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
        remarks_.add("radius-mode", optics::Severity::warning, 0,
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
            here_.fail(name, fmt::format("a surface up to S{}", last_surface()));
        }
        return static_cast<int>(*value);
    }

    /// Whether a qualifier, as Z2 in "CIR S1 Z2 3", makes the command one of a single zoom position.
    [[nodiscard]] bool is_of_one_position() const {
        constexpr std::string_view kOthers[] = {"SO", "SI", "SS", "SA", "CLR", "EDG", "OBS", "HOL"};
        for (std::size_t i = 1; i < words().size() && !words()[i].is_quoted; ++i) {
            const std::string_view name = here_.word(i);
            const std::optional<double> number = parse_number(name.substr(1));
            if (name[0] == 'Z' && number) {
                return *number != 0.0;
            }
            if (!is_among(kOthers, name) &&
                !(number && std::string_view("SFW").find(name[0]) != std::string_view::npos)) {
                return false;
            }
        }
        return false;
    }

    /// Takes the qualifiers behind the keyword: the surface meant, the zoom position, apertures' kinds and labels.
    void take_qualifiers() {
        surface_ = last_surface();
        zoom_position_ = 0;
        qualifier_.clear();
        for (; next_ < words().size() && !words()[next_].is_quoted; ++next_) {
            const std::string_view name = here_.word(next_);
            if (const std::optional<int> named = surface_named(name)) {
                surface_ = *named;
            } else if (name.size() > 1 && name[0] == 'Z' && parse_number(name.substr(1))) {
                zoom_position_ = whole_number_within(*parse_number(name.substr(1)), 0, kMostZoomPositions);
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
        const bool is_surface_line =
            here_.keyword[0] == 'S' && (here_.keyword.size() == 1 || here_.keyword == "SO" || here_.keyword == "SI" ||
                                        parse_number(here_.keyword.substr(1)));
        if (is_surface_line) {
            read_surface();
            return;
        }
        constexpr std::size_t kSignificant = 3;  // letters of a command
        here_.keyword = here_.keyword.substr(0, kSignificant);
        if (here_.keyword != "THI" && !is_among(kSeqSilent, here_.keyword) && is_of_one_position()) {
            const int surface = file_.surfaces.empty() ? 0 : surface_named(here_.word(1)).value_or(0);
            remarks_.add_once(fmt::format("{} {}", here_.keyword, here_.word(1)), "multi-configuration",
                              optics::Severity::warning, surface,
                              fmt::format("line {}: {} holds for one zoom position alone, and is left out", here_.line,
                                          printable(here_.keyword)));
            return;
        }
        if (!read_system() && !read_of_surface() && !is_among(kSeqSilent, here_.keyword)) {
            not_understood();
        }
    }

    void not_understood() { remarks_.not_understood(here_.keyword, std::max(0, last_surface()), here_.line); }

    /// Commands of the lens as a whole.
    bool read_system() {
        if (here_.keyword == "RDM") {
            radius_mode_ = !here_.word(1).starts_with('N');
            radius_mode_is_stated_ = true;
        } else if (here_.keyword == "TIT") {
            file_.title = words().size() > 1 ? words()[1].text : "";
        } else if (here_.keyword == "DIM") {
            read_unit();
        } else if (here_.keyword == "EPD" || here_.keyword == "FNO" || here_.keyword == "NA" ||
                   here_.keyword == "NAO") {
            file_.aperture_type = here_.keyword;
            file_.aperture_value = here_.number(1, "the aperture's value");
        } else if (is_among(kFields, here_.keyword)) {
            file_.fields[here_.keyword] = here_.numbers_from(1);
        } else if (here_.keyword == "WL") {
            file_.wavelengths_nm = here_.numbers_from(1);
        } else if (here_.keyword == "REF") {
            file_.reference_wavelength = here_.integer(1, 1, kMostSurfaces, "a wavelength's number");
        } else if (here_.keyword == "PRV") {
            in_private_catalogue_ = true;
            private_wavelengths_.clear();
        } else if (here_.keyword == "ZOO") {
            read_zoom();
        } else if (here_.keyword == "DEL") {
            read_deletion();
        } else if (here_.keyword == "TEM" || here_.keyword == "PRE") {
            remarks_.at(here_, "environment", optics::Severity::info, 0,
                        "left out: indices and lengths are taken at 20 °C and 1 atm");
        } else {
            return false;
        }
        return true;
    }

    void read_unit() {
        const std::string_view unit = here_.word(1);
        if (unit.starts_with('M')) {
            file_.unit_mm = 1.0;
        } else if (unit.starts_with('C') || unit.starts_with('I')) {
            file_.unit_mm = unit[0] == 'C' ? 10.0 : 25.4;
            remarks_.at(here_, "units", optics::Severity::info, 0,
                        fmt::format("lengths are in {} and taken times {} mm", unit[0] == 'C' ? "cm" : "inches",
                                    file_.unit_mm));
        } else {
            here_.fail(unit, "M, C or I");
        }
    }

    /// "DEL S3..5" takes surfaces away; "DEL PIK", "DEL SOL" undo what is not followed here.
    void read_deletion() {
        const std::string_view what = here_.word(1);
        if (what.starts_with("SOL") || is_among(kSeqSolves, what.substr(0, 3))) {
            return;
        }
        if (what.starts_with('S')) {
            remarks_.at(here_, "deleted-surfaces", optics::Severity::error, 0,
                        "deletes surfaces, which is not followed: the lens is another");
        } else {
            not_understood();
        }
    }

    void read_surface() {
        SeqSurface surface{.line = here_.line};
        const double bent = here_.number(1, radius_mode_ ? "a radius" : "a curvature");
        surface.curvature = !radius_mode_ ? bent : (bent == 0.0 ? 0.0 : 1.0 / bent);
        surface.thickness = here_.number(2, "a thickness");
        for (std::size_t i = 3; i < words().size(); ++i) {
            read_glass_word(surface, words()[i]);
        }
        const auto next = static_cast<double>(file_.surfaces.size());
        const bool is_object = here_.keyword == "SO" || here_.keyword == "S0";
        const bool has_number = !is_object && here_.keyword != "S" && here_.keyword != "SI";
        const double stated = has_number ? parse_number(here_.keyword.substr(1)).value_or(next) : next;
        if (file_.has_image || stated != next || is_object != file_.surfaces.empty() ||
            file_.surfaces.size() >= kMostSurfaces) {
            throw InputError(
                fmt::format("{}:{}: {}, expected SO, then surfaces in order (here S{}), not more than {}, "
                            "and SI last",
                            path_.string(), here_.line, printable(here_.keyword), next, kMostSurfaces));
        }
        file_.has_image = here_.keyword == "SI";
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
        // "CUY UMY -0.1" says what angle of the marginal ray the curvature, which stands on the S line, was solved for.
        if (is_among(kSeqSolves, here_.keyword) ||
            (is_among(kRadii, here_.keyword) && is_among(kSeqSolves, here_.word(next_).substr(0, 3)))) {
            remarks_.at(here_, "solve", optics::Severity::info, 0,
                        "what solves and pick-ups gave is taken as stated; they are not followed");
            return true;
        }
        if (read_seq_shape({here_, next_, surface_, remarks_}, surface)) {
            return true;
        }
        if (here_.keyword == "STO") {
            surface.is_stop = true;
        } else if (here_.keyword == "THI") {
            set_thickness();
        } else if (here_.keyword == "GLA") {
            read_glass_word(surface, next_ < words().size() ? words()[next_] : SeqWord{});
        } else if (here_.keyword == "RMD") {
            surface.is_mirror = here_.word(next_) == "REFL";
        } else if (here_.keyword == "CIR" && qualifier_ != "OBS" && qualifier_ != "HOL") {
            (qualifier_ == "EDG" ? surface.edge : surface.semi_diameter) = here_.number(next_, "an aperture's radius");
        } else if (here_.keyword == "CIR" || is_among(kSeqApertureShapes, here_.keyword)) {
            remarks_.at(here_, "aperture-shape", optics::Severity::warning, surface_,
                        "makes the aperture no full circle about the vertex, and is left out");
        } else {
            return false;
        }
        return true;
    }

    void set_thickness() {
        const double value = here_.number(next_, "a thickness");
        if (zoom_position_ == 0) {
            file_.surfaces[surface_].thickness = value;
            return;
        }
        if (zoom_position_ > file_.zoom_positions) {
            here_.fail(fmt::format("for Z{}", zoom_position_),
                       fmt::format("one of {} zoom positions", file_.zoom_positions));
        }
        std::vector<double>& values = file_.zoomed_thicknesses[surface_];
        values.resize(static_cast<std::size_t>(file_.zoom_positions), file_.surfaces[surface_].thickness);
        values[static_cast<std::size_t>(zoom_position_) - 1] = value;
    }

    /// "ZOO 3", or "ZOO THI S5 1.0 2.0 3.0": a value for each position.
    void read_zoom() {
        if (parse_number(here_.word(1))) {
            file_.zoom_positions = here_.integer(1, 1, kMostZoomPositions, "a number of zoom positions");
            return;
        }
        const std::string command(here_.word(1).substr(0, 3));
        next_ = 2;
        if (!file_.surfaces.empty()) {
            take_qualifiers();
        }
        const auto values = [&] {
            std::vector<double> read = here_.numbers_from(next_);
            if (read.size() != static_cast<std::size_t>(file_.zoom_positions)) {
                here_.fail(fmt::format("{} values", read.size()),
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
        } else if (!is_among(kSeqSilent, command)) {
            remarks_.add_once(command, "multi-configuration", optics::Severity::warning, 0,
                              fmt::format("line {}: {} differs between the zoom positions, which is left out",
                                          here_.line, printable(command)));
        }
    }

    /// PWL with wavelengths, then a line of indices for each glass.
    void read_private_catalogue() {
        if (here_.keyword == "END" && !words()[0].is_quoted) {
            in_private_catalogue_ = false;
        } else if (here_.keyword == "PWL" && !words()[0].is_quoted) {
            read_private_wavelengths();
        } else if (words().size() > 1 && parse_number(here_.word(1)) && !private_wavelengths_.empty()) {
            const std::vector<double> indices = here_.numbers_from(1);
            if (indices.size() != private_wavelengths_.size()) {
                here_.fail(fmt::format("{} indices", indices.size()),
                           fmt::format("{}, one for each wavelength of PWL", private_wavelengths_.size()));
            }
            std::vector<optics::WavelengthValue> table;
            for (std::size_t i = 0; i < indices.size(); ++i) {
                if (!(indices[i] >= 1.0 && indices[i] <= 5.0)) {
                    here_.fail(here_.word(i + 1), "a refractive index from 1 to 5");
                }
                table.push_back({private_wavelengths_[i], indices[i]});
            }
            std::ranges::sort(table, {}, &optics::WavelengthValue::wavelength_nm);
            file_.private_glasses[here_.keyword] = std::move(table);
        } else {
            not_understood();
        }
    }

    void read_private_wavelengths() {
        private_wavelengths_ = here_.numbers_from(1);
        for (auto here = private_wavelengths_.begin(); here != private_wavelengths_.end(); ++here) {
            if (!(*here > 0.0 && std::isfinite(*here)) ||
                std::find(private_wavelengths_.begin(), here, *here) != here) {
                here_.fail(here_.word(here - private_wavelengths_.begin() + 1),
                           "wavelengths in nm, none of them twice");
            }
        }
    }

    const std::filesystem::path& path_;
    Remarks& remarks_;
    SeqFile file_;
    const SeqStatement* statement_ = nullptr;
    Command here_;          // the statement's; its word 0 is the keyword
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

}  // namespace lensproof::formats
