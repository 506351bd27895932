#include "engine/formats/prescription/seq_shape.h"

#include <fmt/format.h>

#include "engine/base/text.h"
#include "engine/formats/prescription/design_program.h"

namespace lensproof::formats {

namespace {

constexpr std::string_view kOtherDiffraction[] = {"GRT", "GRO", "GRS", "GRX", "GRY", "GRZ", "HOE"};
constexpr std::string_view kTypes[] = {"SPH", "CON", "ASP", "CYL", "YTO", "XTO"};
constexpr std::string_view kOtherTypes[] = {"AAS", "XYP", "SPL", "UDS", "ZRN", "QBF", "QCN", "NSS", "GRN", "LEM"};
constexpr std::string_view kAsphereTermNames = "ABCDEFGHJ";  // of r⁴, r⁶, … r²⁰

class SeqShapeReader {
  public:
    explicit SeqShapeReader(const SeqSurfaceCommand& command)
        : here_(command.here), next_(command.next), surface_(command.surface), remarks_(command.remarks) {}

    bool read(SeqSurface& surface) const {
        if (is_among(kOtherDiffraction, here_.keyword) || is_among(kOtherTypes, here_.keyword)) {
            report_other_surface();
            return true;
        }
        return read_curvature(surface) || read_special(surface) || read_decentre(surface) || read_kinoform(surface);
    }

  private:
    bool read_curvature(SeqSurface& surface) const {
        const std::size_t term =
            here_.keyword.size() == 1 ? kAsphereTermNames.find(here_.keyword[0]) : std::string_view::npos;
        const auto curvature_of = [&](double radius) { return radius == 0.0 ? 0.0 : 1.0 / radius; };
        if (is_among(kTypes, here_.keyword)) {
            surface.type = here_.keyword;
        } else if (here_.keyword == "K") {
            surface.conic = here_.number(next_, "a conic constant");
        } else if (term != std::string_view::npos) {
            surface.asphere[term + 1] = here_.number(next_, "an aspheric coefficient");
        } else if (here_.keyword == "RDY" || here_.keyword == "CUY") {
            const double value = here_.number(next_, "a radius or a curvature");
            surface.curvature = here_.keyword == "RDY" ? curvature_of(value) : value;
        } else if (here_.keyword == "RDX" || here_.keyword == "CUX") {
            const double value = here_.number(next_, "a radius or a curvature");
            surface.curvature_x = here_.keyword == "RDX" ? curvature_of(value) : value;
        } else if (here_.keyword == "CUF") {
            return here_.number(next_, "a curvature") == 0.0;
        } else {
            return false;
        }
        return true;
    }

    /// "SPS ODD 0.0", then "SCO K -1", "SCO AR3 1e-4", or by the coefficients' numbers "SCO C1 -1", "SCO C4 1e-4".
    bool read_special(SeqSurface& surface) const {
        if (here_.keyword == "SPS") {
            surface.special = here_.word(next_).substr(0, 3);
            const SeqSpecial* const known = find_special(surface.special);
            if (known == nullptr) {
                remarks_.at(here_, "surface-type", optics::Severity::error, surface_,
                            fmt::format("the special surface {} is not known; it is taken as a conic",
                                        printable(surface.special)));
            } else if (next_ + 1 < here_.words.size()) {
                const double radius = here_.number(next_ + 1, "a normalizing radius");
                if (known->radius_stands_beside_name) {
                    surface.special_values[known->radius] = radius;
                } else if (radius != 0.0) {
                    here_.fail(here_.word(next_ + 1),
                               fmt::format("nothing behind {}: SCO NRADIUS says its radius", known->name));
                }
            }
            return true;
        }
        if (here_.keyword != "SCO" || surface.special.empty()) {
            return false;
        }
        if (const SeqSpecial* const known = find_special(surface.special)) {
            const int number = coefficient_number(*known, here_.word(next_));
            surface.special_values[number] = here_.number(next_ + 1, "a coefficient");
        }
        return true;
    }

    /// Which coefficient a name of SCO says.
    [[nodiscard]] int coefficient_number(const SeqSpecial& special, std::string_view name) const {
        constexpr int kMostCoefficients = 100;
        const auto numbered = [&](std::string_view prefix) {
            const std::optional<double> number =
                name.starts_with(prefix) ? parse_number(name.substr(prefix.size())) : std::nullopt;
            return number ? whole_number_within(*number, 0, kMostCoefficients) : 0;
        };
        const int beyond = numbered(special.terms) - special.first_power;
        const int number = name == "K"                                 ? special.conic
                           : name == "NRADIUS"                         ? special.radius
                           : beyond >= 0 && beyond % special.step == 0 ? special.first_number + beyond / special.step
                                                                       : numbered("C");
        if (number == 0) {
            here_.fail(name, fmt::format("{}NRADIUS, {}{}, {}{}, … or C1, C2, …", special.conic > 0 ? "K, " : "",
                                         special.terms, special.first_power, special.terms,
                                         special.first_power + special.step));
        }
        return number;
    }

    /// "DIF DOE", its order HOR, design wavelength HWL, HCT R for a phase that is round, and its path's coefficients of
    /// r^(2i) at that wavelength, HCO C1, C2, … (in the file's unit). HCC says what an optimizer may vary.
    bool read_kinoform(SeqSurface& surface) const {
        if (here_.keyword == "DIF" && here_.word(next_) == "DOE") {
            surface.kinoform.emplace();
            return true;
        }
        if (here_.keyword == "DIF") {
            report_other_surface();
            return true;
        }
        if (!surface.kinoform || !here_.keyword.starts_with('H')) {
            return here_.keyword == "HCC";
        }
        if (here_.keyword == "HOR") {
            surface.kinoform->order = here_.number(next_, "a diffraction order");
        } else if (here_.keyword == "HWL") {
            surface.kinoform->design_wavelength_nm = here_.number(next_, "a wavelength in nm");
        } else if (here_.keyword == "HCO") {
            read_kinoform_term(*surface.kinoform);
        } else if (here_.keyword == "HCT" && here_.word(next_) != "R") {
            remarks_.at(here_, "surface-type", optics::Severity::error, surface_,
                        fmt::format("a kinoform's phase of the kind {} is not known; expected R, a round one",
                                    printable(here_.word(next_))));
        } else if (here_.keyword != "HCC" && here_.keyword != "HCT") {
            return false;
        }
        return true;
    }

    void read_kinoform_term(optics::PhaseElement& kinoform) const {
        const std::string_view name = here_.word(next_);
        const std::optional<double> number = name.starts_with('C') ? parse_number(name.substr(1)) : std::nullopt;
        const int term = number ? whole_number_within(*number, 0, optics::kPhaseTerms + 1) : 0;
        const double value = here_.number(next_ + 1, "a coefficient");
        if (term >= 1 && term <= optics::kPhaseTerms) {
            kinoform.radial[static_cast<std::size_t>(term) - 1] = value;
        } else if (value != 0.0) {
            remarks_.at(here_, "surface-type", optics::Severity::error, surface_,
                        fmt::format("the kinoform's coefficient {} is left out: C1 to C{} are known", printable(name),
                                    optics::kPhaseTerms));
        }
    }

    bool read_decentre(SeqSurface& surface) const {
        static constexpr std::string_view kDecentres[] = {"XDE", "YDE", "ZDE"};
        static constexpr std::string_view kTilts[] = {"ADE", "BDE", "CDE"};
        if (is_among(kDecentres, here_.keyword)) {
            surface.decentre[here_.keyword[0] - 'X'] = here_.number(next_, "a decentre");
        } else if (is_among(kTilts, here_.keyword)) {
            surface.tilt_deg[here_.keyword[0] - 'A'] = here_.number(next_, "a tilt in degrees");
        } else if (here_.keyword == "DAR") {
            surface.decentre_kind = SeqDecentre::restore;
        } else if (here_.keyword == "REV") {
            surface.decentre_kind = SeqDecentre::reverse;
        } else if (here_.keyword == "BEN") {
            surface.decentre_kind = SeqDecentre::bend;
        } else {
            return false;
        }
        return true;
    }

    void report_other_surface() const {
        remarks_.at(here_, "surface-type", optics::Severity::error, surface_,
                    "the surface is more than a conic, asphere or toroid; the rest is left out");
    }

    const Command& here_;
    std::size_t next_;
    int surface_;
    Remarks& remarks_;
};

}  // namespace

const SeqSpecial* find_special(std::string_view name) {
    const auto found = std::ranges::find(kSeqSpecials, name, &SeqSpecial::name);
    return found == kSeqSpecials.end() ? nullptr : &*found;
}

bool read_seq_shape(const SeqSurfaceCommand& command, SeqSurface& surface) {
    return SeqShapeReader(command).read(surface);
}

}  // namespace lensproof::formats
